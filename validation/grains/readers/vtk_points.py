"""VTK point data of LIGGGHTS (`dump custom/vtk`) and YADE (`VTKRecorder`, spheres): legacy and XML files."""

import contextlib
import logging
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.damaged_files import refuse_fatal
from grainlaw.validation.grains.readers.columns import VECTORS, settled
from grainlaw.validation.grains.readers.raw_frame import RawFrame
from grainlaw.validation.grains.readers.text_file import is_packed

ENDINGS = (".vtk", ".vtp", ".vtu")
# Of a file, where the counts stand that are checked; and the most points that one may hold.
START, MOST = 2**16, 2**31 - 1
_COUNT = re.compile(rb"\b(NumberOf\w+(?==\")|(?:POINTS|CELLS|VERTICES|POINT_DATA)(?= ))[= ]\"?([^\" \n]*)")
# How pyvista tells that VTK gave up on a file and returned what it had.
FAILED = ".*raised an error while reading"
_LAST_NUMBER = re.compile(r"(\d+)\D*$")


def recognises(path: Path, start: bytes) -> bool:
    """By the ending, as VTK's own reader does."""
    return path.suffix in ENDINGS


def frames(path: Path) -> Iterator[RawFrame]:
    """The one frame of a file; its time is the field `TIME` if there is one, its step the last number of its name."""
    data = read_points(path)
    columns = dict(zip("xyz", np.asarray(data.points, float).T, strict=True))
    for name in data.point_data:
        values = np.asarray(data.point_data[name])
        if not np.issubdtype(values.dtype, np.number):
            continue
        if values.ndim == 1:
            columns[name] = values.astype(float)
        elif name in VECTORS:
            if values.shape[1] != 3:
                raise InputError(f"{path}: '{name}' has {values.shape[1]} components, expected 3")
            columns.update(zip(VECTORS[name], values.T.astype(float), strict=True))
    number = _LAST_NUMBER.search(path.stem)
    yield RawFrame(path, settled(columns), time_of(data), int(number[1]) if number else None, complete=True)


def time_of(data: Any) -> float | None:
    """The time that a data set tells in its field data [s], if any."""
    time = None
    for name in ("TIME", "TimeValue"):
        with contextlib.suppress(KeyError, IndexError, ValueError):
            time = float(np.ravel(data.field_data[name])[0])
    return time


def _refuse_strange_counts(path: Path) -> None:
    """Raises InputError for a number of points, cells or components that is none, which VTK would not survive."""
    with path.open("rb") as file:
        start = file.read(START)
    for name, text in _COUNT.findall(start):
        if not (text.strip().isdigit() and int(text) <= MOST):
            raise InputError(f"{path} cannot be read as VTK: {name.decode()} is {text.decode(errors='replace')}")


@contextlib.contextmanager
def _without_a_log() -> Iterator[None]:
    """Nothing is logged in the block: pyvista hands on there what VTK says, in many lines."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        yield
    finally:
        logging.disable(before)


def read_points(path: Path) -> Any:
    """The data set of a file, as pyvista has it, with a point at least. Raises InputError in one line."""
    # pyvista prints VTK's own complaints; what counts is whether points came out.
    import pyvista

    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty")
    if is_packed(path):
        raise InputError(f"{path} is packed by gzip, which VTK does not read; unpack it first")
    _refuse_strange_counts(path)
    refuse_fatal(path, "VTK")
    try:
        with pyvista.vtk_verbosity("off"), _without_a_log(), warnings.catch_warnings():
            warnings.filterwarnings("error", message=FAILED)
            data = pyvista.read(path)
    except UserWarning:
        raise InputError(f"{path} cannot be read as VTK; is it truncated?") from None
    except Exception as error:
        raise InputError(f"{path} cannot be read as VTK: {error}") from None
    if getattr(data, "n_points", 0) == 0:
        raise InputError(f"{path} holds no points; is it truncated?")
    return data
