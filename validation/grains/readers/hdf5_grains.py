"""Grains in HDF5: `/frames/NNNNNN` with the attribute `time` [s] and the datasets position, velocity and radius.

position and velocity have the shape (n, 3), radius and the optional type the shape (n,); SI units.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.hdf5_reading import UNREADABLE, existing_hdf5, numbers_of
from grainlaw.validation.grains.readers.raw_frame import RawFrame
from grainlaw.validation.grains.readers.text_file import is_packed

SIGNATURE = b"\x89HDF\r\n\x1a\n"
FRAMES = "frames"


def recognises(path: Path, start: bytes) -> bool:
    """By the signature of HDF5 or the ending."""
    return start.startswith(SIGNATURE) or path.suffix in (".h5", ".hdf5")


def frames(path: Path) -> Iterator[RawFrame]:
    """All frames in the order of their names. Raises InputError for a damaged file or one of another kind."""
    if is_packed(path):
        raise InputError(f"{path} is packed by gzip, which HDF5 does not read; unpack it first")
    try:
        with existing_hdf5(path) as file:
            if FRAMES not in file or len(file[FRAMES]) == 0:
                raise InputError(f"{path} has no group '{FRAMES}' with grains in it")
            for name in sorted(file[FRAMES]):
                yield _frame(path, name, file[FRAMES][name])
    except UNREADABLE as error:
        raise InputError(f"{path} cannot be read as HDF5: {error}") from None


def _frame(path: Path, name: str, group: h5py.Group) -> RawFrame:
    columns: dict[str, Any] = {}
    for key, shape, parts in (
        ("position", 2, ("x", "y", "z")),
        ("velocity", 2, ("vx", "vy", "vz")),
        ("radius", 1, ("radius",)),
        ("type", 1, ("type",)),
    ):
        if key not in group:
            if key in ("position", "radius"):
                raise InputError(f"{path}: {FRAMES}/{name} has no dataset '{key}'")
            continue
        values = numbers_of(group[key]).astype(float)
        if values.ndim != shape or (shape == 2 and values.shape[1] != 3):
            wanted = "(n, 3)" if shape == 2 else "(n,)"
            raise InputError(f"{path}: {FRAMES}/{name}/{key} has the shape {values.shape}, expected {wanted}")
        columns.update(zip(parts, values.reshape(len(values), -1).T, strict=True))
    if len({len(values) for values in columns.values()}) > 1:
        raise InputError(f"{path}: the datasets of {FRAMES}/{name} differ in length")
    time = float(group.attrs["time"]) if "time" in group.attrs else None
    return RawFrame(path, columns, time, complete=True)
