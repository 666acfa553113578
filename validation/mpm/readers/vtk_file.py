"""VTK point data, legacy and XML, through the reader that survives damaged files."""

from pathlib import Path

import numpy as np

from grainlaw.validation.grains.readers import vtk_points
from grainlaw.validation.mpm.readers.point_table import PointTable, refuse_too_many, table_of_arrays


def recognises(path: Path, start: bytes) -> bool:
    """By the ending, as VTK's own reader does."""
    return vtk_points.recognises(path, start)


def read_table(path: Path) -> PointTable:
    """The points, and what each of them holds. Raises InputError in one line for a damaged file."""
    data = vtk_points.read_points(path)
    refuse_too_many(path, int(data.n_points))
    arrays = {name: np.asarray(data.point_data[name]) for name in data.point_data}
    if (time := vtk_points.time_of(data)) is not None:
        arrays["time"] = np.array(time)
    numbers = {name: values for name, values in arrays.items() if np.issubdtype(values.dtype, np.number)}
    return table_of_arrays(path, numbers, np.asarray(data.points, float))
