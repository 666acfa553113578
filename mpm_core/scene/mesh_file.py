"""The cells of a mesh file: their corners, and the groups they belong to."""

import contextlib
import io
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError

Points = NDArray[np.float64]
Groups = dict[str, list[NDArray[np.bool_]]]

# Corners of a cell, and nodes between two of them; nodes inside a cell do not matter.
OUTLINES = {
    "triangle": (3, 0),
    "triangle6": (3, 1),
    "triangle7": (3, 1),
    "triangle10": (3, 2),
    "quad": (4, 0),
    "quad8": (4, 1),
    "quad9": (4, 1),
}
# In which the first four nodes are the corners, between which edges are straight.
SOLIDS = ("tetra", "tetra10")
NO_AREA = ("vertex", "line")
# Read by trimesh, which also takes what others write into them.
SURFACE_FORMATS = (".stl", ".obj", ".ply", ".off")
HDF5_SUFFIXES = (".cgns", ".h5m", ".hmf", ".med")
FLAT = 1e-9  # of the size of a mesh
FARTHEST = 1e9  # m


class Cells(NamedTuple):
    """The cells of a group, one array of shape (cells, nodes, 2 or 3) [m] for each kind of cell.

    Tetrahedra if they are solid, otherwise outlines, without the third coordinate if that is the same everywhere.
    """

    are_solid: bool
    blocks: list[Points]


def read_cells(file: Path, group: str | None) -> Cells:
    """The tetrahedra of a group or, in a mesh without any, the outlines of its cells.

    Raises ValueError, in one line, for a file that is no mesh and for a group that it does not hold.
    """
    mesh = _read_mesh(file)
    kinds = [block.type for block in mesh.cells]
    known = (*OUTLINES, *SOLIDS)
    strange = sorted({kind for kind in kinds if kind not in known and not kind.startswith(NO_AREA)})
    if strange:
        raise ValueError(f"mesh file {file} holds cells of kind {', '.join(strange)}; known are {', '.join(known)}")
    if not any(block.type in known and len(block.data) for block in mesh.cells):
        raise ValueError(f"mesh file {file} holds no triangles, quadrilaterals or tetrahedra")
    are_solid = any(kind in SOLIDS for kind in kinds)
    chosen = _chosen(file, mesh, group, are_solid)
    blocks = []
    for block, selected in zip(mesh.cells, chosen, strict=True):
        if block.type in _counted(are_solid) and selected.any():
            around = range(4) if are_solid else _around(*OUTLINES[block.type])
            nodes = np.asarray(block.data)[selected][:, list(around)]
            if nodes.min() < 0 or nodes.max() >= len(mesh.points):
                raise ValueError(f"mesh file {file} has cells of nodes that it does not hold")
            blocks.append(np.asarray(mesh.points[nodes], dtype=float))
    _refuse_far_nodes(file, blocks)
    return Cells(are_solid, blocks if are_solid else _in_plane(blocks))


def _counted(solid: bool) -> Iterable[str]:
    """The kinds of cells that a region is made of."""
    return SOLIDS if solid else OUTLINES


def _around(corners: int, between: int) -> list[int]:
    """The nodes of a cell in their order around it; a file lists the corners first, then those of each edge."""
    nodes = []
    for corner in range(corners):
        first = corners + corner * between
        nodes += [corner, *range(first, first + between)]
    return nodes


def _refuse_far_nodes(file: Path, blocks: list[Points]) -> None:
    nodes = np.concatenate([block.reshape(-1, block.shape[2]) for block in blocks])
    if not np.isfinite(nodes).all():
        raise ValueError(f"mesh file {file} has coordinates that are not finite")
    farthest = float(np.abs(nodes).max())
    if farthest > FARTHEST:
        raise ValueError(f"mesh file {file} has a coordinate of {farthest:g}; lengths are in metres")


def _in_plane(blocks: list[Points]) -> list[Points]:
    """The blocks without their third coordinate, if it is the same everywhere."""
    nodes = np.concatenate([block.reshape(-1, block.shape[2]) for block in blocks])
    size = np.ptp(nodes, axis=0)
    is_flat = len(size) == 2 or size[2] <= FLAT * size.max()
    return [block[:, :, :2] for block in blocks] if is_flat else blocks


def _chosen(file: Path, mesh: Any, group: str | None, solid: bool) -> list[NDArray[np.bool_]]:
    """Which cells of each block belong to the group; all of them if the file has no more than one."""
    groups = _groups(mesh, solid)
    names = ", ".join(f'"{name}"' for name in groups)
    if group is None:
        if len(groups) > 1:
            raise ValueError(f"mesh file {file} has several groups; choose one with group = ..., of {names}")
        return [np.ones(len(block.data), dtype=bool) for block in mesh.cells]
    if group not in groups:
        raise ValueError(f'mesh file {file} has no cells of a group "{group}"; it has {names or "no groups"}')
    return groups[group]


def _groups(mesh: Any, solid: bool) -> Groups:
    """The physical groups that hold cells which count; one without a name is known by its number."""
    counted = _counted(solid)
    tags = mesh.cell_data.get("gmsh:physical", [np.zeros(len(block.data), dtype=int) for block in mesh.cells])
    used = {
        int(tag)
        for block, values in zip(mesh.cells, tags, strict=True)
        if block.type in counted
        for tag in np.unique(values)
    }
    found: Groups = {}
    for name, (tag, dimension) in mesh.field_data.items():
        if dimension != 2 + solid:
            continue
        used.discard(int(tag))
        if name in mesh.cell_sets:
            members = [
                np.isin(np.arange(len(block.data)), chosen)
                for block, chosen in zip(mesh.cells, mesh.cell_sets[name], strict=True)
            ]
        else:
            members = [np.asarray(values) == tag for values in tags]
        found[name] = members
    for tag in sorted(used - {0}):
        found[str(tag)] = [np.asarray(values) == tag for values in tags]
    counts = [block.type in counted for block in mesh.cells]
    return {
        name: members
        for name, members in found.items()
        if any(chosen.any() for chosen, taken in zip(members, counts, strict=True) if taken)
    }


def _read_mesh(file: Path) -> Any:
    """The mesh of a file. Raises ValueError in one line: meshio itself prints several and leaves the process."""
    if not file.is_file():
        raise ValueError(f"there is no mesh file {file}")
    import meshio

    from grainlaw.mpm_core.output.damaged_files import refuse_fatal

    said = io.StringIO()
    try:
        for part in _hdf5_files(file):
            refuse_fatal(part, "HDF5")
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), _entities_without_group():
            if file.suffix.lower() in SURFACE_FORMATS:
                import trimesh

                surface = trimesh.load_mesh(file, process=False)
                return meshio.Mesh(surface.vertices, [("triangle", surface.faces)])
            return meshio.read(file)
    except InputError as error:
        raise ValueError(str(error)) from error
    except meshio.ReadError as error:
        raise ValueError(f"cannot read mesh file {file}: {_one_line(str(error))}") from error
    except (Exception, SystemExit) as error:  # they raise whatever their parsers meet
        reason = _one_line(said.getvalue()) if isinstance(error, SystemExit) else f"{type(error).__name__}: {error}"
        raise ValueError(
            f"cannot read mesh file {file}: it is no valid {file.suffix} file ({_one_line(reason)})"
        ) from error


def _hdf5_files(file: Path) -> Iterator[Path]:
    """The files in HDF5 that meshio opens for a mesh: itself, or those that an XDMF file names."""
    if file.suffix.lower() in HDF5_SUFFIXES:
        yield file
    elif file.suffix.lower() in (".xdmf", ".xmf"):
        for name in set(re.findall(r">\s*([^<>:]+?):/", file.read_text(errors="replace"))):
            if (file.parent / name).is_file():
                yield file.parent / name


def _one_line(text: str) -> str:
    return " ".join(text.split())[:200]


@contextlib.contextmanager
def _entities_without_group() -> Iterator[None]:
    """Let meshio read an MSH 4.1 file where only some entities are listed or have a physical group.

    It lists the groups' numbers of those alone and then refuses its own list; the names are in its cell sets.
    """
    from meshio.gmsh import _gmsh41

    whole, read_entities = _gmsh41.Mesh, _gmsh41._read_entities

    def consistent(points: Any, cells: Any, *, cell_data: dict[str, Any], **rest: Any) -> Any:
        complete = {key: values for key, values in cell_data.items() if len(values) == len(cells)}
        return whole(points, cells, cell_data=complete, **rest)

    def any_entity(*arguments: Any) -> tuple[Any, ...]:
        tables = read_entities(*arguments)
        return tuple(tuple(defaultdict(list, tags) for tags in table) for table in tables)

    _gmsh41.Mesh, _gmsh41._read_entities = consistent, any_entity
    try:
        yield
    finally:
        _gmsh41.Mesh, _gmsh41._read_entities = whole, read_entities
