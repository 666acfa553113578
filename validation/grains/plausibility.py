"""What a DEM dump contradicts itself in: its units, its depth and the axis along which gravity acts.

Grains are compared by their solid fraction per depth and by heights along z. A dump in grams, of another depth, or with
y upwards would give numbers all the same.
"""

import warnings
from collections.abc import Sequence

import numpy as np

from grainlaw.materials import InputError
from grainlaw.materials.errors import InputWarning
from grainlaw.validation.grains.run_description import RUN_DESCRIPTION_NAME, RunDescription
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, sphere_diameters

# Of what grains are made of [kg/m3]: foam and osmium.
LIGHTEST, HEAVIEST = 10.0, 25000.0
# Grains of one density; a dump that says otherwise is in other units.
SAME_DENSITY = 2.0
# Of the depth; a box a few grains deep is filled to within one of them.
SAME_DEPTH = 0.3
# Of a cylinder along x and y: the radii of gyration of grains at random differ by less.
SAME_WIDTH = 1.25
# Of the centre of mass from the axis, in the standard deviation along x; a packing of grains is off by 1 to 2 %.
LARGEST_SHIFT = 0.05
# Of the way along x: a column that spreads to one side falls by more.
STAYS_LEVEL = 0.1
# Of the grains along y, without a few that fly or fell beside the box.
INNER_PERCENTILES = (1.0, 99.0)


def check_grain_density(description: RunDescription) -> None:
    """Warn, as InputWarning, about a density that no grains have."""
    density = description.grain_density
    if not LIGHTEST <= density <= HEAVIEST:
        warnings.warn(
            f"{RUN_DESCRIPTION_NAME}: grain_density = {density:g} kg/m3 is that of no grains; a density in g/cm3 is "
            f"1000 times that, {1000.0 * density:g}",
            InputWarning,
            stacklevel=2,
        )


def check_density_of_grains(path: object, density: Array, grain_density: float) -> None:
    """Raises InputError where the grains of a dump have another density [kg/m3] than its run says."""
    found = float(np.median(density))
    if not 1.0 / SAME_DENSITY < found / grain_density < SAME_DENSITY:
        raise InputError(
            f"{path}: the grains have {found:.4g} kg/m3, but {RUN_DESCRIPTION_NAME} says grain_density = "
            f"{grain_density:g}; expected are kilograms and metres, is it in grams?"
        )


def check_geometry(snapshots: Sequence[GrainSnapshot], description: RunDescription) -> None:
    """Raises InputError where grains fall along another axis than z, or do not span the depth along y."""
    _refuse_fall_along_y(snapshots)
    if description.depth is not None and not description.is_round:
        _refuse_other_depth(snapshots[0], description.depth)


def axis_of(first: GrainSnapshot, axis: tuple[float, float] | None) -> tuple[float, float]:
    """The axis of a cylinder in x and y [m]: as told, or else that of the first frame's centre of mass.

    Raises InputError where the grains stand around another one, or around none.
    """
    x, y, _ = _center(first)
    wide, long = np.std(first.positions[:, :2], axis=0)
    if not 1.0 / SAME_WIDTH < wide / max(long, 1e-300) < SAME_WIDTH:
        raise InputError(
            f"{RUN_DESCRIPTION_NAME}: space = 'axisymmetric', but the grains lie {2.0 * wide:.3g} m around their "
            f"centre along x and {2.0 * long:.3g} m along y: no cylinder, or not all of it"
        )
    if axis is None:
        return float(x), float(y)
    beside = float(np.hypot(x - axis[0], y - axis[1]))
    diameter = float(sphere_diameters(first.solid_volumes).mean())
    if beside > max(diameter, LARGEST_SHIFT * wide):
        raise InputError(
            f"{RUN_DESCRIPTION_NAME}: axis = {list(axis)}, but the centre of mass of the first frame is "
            f"{beside:.3g} m beside it, at x = {x:.4g} m, y = {y:.4g} m; without 'axis' it is taken from there"
        )
    return axis


def _refuse_fall_along_y(snapshots: Sequence[GrainSnapshot]) -> None:
    first, last = snapshots[0], snapshots[-1]
    x, y, z = _center(last) - _center(first)
    least = float(sphere_diameters(first.solid_volumes).mean())
    moved = f"from the first frame to the last the centre of mass moves by {y:.3g} m along y and by {z:.3g} m along z"
    if abs(y) > max(least, abs(z)):
        raise InputError(f"{moved}; gravity must act along -z and y be the depth: is y up in this dump?")
    if z > least:
        raise InputError(f"{moved}; gravity must act along -z: is z down in this dump?")
    if abs(x) > least and abs(z) < STAYS_LEVEL * abs(x):
        warnings.warn(
            f"the centre of mass moves by {x:.3g} m along x, but not along z; gravity must act along -z: "
            "is x up in this dump?",
            InputWarning,
            stacklevel=2,
        )


def _center(snapshot: GrainSnapshot) -> Array:
    return np.asarray(np.average(snapshot.positions, axis=0, weights=snapshot.solid_volumes))


def _refuse_other_depth(snapshot: GrainSnapshot, depth: float) -> None:
    diameter = float(sphere_diameters(snapshot.solid_volumes).mean())
    low, high = np.percentile(snapshot.positions, INNER_PERCENTILES, axis=0)
    spans = np.ptp(snapshot.positions, axis=0)
    # Centres, in a periodic box, or whole grains, between walls.
    if spans[1] + diameter >= (1.0 - SAME_DEPTH) * depth and high[1] - low[1] <= (1.0 + SAME_DEPTH) * depth:
        return
    fits_z = abs(spans[2] + 0.5 * diameter - depth) < SAME_DEPTH * depth
    hint = "; is y up in this dump? z must be up, and y the depth" if fits_z else ""
    raise InputError(
        f"{RUN_DESCRIPTION_NAME}: depth = {depth:g} m, but the grains span {spans[1] + diameter:.3g} m along y"
        f" (and {spans[2] + diameter:.3g} m along z){hint}"
    )
