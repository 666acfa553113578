"""`forces.csv`: what acts on the obstacles of a run, and where they are; one row for each row of the history."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.obstacles.obstacles import Obstacles
from grainlaw.mpm_core.output.history import HistoryColumn
from grainlaw.mpm_core.output.rows import RowsWriter, read_rows
from grainlaw.mpm_core.space import Space

FORCES_NAME = "forces.csv"
TIME = HistoryColumn("t", "s", "time")


def forces_along(space: Space) -> tuple[str, ...]:
    """The components of a force in a space."""
    return tuple(f"force_{axis}" for axis in space.axis_names)


def torques_about(space: Space) -> tuple[str, ...]:
    """The components of a torque in a space: one in plane strain, none in axisymmetry, where nothing turns."""
    if space.axes == 3:
        return ("torque_x", "torque_y", "torque_z")
    return () if space.hoop else ("torque",)


def force_columns(space: Space, names: Sequence[str]) -> tuple[HistoryColumn, ...]:
    """The columns of the table for obstacles of these names; without any there is no table."""
    columns = [TIME] if names else []
    for name in names:
        for force in forces_along(space):
            doc = f"mean over the interval since the row before of the force on obstacle {name}"
            columns.append(HistoryColumn(f"{name}_{force}", f"N{space.amount}", doc))
        for torque in torques_about(space):
            doc = f"mean over that interval of the torque on obstacle {name} about its position"
            columns.append(HistoryColumn(f"{name}_{torque}", f"N m{space.amount}", doc))
        for axis in space.axis_names:
            columns.append(HistoryColumn(f"{name}_{axis}", "m", f"position of obstacle {name}: the middle of its area"))
    return tuple(columns)


class ForcesWriter(RowsWriter):
    """Appends rows to `forces.csv` of a run's folder."""

    def __init__(self, folder: Path, obstacles: Obstacles, space: Space) -> None:
        """Continue the table that the folder holds, or start one."""
        self.obstacles = obstacles
        self.space = space
        columns = force_columns(space, [obstacle.name for obstacle in obstacles.all])
        super().__init__(folder / FORCES_NAME, {column.name: float for column in columns})

    def append_row(self, time: float) -> None:
        """Append the means since the last row, and begin them anew; NaN for what was taken away."""
        row = dict.fromkeys(self.types, np.nan) | {"t": time}
        for obstacle in self.obstacles.present:
            force, torque = obstacle.forces.means()
            torques = torque if self.space.axes == 3 else torque[2:]
            for names, values in (
                (forces_along(self.space), force),
                (torques_about(self.space), torques),
                (self.space.axis_names, obstacle.motion.pose.position),
            ):
                for name, value in zip(names, values.tolist(), strict=False):
                    row[f"{obstacle.name}_{name}"] = value
            obstacle.forces.reset()
        self.append(row)


def read_forces(folder: Path) -> NDArray[Any]:
    """The table as a structured array of shape (rows,), one named field per column.

    Raises InputError if it is missing, as without obstacles, or cannot be read.
    """
    return read_rows(folder / FORCES_NAME, {})
