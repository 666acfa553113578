"""The points of another code as an observation: spread and cut at half as our own points are.

Each point holds its share, by mass, volume or number, of the column that a run starts with. Spread, it gives the part
of the space that material at the density of the start would fill; the surface is where that falls through one half.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.space import Space
from grainlaw.validation.grains.material_points import mirrored
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import Setting, observe
from grainlaw.validation.grains.plausibility import LARGEST_SHIFT, axis_of
from grainlaw.validation.grains.run_description import RUN_DESCRIPTION_NAME
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot
from grainlaw.validation.grains.surface_table import is_surface_table, read_surface_table
from grainlaw.validation.mpm.description import StateDescription, read_state_description
from grainlaw.validation.mpm.points import Points, read_points

# Of the spread, along x; a column that falls unevenly to both sides is off by less.
MOST_ASIDE = 2.0 * LARGEST_SHIFT
# Of the height, up or down, or a kernel: codes let points sink by cells, but not by more.
MOST_ABOVE_FLOOR = 0.1
# By which the points may lie more densely, or less, than the run's column at the start.
SAME_DENSITY = 2.0
LOWEST_SHARE = 1.0


@dataclass(frozen=True)
class Start:
    """The column that a run starts with: volume [m3], per metre of depth in plane strain, and kernel width [m]."""

    volume: float
    width: float


@dataclass(frozen=True)
class State:
    """What a file tells: points, or a surface over time."""

    path: Path
    points: Points | None
    description: StateDescription

    @property
    def label(self) -> str:
        """The code's name, or the file's."""
        return self.description.code or self.path.stem

    @property
    def count(self) -> int | None:
        """Number of points."""
        return None if self.points is None else len(self.points.positions)

    def observed(self, start: Start, of_run: Space, end: float) -> Observation:
        """The surface, and half width and height, beside a run that starts so and ends at `end` [s].

        A state that tells no time is taken to be at rest, and so of the end. Raises InputError in one line for points
        that cannot be those of this column.
        """
        if self.points is None:
            return read_surface_table(self.path, start.width)
        return _observed(self, self.points, start, self.description.in_space(of_run), end)


def read_state(path: Path) -> State:
    """Points or a surface of another code. Raises InputError in one line for whatever is wrong in the file."""
    if path.is_dir():
        raise InputError(f"{path} is a folder; expected a file of points or of a surface")
    if not path.is_file():
        raise InputError(f"{path} does not exist")
    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty")
    if is_surface_table(path):
        # What the kernel's width decides is not asked for yet.
        space = read_surface_table(path, 1.0).space
        return State(path, None, StateDescription.model_validate({"space": space.name}))
    return State(path, read_points(path), read_state_description(path))


def _observed(state: State, points: Points, start: Start, space: Space, end: float) -> Observation:
    snapshot, setting = _placed(state, points, start, space)
    time = state.description.time if points.time is None else points.time
    snapshot = replace(snapshot, time=end if time is None else time - state.description.release_time)
    description = {"label": state.label, "points": len(points.positions), "at_rest": time is None}
    try:
        found = observe([snapshot], setting, description)
    except InputError as error:
        raise InputError(f"{state.path}: {error}") from None
    densest = float(found.snapshots["solid_fraction"].max())
    within = found.of("interior_solid_fraction")[0]
    density = densest if np.isnan(within) else float(within)
    if not 1.0 / SAME_DENSITY < density < SAME_DENSITY:
        raise InputError(
            f"{state.path}: its points lie {density:.2g} times as densely as in the run's column at the start; not "
            f"the same column, not the same units, or y is up, which {RUN_DESCRIPTION_NAME} beside it must tell"
        )
    return found


def _placed(state: State, points: Points, start: Start, space: Space) -> tuple[GrainSnapshot, Setting]:
    """The points as x, y, z with their shares of the volume, and where the axis and the floor are."""
    description = state.description
    positions = _in_3d(state, points, space)
    shares = np.ones(len(positions)) if points.amounts is None else points.amounts
    volumes = start.volume * shares / shares.sum()
    snapshot = GrainSnapshot(0.0, positions, np.zeros_like(positions), volumes)
    if description.half and not space.hoop:
        snapshot = mirrored(replace(snapshot, solid_volumes=0.5 * volumes), description.center)
    setting = Setting(start.width, 1.0, description.floor_level, description.center, 1.0, 1.0, bulk=1.0, space=space)
    if not space.hoop:
        _refuse_aside(state, snapshot)
    elif points.positions.shape[1] == 3:
        x, y = axis_of(snapshot, description.axis)
        setting = replace(setting, center=x, center_y=y)
    _refuse_other_floor(state, snapshot, start.width)
    return snapshot, setting


def _in_3d(state: State, points: Points, space: Space) -> Array:
    """Rows of x along the slope, y the depth, z up; points of a plane are (x, y up), or (r, z) around an axis."""
    x, *others = points.positions.T
    if len(others) == 2 and (np.ptp(others[1]) > 0.0 or state.description.up == "z"):
        y, z = others if state.description.up != "y" else reversed(others)
        return np.column_stack([x, y, z])
    if space.hoop and points.amounts is None:
        raise InputError(
            f"{state.path}: points of a plane around an axis stand for rings of different volume; a volume or a mass "
            "of each is needed"
        )
    if space.hoop and x.min() < 0.0:
        raise InputError(f"{state.path}: x down to {x.min():g} m; around an axis x is the distance from it, >= 0")
    return np.column_stack([x, np.zeros_like(x), others[0]])


def _refuse_aside(state: State, snapshot: GrainSnapshot) -> None:
    center = state.description.center
    x = snapshot.positions[:, 0]
    middle = float(np.average(x, weights=snapshot.solid_volumes))
    if abs(middle - center) > MOST_ASIDE * float(np.std(x)):
        raise InputError(
            f"{state.path}: the centre of mass is at x = {middle:.4g} m, the axis at {center:g} m; "
            f'{RUN_DESCRIPTION_NAME} beside it must tell "center", or "half": true for the half of a column'
        )


def _refuse_other_floor(state: State, snapshot: GrainSnapshot, width: float) -> None:
    floor = state.description.floor_level
    lowest, highest = np.percentile(snapshot.positions[:, 2], [LOWEST_SHARE, 100.0])
    if abs(lowest - floor) > max(MOST_ABOVE_FLOOR * (highest - lowest), width):
        raise InputError(
            f"{state.path}: the lowest points are at {lowest:.4g} m, the floor at {floor:g} m; {RUN_DESCRIPTION_NAME} "
            f'beside it must tell "floor_level"'
        )


def spacing_of(state: State, start_volume: float, space: Space) -> float:
    """The distance of the points of a state from one another in the column at the start [m]; 0 of a surface."""
    if state.points is None:
        return 0.0
    positions = state.points.positions
    per_point = start_volume / len(positions)
    if not space.hoop:
        return float(np.sqrt(per_point))
    if positions.shape[1] == 3:
        return float(np.cbrt(per_point))
    return float(np.sqrt(per_point / (2.0 * np.pi * np.abs(positions[:, 0]).mean())))
