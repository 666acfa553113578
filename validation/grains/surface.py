"""The free surface and what is read from it: runout, height, interior solid fraction."""

import numpy as np
from scipy.ndimage import minimum_filter1d

from grainlaw.validation.grains.coarse_graining import Lattice
from grainlaw.validation.grains.snapshot import Array

# Cells nearer than this to the surface or the floor are not interior; in widths of the kernel.
MARGIN_BELOW_SURFACE = 2.0
MARGIN_ABOVE_FLOOR = 1.0


def surface_height(phi: Array, lattice: Lattice, bulk: float) -> Array:
    """h(x) above the floor [m]: the highest level where phi falls through half of the bulk value; 0 without material.

    Linear between cell centres.
    """
    threshold = 0.5 * bulk
    padded = np.concatenate([phi, np.zeros((len(phi), 1))], axis=1)
    filled = padded > threshold
    top = padded.shape[1] - 1 - np.argmax(filled[:, ::-1], axis=1)
    columns = np.flatnonzero(filled.any(axis=1))
    height = np.zeros(len(phi))
    below, above = padded[columns, top[columns]], padded[columns, top[columns] + 1]
    level = lattice.z[top[columns]] + lattice.spacing * (below - threshold) / (below - above)
    height[columns] = level - lattice.floor
    return height


def fronts(x: Array, height: Array, grain_diameter: float) -> tuple[float, float]:
    """Left and right end of the material [m]: where the surface falls below one grain; linear between cell centres.

    Around an axis the second is the radius of the pile, the first nothing. NaN where the surface is nowhere as high.
    """
    high = np.flatnonzero(height > grain_diameter)
    if len(high) == 0:
        return np.nan, np.nan
    return _crossing(x, height, high[0], -1, grain_diameter), _crossing(x, height, high[-1], 1, grain_diameter)


def _crossing(x: Array, height: Array, last: int, outwards: int, level: float) -> float:
    beyond = last + outwards
    if not 0 <= beyond < len(x):
        return float(x[last])
    share = (height[last] - level) / (height[last] - height[beyond])
    return float(x[last] + share * (x[beyond] - x[last]))


def interior_solid_fraction(phi: Array, height: Array, lattice: Lattice, width: float) -> float:
    """Mean phi where the kernel reaches neither surface nor sides, by volume; NaN where there is no such cell."""
    reach = 2 * int(np.ceil(MARGIN_BELOW_SURFACE * width / lattice.spacing)) + 1
    # Beyond the axis the surface goes on; beyond the ends of a plane column there is none.
    whole = np.concatenate([height[::-1], height]) if lattice.space.hoop else height
    ceiling = minimum_filter1d(whole, reach, mode="constant")[-len(height) :] - MARGIN_BELOW_SURFACE * width
    above_floor = lattice.z - lattice.floor
    inside = (above_floor >= MARGIN_ABOVE_FLOOR * width) & (above_floor <= ceiling[:, None])
    weights = np.broadcast_to(lattice.weights[:, None], phi.shape)
    return float(np.average(phi[inside], weights=weights[inside])) if inside.any() else np.nan


def bulk_solid_fraction(phi: Array, lattice: Lattice, width: float) -> float:
    """The interior phi of a column before its release, whose surface is taken at half of the largest phi."""
    largest = float(phi.max())
    inside = interior_solid_fraction(phi, surface_height(phi, lattice, largest), lattice, width)
    return largest if np.isnan(inside) else inside
