"""`history.csv`: scalars of the whole run, one row per recorded step."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from grainlaw.mpm_core.output.rows import RowsWriter, read_rows
from grainlaw.mpm_core.space import PLANE_STRAIN, SPACES, Space

HISTORY_NAME = "history.csv"


@dataclass(frozen=True)
class HistoryColumn:
    """One column: name, SI unit, doc, and whether its values are whole numbers.

    `in_spaces` is the doc by the name of a space, where that makes a difference. An energy has the unit J, a mass kg,
    and its doc says "{per}" where it tells what it is per, as the space has it.
    """

    name: str
    unit: str
    doc: str
    whole_number: bool = False
    in_spaces: Mapping[str, str] = field(default_factory=dict)

    def in_space(self, space: Space) -> "HistoryColumn":
        """The column with the unit and the doc that it has in a space."""
        unit = self.unit + space.amount if self.unit in _AMOUNTS else self.unit
        doc = self.in_spaces.get(space.name, self.doc).format(per=_PER[space.amount])
        return replace(self, unit=unit, doc=doc, in_spaces={})

    def in_all_spaces(self) -> "HistoryColumn":
        """The column with the units and the docs that it has in one or the other space."""
        units = [self.in_space(space).unit for space in SPACES.values()]
        unit = ", ".join(dict.fromkeys(units))
        docs = [self.doc, *(f"{_IN_WORDS[name]} {doc}" for name, doc in self.in_spaces.items())]
        return replace(self, unit=unit, doc="; ".join(docs).format(per=""), in_spaces={})


# Units of what is per width or per radian in some spaces.
_AMOUNTS = ("J", "kg")
# What amounts are per, and how spaces are named in a sentence.
_PER = {"/m": " per width", "/rad": " per radian", "": ""}
_IN_WORDS = {"axisymmetric": "in axisymmetry", "3d": "in 3D"}


def energy_unit(space: Space) -> str:
    """The unit of energies in a space."""
    return f"J{space.amount}"


_COLUMNS = (
    HistoryColumn("t", "s", "time"),
    HistoryColumn("dt", "s", "time step"),
    HistoryColumn(
        "runout",
        "m",
        "half of the distance between the fronts",
        in_spaces={
            "axisymmetric": "the radius beyond which lies 2 % of the mass",
            "3d": "the horizontal distance from where the bodies' middle was, beyond which lies 2 % of the mass",
        },
    ),
    HistoryColumn("front_left", "m", "x to the left of which lies 1 % of the mass"),
    HistoryColumn("front_right", "m", "x to the right of which lies 1 % of the mass"),
    HistoryColumn("height", "m", "level above which lies one cell's worth of material, from the floor of the domain"),
    HistoryColumn("center_of_mass_height", "m", "height of the centre of mass above the floor of the domain"),
    HistoryColumn("kinetic_energy", "J", "kinetic energy{per} in the middle of the last step, where velocities belong"),
    HistoryColumn("potential_energy", "J", "potential energy of gravity{per} relative to the start"),
    HistoryColumn("internal_work", "J", "work of the stress{per} since the start, elastic or not"),
    HistoryColumn(
        "internal_work_on_nodes",
        "J",
        "energy of motion{per} that internal forces took from the nodes since the start; compare `internal_work`",
    ),
    HistoryColumn("elastic_energy", "J", "elastic energy{per}; nan where a law does not state it (`stored_energy`)"),
    HistoryColumn("inelastic_work", "J", "plastic and viscous work{per} since the start: internal work not stored"),
    HistoryColumn("wall_work", "J", "work done on the walls{per} since the start: friction and what they stop"),
    HistoryColumn("wall_friction", "J", "part of `wall_work` that sliding on friction walls dissipated"),
    HistoryColumn("obstacle_work", "J", "work done on the obstacles{per} since the start: friction and what they stop"),
    HistoryColumn("obstacle_friction", "J", "part of `obstacle_work` that sliding on obstacles dissipated"),
    HistoryColumn("mass_left", "kg", "mass{per} that left through open sides since the start"),
    HistoryColumn(
        "outflow",
        "J",
        "energy of motion and height{per} that it took along, height over the lower corner of the domain",
    ),
    HistoryColumn("mass_in", "kg", "mass{per} that entered through inflows since the start"),
    HistoryColumn(
        "inflow", "J", "energy of motion and height that it brought, height over the lower corner of the domain"
    ),
    HistoryColumn("numerical_dissipation", "J", "energy that transfers and time integration took{per} since the start"),
    HistoryColumn(
        "volume_projection", "J", "part of `potential_energy` that points gained by being moved apart, since the start"
    ),
    HistoryColumn(
        "overfill", "1", "mean over the cells inside loose material of the volume of points over the room, less one"
    ),
    HistoryColumn("overfill_scatter", "1", "standard deviation of the same"),
    HistoryColumn("points_asleep", "1", "number of points that sleep (`sleep` of the scene)", whole_number=True),
    HistoryColumn("step", "1", "number of the step", whole_number=True),
    HistoryColumn("wall_time", "s", "wall-clock time since the start of the run"),
)
_TYPES: dict[str, type] = {column.name: int if column.whole_number else float for column in _COLUMNS}


def history_columns(space: Space = PLANE_STRAIN) -> tuple[HistoryColumn, ...]:
    """The columns of the history of a run in a space; their names are the same in all."""
    return tuple(column.in_space(space) for column in _COLUMNS)


def columns_in_all_spaces() -> tuple[HistoryColumn, ...]:
    """The columns with the units and the docs of all spaces."""
    return tuple(column.in_all_spaces() for column in _COLUMNS)


class HistoryWriter(RowsWriter):
    """Appends rows to `history.csv` of a run's folder."""

    def __init__(self, folder: Path) -> None:
        """Continue the history that the folder holds, or start one. Raises InputError for one with other columns."""
        super().__init__(folder / HISTORY_NAME, _TYPES)


def read_history(folder: Path) -> NDArray[Any]:
    """The history of a run's folder as a structured array of shape (rows,), one named field per column.

    A last row that is still being written is left out. Raises InputError if the file is missing or cannot be read.
    """
    return read_rows(folder / HISTORY_NAME, _TYPES)
