"""VTK point data of LIGGGHTS (`dump custom/vtk`) and YADE (`VTKRecorder`, spheres): legacy and XML files."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.raw_frame import ALIASES, RawFrame

ENDINGS = (".vtk", ".vtp", ".vtu")
VELOCITY_NAMES = ("v", "velocity", "linVel")


def recognises(path: Path, start: bytes) -> bool:
    """By the ending, as VTK's own reader does."""
    return path.suffix in ENDINGS


def frames(path: Path) -> Iterator[RawFrame]:
    """The one frame of a file; its time is the field `TIME` if there is one."""
    data = _read(path)
    columns = dict(zip("xyz", np.asarray(data.points, float).T, strict=True))
    for name in data.point_data:
        values = np.asarray(data.point_data[name], float)
        if values.ndim == 1:
            columns[ALIASES.get(name, name)] = values
        elif name in VELOCITY_NAMES:
            if values.shape[1] != 3:
                raise InputError(f"{path}: '{name}' has {values.shape[1]} components, expected 3")
            columns.update(zip(("vx", "vy", "vz"), values.T, strict=True))
    time = None
    for name in ("TIME", "TimeValue"):
        with contextlib.suppress(KeyError):
            time = float(np.ravel(data.field_data[name])[0])
    yield RawFrame(path, columns, time)


def _read(path: Path) -> Any:
    # pyvista prints VTK's own complaints; what counts is whether points came out.
    import pyvista

    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty")
    try:
        with pyvista.vtk_verbosity("off"):
            data = pyvista.read(path)
    except Exception as error:
        raise InputError(f"{path} cannot be read as VTK: {str(error).splitlines()[0]}") from None
    if getattr(data, "n_points", 0) == 0:
        raise InputError(f"{path} holds no points; is it truncated?")
    return data
