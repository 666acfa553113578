"""Loose random arrangements to start from, the glued floor, and the cut of a settled packing."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.validation.dem.description import Grains

Array = NDArray[np.float64]

# Random sequential addition slows down without bound near its jamming limit (0.38 in space, 0.55 on a plane).
TRIALS_PER_GRAIN = 2000
# Depth of the centres of the glued grains below z = 0, in mean diameters: then the mobile grains fill as much of the
# space above z = 0 as they do above a plane at z = 0.
GLUED_DEPTH = 0.4


@dataclass(frozen=True)
class Packing:
    """Spheres: centres (n, 3) [m] and radii (n,) [m]."""

    centres: Array
    radii: Array

    def __len__(self) -> int:
        return len(self.radii)

    @property
    def volume(self) -> float:
        """Volume of all grains [m3], overlaps counted twice."""
        return float(4.0 / 3.0 * np.pi * np.sum(self.radii**3))

    def chosen(self, which: NDArray[np.bool_]) -> "Packing":
        """The grains for which `which` (n,) holds."""
        return Packing(self.centres[which], self.radii[which])


def random_radii(grains: Grains, number: int, random: np.random.Generator) -> Array:
    """Radii (number,) [m], the diameter uniform in the range of the grains."""
    return random.uniform(grains.smallest_diameter, grains.largest_diameter, number) / 2.0


def mean_volume(grains: Grains) -> float:
    """Mean volume of one grain [m3] with the diameter uniform between a and b: pi/24 (b^4 - a^4)/(b - a)."""
    a, b = grains.smallest_diameter, grains.largest_diameter
    return float(np.pi / 24.0 * (b * b + a * a) * (b + a))


def loose(radii: Array, box: Array, periodic: tuple[bool, bool, bool], random: np.random.Generator) -> Packing:
    """Random sequential addition of spheres without overlap into `box` (3, 2) [m].

    Raises RuntimeError if the box is too full for it (beyond a solid fraction of about 0.35).
    """
    cells = _Cells(box, 2.0 * float(radii.max()), periodic)
    order = np.argsort(radii)[::-1]
    centres = np.empty((len(radii), 3))
    margin = np.where(periodic, 0.0, 1.0)
    for grain in order:
        inset = margin * radii[grain]
        for _ in range(TRIALS_PER_GRAIN):
            place = random.uniform(box[:, 0] + inset, box[:, 1] - inset)
            if cells.free(place, radii[grain]):
                break
        else:
            raise RuntimeError(f"no room for {len(radii)} grains in a box of {np.prod(box[:, 1] - box[:, 0]):.3g} m3")
        cells.add(place, radii[grain])
        centres[grain] = place
    return Packing(centres, radii)


def glued_layer(
    grains: Grains, x: tuple[float, float], y: tuple[float, float], periodic_x: bool, random: np.random.Generator
) -> Packing:
    """A layer of grains with their centres at z = 0, as dense as random sequential addition makes it."""
    cells = _Cells(np.array([x, y, (-1.0, 1.0)]), grains.largest_diameter, (periodic_x, True, False))
    centres: list[Array] = []
    radii: list[float] = []
    failures, allowed = 0, 400
    while failures < allowed:
        radius = float(random_radii(grains, 1, random)[0])
        for _ in range(20):
            place = np.array([random.uniform(*x), random.uniform(*y), 0.0])
            if cells.free(place, radius):
                cells.add(place, radius)
                centres.append(place)
                radii.append(radius)
                failures = 0
                break
        else:
            failures += 1
    return Packing(np.array(centres), np.array(radii))


def cut(packing: Packing, height: float) -> Packing:
    """The grains whose centre lies below `height` [m]: their mean volume is that of the packing cut by a plane."""
    return packing.chosen(packing.centres[:, 2] < height)


class _Cells:
    """Placed spheres in cells as wide as the largest diameter, for quick tests of overlap."""

    def __init__(self, box: Array, width: float, periodic: tuple[bool, bool, bool]) -> None:
        self.low = box[:, 0]
        self.size = box[:, 1] - box[:, 0]
        self.periodic = np.array(periodic)
        self.number = np.maximum((self.size / width).astype(int), 1)
        self.content: dict[tuple[int, ...], list[tuple[Array, float]]] = {}

    def _cell(self, place: Array) -> NDArray[np.int64]:
        index = ((place - self.low) / self.size * self.number).astype(int)
        return np.clip(index, 0, self.number - 1)

    def add(self, place: Array, radius: float) -> None:
        self.content.setdefault(tuple(self._cell(place)), []).append((place, radius))

    def free(self, place: Array, radius: float) -> bool:
        """Whether a sphere there would overlap none of those placed so far."""
        middle = self._cell(place)
        seen = set()
        for shift in np.ndindex(3, 3, 3):
            index = middle + np.array(shift) - 1
            wrapped = np.where(self.periodic, index % self.number, index)
            key = tuple(int(i) for i in wrapped)
            if key in seen:
                continue
            seen.add(key)
            for other, other_radius in self.content.get(key, ()):
                apart = place - other
                apart = np.where(self.periodic, apart - self.size * np.round(apart / self.size), apart)
                if float(apart @ apart) < (radius + other_radius) ** 2:
                    return False
        return True
