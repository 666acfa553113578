"""The plane that a picture shows: that of the scene, the half-plane and its mirror image, or a cut through 3D."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.middle import middle_of_points
from grainlaw.mpm_core.output.run_folder import SCENE_NAME, RunFolder

_NAMES = "xyz"


@dataclass(frozen=True)
class ShownPoints:
    """Points as a cut shows them.

    places   across, up and, on a cut through 3D, away from the plane, shape (n, 2 or 3) [m]
    numbers  of these points among all, shape (n,)
    """

    places: NDArray[np.float64]
    numbers: NDArray[np.int64]


@dataclass(frozen=True)
class Cut:
    """A plane by its axes across and up, and in 3D by its normal axis and where on it the plane lies [m].

    `is_mirrored`: x is a radius, and the other half of the section is shown, too.
    """

    across: int = 0
    up: int = 1
    normal: int | None = None
    place: float = 0.0
    is_mirrored: bool = False

    @property
    def labels(self) -> tuple[str, str]:
        """How the two axes are labelled."""
        radius = "radius " if self.is_mirrored else ""
        return f"{radius}${_NAMES[self.across]}$ [m]", f"${_NAMES[self.up]}$ [m]"

    @property
    def name(self) -> str:
        """Which plane it is; nothing where there is only one."""
        # A middle of round-off is zero.
        return (
            "" if self.normal is None else rf"${_NAMES[self.normal]} = {round(self.place, 9) + 0.0:.3g}\,\mathrm{{m}}$"
        )

    def points_within(self, reach: float, positions: NDArray[np.float64]) -> ShownPoints:
        """The points, of shape (n, 3) [m], that lie within `reach` [m] of the plane, and the mirrored ones."""
        places = positions[:, [self.across, self.up]]
        if self.normal is not None:
            away = positions[:, self.normal] - self.place
            near = np.flatnonzero(np.abs(away) < reach)
            return ShownPoints(np.column_stack([places[near], away[near]]), near)
        numbers = np.arange(len(places))
        if self.is_mirrored:
            return ShownPoints(np.concatenate([places * [-1.0, 1.0], places]), np.concatenate([numbers, numbers]))
        return ShownPoints(places, numbers)


PLANE = Cut()


def cuts_of(run: RunFolder) -> tuple[Cut, ...]:
    """The planes that pictures of a run show: one, or in 3D the vertical ones through the middle, along x and along y.

    In 3D there is none along an axis on which the bodies cannot spread. Raises InputError if a frame is missing, or
    what the scene tells of the domain.
    """
    if run.space.hoop:
        return (Cut(is_mirrored=True),)
    if run.space.axes == 2:
        return (PLANE,)
    positions = run.load_frame(run.first_with_points).positions
    with _told_by_scene(run):
        middle = middle_of_points(positions, run.scene)
    both = Cut(0, 2, 1, middle.place[1]), Cut(1, 2, 0, middle.place[0])
    return tuple(cut for cut, spreads in zip(both, middle.spreads, strict=True) if spreads)


def domain_of(run: RunFolder) -> NDArray[np.float64]:
    """The two corners of a run's domain, shape (2, axes) [m]. Raises InputError if the scene does not tell them."""
    with _told_by_scene(run):
        return np.array([run.scene["grid"][name] for name in ("lower", "upper")], np.float64).reshape(2, run.space.axes)


@contextmanager
def _told_by_scene(run: RunFolder) -> Iterator[None]:
    try:
        yield
    except (LookupError, TypeError, ValueError) as error:
        raise InputError(f"{run.path / SCENE_NAME} does not tell the domain and its sides: {error!r}") from error
