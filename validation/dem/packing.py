"""Loose random arrangements to start from, the glued floor, and the cut of a settled packing."""

from dataclasses import dataclass

import numpy as np
from numba import njit
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


def loose(
    radii: Array,
    box: Array,
    periodic: tuple[bool, bool, bool],
    random: np.random.Generator,
    cylinder: float = np.inf,
) -> Packing:
    """Random sequential addition of spheres without overlap into `box` (3, 2) [m].

    They stay within the radius `cylinder` [m] of the axis x = y = 0.
    Raises RuntimeError if the box is too full for it (beyond a solid fraction of about 0.35).
    """
    cells = _Cells(box, 2.0 * float(radii.max()), periodic, len(radii))
    order = np.argsort(radii)[::-1]
    centres = np.empty((len(radii), 3))
    margin = np.where(periodic, 0.0, 1.0)
    for grain in order:
        inset = margin * radii[grain]
        for _ in range(TRIALS_PER_GRAIN):
            place = random.uniform(box[:, 0] + inset, box[:, 1] - inset)
            if np.hypot(place[0], place[1]) + radii[grain] < cylinder and cells.free(place, radii[grain]):
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
    # Discs of the smallest grains side by side, not one more fits.
    most = int(
        np.ceil(
            (np.ptp(x) + grains.largest_diameter)
            * (np.ptp(y) + grains.largest_diameter)
            / (np.pi / 4.0 * grains.smallest_diameter**2)
        )
    )
    cells = _Cells(np.array([x, y, (-1.0, 1.0)]), grains.largest_diameter, (periodic_x, True, False), most)
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


def repeated(tile: Packing, side: float, radius: float) -> Packing:
    """A tile, periodic over the square of `side` [m], again and again over the disc of a radius [m] around 0."""
    number = int(np.ceil(radius / side))
    steps = side * np.arange(-number, number)
    shifts = np.array([(x, y, 0.0) for x in steps for y in steps])
    centres = (shifts[:, None, :] + tile.centres).reshape(-1, 3)
    whole = Packing(centres, np.tile(tile.radii, len(shifts)))
    return whole.chosen(np.hypot(centres[:, 0], centres[:, 1]) < radius)


def cut(packing: Packing, height: float) -> Packing:
    """The grains whose centre lies below `height` [m]: their mean volume is that of the packing cut by a plane."""
    return packing.chosen(packing.centres[:, 2] < height)


class _Cells:
    """Placed spheres in cells as wide as the largest diameter, for quick tests of overlap."""

    def __init__(self, box: Array, width: float, periodic: tuple[bool, bool, bool], most: int) -> None:
        self.low = box[:, 0]
        self.size = box[:, 1] - box[:, 0]
        self.periodic = np.array(periodic)
        self.number = np.maximum((self.size / width).astype(np.int64), 1)
        # The newest sphere of each cell and, of each sphere, the one before it there; -1: none.
        self.newest = np.full(tuple(self.number), -1, dtype=np.int64)
        self.before = np.empty(most, dtype=np.int64)
        self.centres = np.empty((most, 3))
        self.radii = np.empty(most)
        self.count = 0

    def add(self, place: Array, radius: float) -> None:
        """Place a sphere there. Raises IndexError beyond the number that was announced."""
        cell = tuple(np.clip((place - self.low) / self.size * self.number, 0, self.number - 1).astype(np.int64))
        self.centres[self.count], self.radii[self.count] = place, radius
        self.before[self.count] = self.newest[cell]
        self.newest[cell] = self.count
        self.count += 1

    def free(self, place: Array, radius: float) -> bool:
        """Whether a sphere there would overlap none of those placed so far."""
        return bool(
            _free(
                place,
                radius,
                self.low,
                self.size,
                self.number,
                self.periodic,
                self.newest,
                self.before,
                self.centres,
                self.radii,
            )
        )


@njit(cache=True)
def _free(place, radius, low, size, number, periodic, newest, before, centres, radii):  # type: ignore[no-untyped-def]
    cell = np.empty(3, np.int64)
    middle = np.empty(3, np.int64)
    for axis in range(3):
        middle[axis] = min(max(int((place[axis] - low[axis]) / size[axis] * number[axis]), 0), number[axis] - 1)
    for shift in range(27):
        rest = shift
        inside = True
        for axis in range(3):
            cell[axis] = middle[axis] + rest % 3 - 1
            rest //= 3
            if periodic[axis]:
                cell[axis] %= number[axis]
            elif not 0 <= cell[axis] < number[axis]:
                inside = False
        other = newest[cell[0], cell[1], cell[2]] if inside else -1
        while other >= 0:
            square = 0.0
            for axis in range(3):
                apart = place[axis] - centres[other, axis]
                if periodic[axis]:
                    apart -= size[axis] * np.round(apart / size[axis])
                square += apart * apart
            if square < (radius + radii[other]) ** 2:
                return False
            other = before[other]
    return True
