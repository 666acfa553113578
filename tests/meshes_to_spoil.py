"""Good meshes to spoil, of bodies in two dimensions and in three."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import tomli_w
import trimesh
from scenes_for_tests import BLOCK, CUBE, changed
from scenes_to_spoil import set_up

from grainlaw.mpm_core.scene.mesh_file import SURFACE_FORMATS

NODES = np.array([[0.3, 0.2], [0.5, 0.2], [0.7, 0.2], [0.3, 0.6], [0.5, 0.6], [0.7, 0.6]])
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])


def mesh_file(name: str, spoils: str = "", **options: Any) -> Callable[[Path], Path]:
    """A writer of two squares, of which one file is to be spoilt."""

    def write(folder: Path) -> Path:
        path = folder / name
        mesh = meshio.Mesh(np.column_stack([NODES, np.zeros(6)]), [("quad", QUADS)])
        mesh.write(path, **options)
        return folder / (spoils or name)

    return write


def read_mesh(path: Path) -> object:
    """As the shape of a body."""
    scene = path.parent / "scene.toml"
    path = path.with_suffix(".xdmf") if path.suffix == ".h5" else path
    scene.write_text(tomli_w.dumps(changed(BLOCK, {"body.0.shape": {"kind": "mesh", "file": path.name}})))
    return set_up(scene)


SOLID_FILES = ("a.stl", "a.ply", "a.obj", "a.off", "a.vtk")
TETRAHEDRON = np.array([[0.3, 0.2, 0.1], [0.7, 0.2, 0.1], [0.3, 0.6, 0.1], [0.3, 0.2, 0.5]])


def solid_file(name: str) -> Callable[[Path], Path]:
    """A surface or, in a format for volumes, a tetrahedron."""

    def write(folder: Path) -> Path:
        path = folder / name
        faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        if path.suffix in SURFACE_FORMATS:
            trimesh.Trimesh(TETRAHEDRON, faces).export(path)
        else:
            meshio.Mesh(TETRAHEDRON, [("tetra", np.arange(4)[None])]).write(path)
        return path

    return write


def read_solid(path: Path) -> object:
    """As the shape of a body in 3D."""
    scene = path.parent / "scene.toml"
    scene.write_text(tomli_w.dumps(changed(CUBE, {"body.0.shape": {"kind": "mesh", "file": path.name}})))
    return set_up(scene)
