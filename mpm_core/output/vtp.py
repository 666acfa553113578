"""The outline of an obstacle as a VTP file: polygons, or triangles in 3D, at one time."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.obstacles.outline import Outline


class ObstacleFrame(NamedTuple):
    """An obstacle at one time [s]; a hollow one is around its outline."""

    time: float
    hollow: bool
    outline: Outline


def write_vtp(path: Path, frame: ObstacleFrame) -> None:
    """Write an obstacle; numbers are text, exact to the last bit."""
    points, faces = frame.outline
    root = ElementTree.Element("VTKFile", type="PolyData", version="0.1", byte_order="LittleEndian")
    data = ElementTree.SubElement(root, "PolyData")
    fields = ElementTree.SubElement(data, "FieldData")
    _put(fields, "Float64", [frame.time], Name="TimeValue", NumberOfTuples="1")
    _put(fields, "Int64", [int(frame.hollow)], Name="hollow", NumberOfTuples="1")
    counts = {"NumberOfPoints": len(points), "NumberOfPolys": len(faces)}
    piece = ElementTree.SubElement(data, "Piece", {name: str(count) for name, count in counts.items()})
    _put(ElementTree.SubElement(piece, "Points"), "Float64", points.ravel().tolist(), NumberOfComponents="3")
    polygons = ElementTree.SubElement(piece, "Polys")
    corners = [int(corner) for face in faces for corner in face]
    _put(polygons, "Int64", corners, Name="connectivity")
    _put(polygons, "Int64", np.cumsum([len(face) for face in faces], dtype=np.int64).tolist(), Name="offsets")
    atomic.write_bytes(path, ElementTree.tostring(root, xml_declaration=True))


def read_vtp(path: Path) -> ObstacleFrame:
    """Read an obstacle that `write_vtp` wrote. Raises InputError if the file is missing or cannot be read."""
    if not path.is_file():
        raise InputError(f"obstacle {path} is missing")
    try:
        root = ElementTree.parse(path).getroot()
        arrays = {array.get("Name", "Points"): (array.text or "").split() for array in root.iter("DataArray")}
        points = np.array(arrays["Points"], np.float64).reshape(-1, 3)
        corners = np.array(arrays["connectivity"], np.int64)
        ends = np.array(arrays["offsets"], np.int64)
        if len(corners) and not 0 <= corners.min() <= corners.max() < len(points):
            raise ValueError("corners of faces are no points")
        faces = np.split(corners, ends[:-1]) if len(ends) else []
        return ObstacleFrame(float(arrays["TimeValue"][0]), arrays["hollow"] == ["1"], Outline(points, faces))
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise InputError(f"obstacle {path} cannot be read: {error}") from error


def _put(parent: ElementTree.Element, kind: str, values: Sequence[float], **names: str) -> None:
    array = ElementTree.SubElement(parent, "DataArray", {"type": kind, "format": "ascii", **names})
    array.text = " ".join(map(repr, values))
