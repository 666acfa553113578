"""Synthetic grains whose profiles are known, in every format that is read."""

import json
from pathlib import Path

import h5py
import numpy as np
import pyvista

DEPTH, DENSITY, RADIUS = 0.06, 2450.0, 0.003
TIMES = (0.0, 0.1)
HALF_WIDTHS, HEIGHTS = (0.15, 0.30), (0.30, 0.15)
NAMES = ("id", "type", "x", "y", "z", "vx", "vy", "vz", "radius")
SPACING = 0.0075


def block(half_width: float, height: float) -> np.ndarray:
    """Grains on a regular lattice in a block, as rows of `NAMES`."""
    axes = [np.arange(0.5, round(length / SPACING)) * SPACING for length in (2 * half_width, DEPTH, height)]
    x, y, z = (values.ravel() for values in np.meshgrid(*axes, indexing="ij"))
    n = len(x)
    columns = [np.arange(n), np.ones(n), x - half_width, y, z, x - half_width, np.zeros(n), -z, np.full(n, RADIUS)]
    return np.column_stack(columns)


def blocks() -> list[np.ndarray]:
    """The block before and after it spread; the same number of grains."""
    return [block(*size) for size in zip(HALF_WIDTHS, HEIGHTS, strict=True)]


def write_run(folder: Path, form: str) -> Path:
    """A run's folder in one of the formats."""
    folder.mkdir(parents=True)
    description = {"code": form, "seed": 1, "depth": DEPTH, "grain_density": DENSITY, "mean_diameter": 2 * RADIUS}
    frames = [{"file": WRITERS[form](folder, number, rows)} for number, rows in enumerate(blocks())]
    for frame, time in zip(frames, TIMES, strict=True):
        frame["time"] = time
    (folder / "run.json").write_text(json.dumps({**description, "frames": frames}))
    return folder


def _liggghts(folder: Path, number: int, rows: np.ndarray) -> str:
    header = f"ITEM: TIMESTEP\n{1000 * number}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX BOUNDS ff pp ff\n"
    header += f"-1 1\n0 {DEPTH}\n0 1\nITEM: ATOMS {' '.join(NAMES)}"
    return _text(folder / f"dump{number}.liggghts", header, rows, " ")


def _yade(folder: Path, number: int, rows: np.ndarray) -> str:
    return _text(folder / f"grains{number}.txt", f"# time {TIMES[number]}\n# {' '.join(NAMES)}", rows, " ")


def _csv(folder: Path, number: int, rows: np.ndarray) -> str:
    return _text(folder / f"grains{number}.csv", ",".join(NAMES), rows, ",")


def _text(path: Path, header: str, rows: np.ndarray, separator: str) -> str:
    np.savetxt(path, rows, fmt="%.9g", delimiter=separator, header=header, comments="")
    return path.name


def _vtk(folder: Path, number: int, rows: np.ndarray) -> str:
    points = pyvista.PolyData(rows[:, 2:5])
    points.point_data["radius"] = rows[:, 8]
    points.point_data["v"] = rows[:, 5:8]
    points.save(folder / f"grains{number}.vtp")
    return f"grains{number}.vtp"


def _hdf5(folder: Path, number: int, rows: np.ndarray) -> str:
    with h5py.File(folder / f"grains{number}.h5", "w") as file:
        group = file.create_group("frames/000000")
        group["position"], group["velocity"], group["radius"] = rows[:, 2:5], rows[:, 5:8], rows[:, 8]
    return f"grains{number}.h5"


WRITERS = {"liggghts": _liggghts, "yade": _yade, "csv": _csv, "vtk": _vtk, "hdf5": _hdf5}
