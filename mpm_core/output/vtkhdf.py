"""`run.vtkhdf`: all frames of a run in one file, a temporal PolyData of vertices (VTKHDF 2.0) through h5py.

Layout: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html. Positions and
fields of the steps lie one after the other; `Steps/PointOffsets` and `Steps/PointDataOffsets/NAME` say where each
begins. The vertices are stored once: those of a step are the first ones, as many as it has points.

A frame is appended in place, since writing a copy for each would cost the square of the number of frames. Each step has
chunks of its own in each array, one where it has no more points than the first, so that the data of earlier steps is
never touched, and the new index is put into the file last: a run that is killed while it appends, or finds the disk
full, leaves them readable. Only the moment in which the index is written is not protected; a resumed run therefore
writes the file anew, from the VTU frames or else from itself, which also drops the steps after the checkpoint.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import atomic
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.hdf5_file import changed_hdf5, new_hdf5
from grainlaw.mpm_core.output.hdf5_reading import existing_hdf5, numbers_of

VTKHDF_NAME = "run.vtkhdf"
_CELL_KINDS = ("Vertices", "Lines", "Polygons", "Strips")
_STEPS_PER_CHUNK = 1024
# Of a run that begins with fewer points, or none.
_FEWEST_POINTS_OF_A_CHUNK = 1024


def append_frame(path: Path, frame: Frame) -> None:
    """Append a frame to the file, which is created with its first frame.

    Raises OSError where the disk is full; the file is then as it was.
    """
    if not path.exists():
        with atomic.replacing(path) as partial, new_hdf5(partial, libver="earliest") as file:
            root = file.create_group("VTKHDF")
            _create_layout(root, frame)
            _append(root, frame)
        return
    with changed_hdf5(path) as file:
        _append(file["VTKHDF"], frame)


def drop_after(path: Path, time: float) -> None:
    """Write the file anew without the frames later than `time` [s], that of the checkpoint from which the run resumes.

    Raises InputError, or what h5py raises, for a damaged file, which is left as it was.
    """
    if not path.exists():
        return
    with atomic.replacing(path) as partial:
        partial.unlink(missing_ok=True)
        with existing_hdf5(path) as file:
            for frame in _frames(file["VTKHDF"], time):
                append_frame(partial, frame)


def _frames(root: h5py.Group, last: float) -> Iterator[Frame]:
    """The frames until a time [s]; the file does not hold their step numbers."""
    steps = root["Steps"]
    times = numbers_of(steps["Values"])[: int(steps.attrs["NSteps"])]
    points = numbers_of(root["NumberOfPoints"])[: len(times)].tolist()
    if len(points) != len(times) or not len(times) or not times[0] <= last or not np.all(np.diff(times) > 0):
        raise ValueError(f"{times} s are no times of frames from the start to {last:g} s")
    starts = numbers_of(steps["PointOffsets"])[: len(times)].tolist()
    for number in range(np.count_nonzero(times <= last)):
        rows = slice(starts[number], starts[number] + points[number])
        fields = tuple(
            Field(name, stored.attrs["unit"], stored.attrs["doc"], _rows(stored, rows))
            for name, stored in root["PointData"].items()
        )
        yield Frame(float(times[number]), 0, _rows(root["Points"], rows), fields)


def _rows(dataset: h5py.Dataset, rows: slice) -> NDArray[Any]:
    """Rows of a dataset. Raises ValueError if it does not have them."""
    values = numbers_of(dataset, rows)
    if len(values) != rows.stop - rows.start:
        raise ValueError(f"{dataset.name} has {len(dataset)} rows, fewer than {rows.stop}")
    return values


def _create_layout(root: h5py.Group, frame: Frame) -> None:
    """All groups and datasets, with no step yet."""
    points = len(frame.positions)
    root.attrs["Version"] = (2, 0)
    root.attrs["Type"] = np.bytes_("PolyData")
    _create_by_step(root, "NumberOfPoints")
    for kind in _CELL_KINDS:
        _create_cells(root.create_group(kind), points if kind == "Vertices" else 0)
    _create_by_point(root, "Points", frame.positions, "m", "position")
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    _create_by_step(steps, "Values", dtype=np.float64)
    for name in ("PartOffsets", "NumberOfParts", "PointOffsets"):
        _create_by_step(steps, name)
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        _create_by_step(steps, name, columns=(len(_CELL_KINDS),))
    data, offsets = root.create_group("PointData"), steps.create_group("PointDataOffsets")
    for field in frame.fields:
        _create_by_point(data, field.name, field.stored_values(), field.unit, field.doc)
        _create_by_step(offsets, field.name)


def _create_cells(group: h5py.Group, count: int) -> None:
    """`count` cells of one point each."""
    for name, entries in (("Connectivity", count), ("Offsets", count + 1)):
        chunks = (max(entries, _FEWEST_POINTS_OF_A_CHUNK),)
        group.create_dataset(name, data=np.arange(entries, dtype=np.int64), maxshape=(None,), chunks=chunks)
    _create_by_step(group, "NumberOfCells")
    _create_by_step(group, "NumberOfConnectivityIds")


def _create_by_step(
    group: h5py.Group, name: str, dtype: type[np.generic] = np.int64, columns: tuple[int, ...] = ()
) -> None:
    """An empty dataset that grows by one row per step."""
    chunk = (_STEPS_PER_CHUNK, *columns)
    group.create_dataset(name, (0, *columns), dtype, maxshape=(None, *columns), chunks=chunk)


def _create_by_point(group: h5py.Group, name: str, values: NDArray[np.floating], unit: str, doc: str) -> None:
    """An empty dataset that grows by whole chunks per step, one for as many points as the first has."""
    dataset = group.create_dataset(
        name,
        (0, *values.shape[1:]),
        values.dtype,
        maxshape=(None, *values.shape[1:]),
        chunks=(max(len(values), _FEWEST_POINTS_OF_A_CHUNK), *values.shape[1:]),
        compression="gzip",
        compression_opts=1,
        shuffle=True,
    )
    dataset.attrs["unit"] = unit
    dataset.attrs["doc"] = doc


def _append(root: h5py.Group, frame: Frame) -> None:
    """Append the data first and count the step last."""
    steps, points = root["Steps"], len(frame.positions)
    number = int(steps.attrs["NSteps"])
    first = _first_free_row(root, number)
    _put_vertices(root["Vertices"], points)
    _put(root["Points"], first, frame.positions)
    for field in frame.fields:
        _put(root["PointData"][field.name], first, field.stored_values())
        _put(steps["PointDataOffsets"][field.name], number, [first])
    _put(root["NumberOfPoints"], number, [points])
    for kind in _CELL_KINDS:
        count = points if kind == "Vertices" else 0
        _put(root[kind]["NumberOfCells"], number, [count])
        _put(root[kind]["NumberOfConnectivityIds"], number, [count])
    rows = {"Values": frame.time, "PartOffsets": number, "NumberOfParts": 1, "PointOffsets": first}
    for name, value in rows.items():
        _put(steps[name], number, [value])
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        _put(steps[name], number, np.zeros((1, len(_CELL_KINDS)), dtype=np.int64))
    steps.attrs["NSteps"] = number + 1


def _first_free_row(root: h5py.Group, number: int) -> int:
    """Where the points of a step begin: at a chunk behind those of the step before."""
    if number == 0:
        return 0
    chunk = int(root["Points"].chunks[0])
    end = int(root["Steps/PointOffsets"][number - 1]) + int(root["NumberOfPoints"][number - 1])
    return -(-end // chunk) * chunk


def _put_vertices(group: h5py.Group, points: int) -> None:
    """Have as many cells of one point each as a step has points."""
    for name, entries in (("Connectivity", points), ("Offsets", points + 1)):
        there = len(group[name])
        if entries > there:
            _put(group[name], there, np.arange(there, entries, dtype=np.int64))


def _put(dataset: h5py.Dataset, start: int, rows: NDArray[np.generic] | list[float]) -> None:
    """Write `rows` from row `start` on; the dataset ends after them."""
    dataset.resize(start + len(rows), axis=0)
    dataset[start:] = rows
