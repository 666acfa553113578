"""One frame as one VTU file: a vertex cell per point, written and read through meshio.

meshio is no longer developed, so nothing but this module and `scene.mesh_file` knows of it. Its writer has no place for
units and time; they are put into the finished XML, where VTK keeps them: the unit of each array under the information
key `UNITS_LABEL`, time and step as field data (`TimeValue` is the name that the readers of VTK look for).
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.frame import Field, Frame

_POSITION_ARRAY = "Points"
_START_OF_ARRAY, _END_OF_ARRAY = b"<DataArray ", b"</DataArray>"
# Bytes in which the number of points is told.
_HEAD = 2048
_START_OF_GRID = b"<UnstructuredGrid>"


def write_vtu(path: Path, frame: Frame) -> None:
    """Write a frame: positions in double, fields in single precision, zlib-compressed."""
    cells = np.arange(len(frame.positions), dtype=np.int32)[:, None]
    mesh = meshio.Mesh(
        np.ascontiguousarray(frame.positions, dtype=np.float64),
        [("vertex", cells)],
        point_data={field.name: field.stored_values() for field in frame.fields},
    )
    with atomic.replacing(path) as partial:
        plain = partial.with_name(f"{partial.name}-plain")
        try:
            meshio.vtu.write(plain, mesh, compression="zlib")
            with plain.open("rb") as lines, partial.open("wb") as told:
                told.writelines(_with_time_and_units(lines, frame))
        finally:
            plain.unlink(missing_ok=True)


def read_vtu(path: Path, documentation: dict[str, tuple[str, str]]) -> Frame:
    """Read a frame that `write_vtu` wrote; `documentation` maps the name of a field to its unit and doc.

    Raises InputError if the file is missing or cannot be read.
    """
    if not path.is_file():
        raise InputError(f"frame {path} is missing")
    try:
        empty = _empty_frame(path, documentation)
        if empty is not None:
            return empty
        mesh = meshio.vtu.read(path)
        time, step = float(mesh.field_data["TimeValue"][0]), int(mesh.field_data["step"][0])
    except Exception as error:  # meshio raises whatever its parser meets
        raise InputError(f"frame {path} cannot be read: {type(error).__name__}: {error}") from error
    fields = tuple(
        Field(name, *documentation.get(name, ("", "")), np.asarray(values, dtype=np.float64))
        for name, values in mesh.point_data.items()
    )
    return Frame(time, step, mesh.points, fields)


def _empty_frame(path: Path, documentation: dict[str, tuple[str, str]]) -> Frame | None:
    """A frame after all material has left, which meshio does not read; None if the file holds points."""
    with path.open("rb") as file:
        if b'NumberOfPoints="0"' not in file.read(_HEAD):
            return None
    root = ElementTree.parse(path).getroot()
    told = {array.get("Name"): array.text or "" for array in root.iterfind(".//FieldData/DataArray")}
    fields = tuple(
        Field(name, *documentation.get(name, ("", "")), np.empty((0, 3) if array.get("NumberOfComponents") else (0,)))
        for array in root.iterfind(".//PointData/DataArray")
        if (name := array.get("Name")) is not None
    )
    return Frame(float(told["TimeValue"]), int(told["step"]), np.empty((0, 3)), fields)


def _with_time_and_units(lines: Iterable[bytes], frame: Frame) -> Iterator[bytes]:
    """The XML of meshio with the field data at the head of the grid and a unit at the end of each point array.

    The values of an array are one line, so that no more than one of them is in memory.
    """
    units = {_POSITION_ARRAY: "m"} | {field.name: field.unit for field in frame.fields}
    name = ""
    for line in lines:
        if line.startswith(_START_OF_ARRAY):
            name = ElementTree.fromstring(line + _END_OF_ARRAY).attrib["Name"]
        elif line.startswith(_END_OF_ARRAY) and name in units:
            yield _unit_key(units[name])
        yield line
        if line.startswith(_START_OF_GRID):
            yield _time_and_step(frame)


def _time_and_step(frame: Frame) -> bytes:
    return (
        "<FieldData>\n"
        f'<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{frame.time!r}</DataArray>\n'
        f'<DataArray type="Int64" Name="step" NumberOfTuples="1" format="ascii">{frame.step}</DataArray>\n'
        "</FieldData>\n"
    ).encode()


def _unit_key(unit: str) -> bytes:
    return f'<InformationKey name="UNITS_LABEL" location="vtkDataArray">{unit}</InformationKey>\n'.encode()
