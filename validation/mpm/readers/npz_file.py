"""Archives of arrays, `numpy.savez` and `savez_compressed`: only what is asked for is unpacked."""

import zipfile
import zlib
from math import prod
from pathlib import Path

import numpy as np
from numpy.lib import format as npy_format

from grainlaw.materials import InputError
from grainlaw.validation.grains.snapshot import Array
from grainlaw.validation.mpm.readers.point_table import PointTable, refuse_too_many

SIGNATURE = b"PK\x03\x04"
ENDING = ".npz"
MEMBER = ".npy"
UNREADABLE = (
    OSError,
    EOFError,
    ValueError,
    KeyError,
    zipfile.BadZipFile,
    zlib.error,
    NotImplementedError,
    RuntimeError,
)


def recognises(path: Path, start: bytes) -> bool:
    """By the signature of a zip archive, or the ending."""
    return start.startswith(SIGNATURE) or path.suffix == ENDING


def read_table(path: Path) -> PointTable:
    """The arrays of numbers in an archive; others, which only pickle could read, are passed over.

    Raises InputError in one line for a damaged archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            shapes = {
                member.filename.removesuffix(MEMBER): shape
                for member in archive.infolist()
                if member.filename.endswith(MEMBER) and (shape := _shape(archive, member)) is not None
            }
    except UNREADABLE as error:
        raise InputError(f"{path} cannot be read as npz: {error}") from None
    return PointTable(path, shapes, lambda name: _load(path, name, shapes[name]))


def _shape(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> tuple[int, ...] | None:
    """The shape that the head of an array tells, if it holds numbers. Raises ValueError where the rest is missing."""
    with archive.open(member) as file:
        version = npy_format.read_magic(file)
        read_header = npy_format.read_array_header_1_0 if version == (1, 0) else npy_format.read_array_header_2_0
        shape, _, kind = read_header(file)
        if not np.issubdtype(kind, np.number):
            return None
        if member.file_size - file.tell() != prod(shape) * kind.itemsize:
            raise ValueError(f"{member.filename} is not as long as its shape {shape} says")
    return shape


def _load(path: Path, name: str, shape: tuple[int, ...]) -> Array:
    refuse_too_many(path, shape[0] if shape else 1)
    try:
        with np.load(path, allow_pickle=False) as archive:
            return np.asarray(archive[name], float)
    except UNREADABLE as error:
        raise InputError(f"{path}: '{name}' cannot be read: {error}") from None
