"""A pile of points whose surface is known, in every format that `compare --mpm` reads."""

from pathlib import Path

import numpy as np
import pyvista

AREA = 0.27
SPACING = 0.005


def block(half_width: float) -> np.ndarray:
    """Places (n, 2) of points on a lattice in a block that stands on the floor, with the area of the paper's column."""
    height = 0.5 * AREA / half_width
    columns, rows = round(2.0 * half_width / SPACING), round(height / SPACING)
    x = (np.arange(columns) + 0.5) * 2.0 * half_width / columns - half_width
    y = (np.arange(rows) + 0.5) * height / rows
    return np.array([(one, other) for one in x for other in y])


def _npz(folder: Path, points: np.ndarray, volumes: np.ndarray) -> Path:
    np.savez(folder / "points.npz", position_stack=points, volume=volumes, t_current=1.0, names=np.array(["a", None]))
    return folder / "points.npz"


def _npz_of_columns(folder: Path, points: np.ndarray, volumes: np.ndarray) -> Path:
    np.savez_compressed(folder / "points.npz", pos_x=points[:, 0], pos_y=points[:, 1], mass=volumes, t=np.ones(1))
    return folder / "points.npz"


def _csv(folder: Path, points: np.ndarray, volumes: np.ndarray) -> Path:
    return _table(folder / "points.csv", "# id,x,y,volume,time,kind", points, volumes, "{n},{x},{y},{v},1.0,sand")


def _paraview(folder: Path, points: np.ndarray, volumes: np.ndarray) -> Path:
    header = '"mass","Points:0","Points:1","Points:2","time"'
    return _table(folder / "points.csv", header, points, volumes, "{v},{x},{y},0.0,1.0")


def _table(path: Path, header: str, points: np.ndarray, volumes: np.ndarray, row: str) -> Path:
    both = zip(points.tolist(), volumes.tolist(), strict=True)
    rows = [row.format(n=n, x=x, y=y, v=v) for n, ((x, y), v) in enumerate(both)]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def _vtk(ending: str):
    def write(folder: Path, points: np.ndarray, volumes: np.ndarray) -> Path:
        cloud = pyvista.PolyData(np.column_stack([points, np.zeros(len(points))]))
        data = cloud if ending == ".vtp" else cloud.cast_to_unstructured_grid()
        data.point_data["volume"] = volumes
        data.field_data["TimeValue"] = [1.0]
        data.save(folder / f"points{ending}")
        return folder / f"points{ending}"

    return write


def _ply(form: str, order: str):
    def write(folder: Path, points: np.ndarray, volumes: np.ndarray) -> Path:
        header = f"ply\nformat {form} 1.0\ncomment of a code in the plane\nelement vertex {len(points)}\n"
        header += "property float x\nproperty double y\nproperty double m\nelement face 0\n"
        header += "property list uchar int vertex_indices\nend_header\n"
        kinds = [("x", f"{order}f4"), ("y", f"{order}f8"), ("m", f"{order}f8")]
        rows = np.array([(*point, volume) for point, volume in zip(points, volumes, strict=True)], kinds)
        body = rows.tobytes() if order else "".join(f"{x} {y} {m}\n" for x, y, m in rows.tolist()).encode()
        (folder / "points.ply").write_bytes(header.encode() + body)
        return folder / "points.ply"

    return write


WRITERS = {
    "npz": _npz,
    "npz, columns": _npz_of_columns,
    "csv": _csv,
    "csv of ParaView": _paraview,
    "vtk": _vtk(".vtk"),
    "vtu": _vtk(".vtu"),
    "vtp": _vtk(".vtp"),
    "ply": _ply("ascii", ""),
    "ply, binary": _ply("binary_little_endian", "<"),
    "ply, big endian": _ply("binary_big_endian", ">"),
}
