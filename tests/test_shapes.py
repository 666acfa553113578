"""Shapes of bodies and the lattice that fills them: area, region, and what is no shape."""

import math

import meshio
import numpy as np
import pytest
from pydantic import ValidationError
from scenes_for_tests import BLOCK, changed, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.shapes import Disc, MeshRegion, Polygon, Rectangle, lattice

ORIGIN, CELL = (0.0, 0.0), 0.05
L_SHAPE = [(0.0, 0.0), (0.6, 0.0), (0.6, 0.2), (0.2, 0.2), (0.2, 0.5), (0.0, 0.5)]
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
QUAD_NODES = np.array([[0.1, 0.0], [0.4, 0.0], [0.8, 0.1], [0.0, 0.5], [0.4, 0.6], [0.7, 0.5]])


def area(shape, points_per_cell=4):
    return len(lattice(shape, ORIGIN, CELL, points_per_cell)) * CELL**2 / points_per_cell


# A square of two halves; only the lower half has a physical group, and the upper entity is not even listed.
MSH41 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
2 5 "base"
$EndPhysicalNames
$Entities
0 0 1 0
1 0 0 0 1 0.5 0 1 5 0
$EndEntities
$Nodes
1 6 1 9
2 1 0 6
1
2
3
4
5
9
0 0 0
1 0 0
1 0.5 0
0 0.5 0
1 1 0
0 1 0
$EndNodes
$Elements
2 2 1 2
2 1 3 1
1 1 2 3 4
2 2 3 1
2 4 3 5 9
$EndElements
"""


def polygon_area(vertices):
    x, y = np.array(vertices).T
    return 0.5 * abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def mesh_file(tmp_path, kind, name="region.vtk"):
    cells = QUADS if kind == "quad" else np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
    path = tmp_path / name
    meshio.Mesh(np.column_stack([QUAD_NODES, np.zeros(6)]), [(kind, cells)]).write(path)
    return path


@pytest.mark.parametrize("points_per_cell", [1, 4, 9, 16])
def test_a_rectangle_of_whole_cells_is_filled_exactly(points_per_cell):
    shape = Rectangle(kind="rectangle", lower=(0.1, 0.05), upper=(0.4, 0.55))
    points = lattice(shape, ORIGIN, CELL, points_per_cell)
    assert len(points) == 6 * 10 * points_per_cell
    assert area(shape, points_per_cell) == pytest.approx(0.3 * 0.5, rel=1e-12)
    np.testing.assert_allclose(points.mean(axis=0), [0.25, 0.3])
    assert shape.contains(points).all()


@pytest.mark.parametrize(
    ("shape", "exact", "perimeter"),
    [
        (Disc(kind="disc", center=(0.5, 0.5), radius=0.31), math.pi * 0.31**2, 2 * math.pi * 0.31),
        (Polygon(kind="polygon", vertices=L_SHAPE), polygon_area(L_SHAPE), 2.2),
        (Polygon(kind="polygon", vertices=[(0.1, 0.0), (0.9, 0.0), (0.5, 0.33)]), 0.5 * 0.8 * 0.33, 1.84),
        (Rectangle(kind="rectangle", lower=(0.11, 0.07), upper=(0.52, 0.64)), 0.41 * 0.57, 1.96),
    ],
)
def test_other_shapes_are_filled_within_half_a_spacing_along_their_perimeter(shape, exact, perimeter):
    for points_per_cell in (4, 16):
        spacing = CELL / points_per_cell**0.5
        assert area(shape, points_per_cell) == pytest.approx(exact, abs=0.5 * spacing * perimeter)


def test_the_notch_of_an_l_shape_stays_empty():
    points = lattice(Polygon(kind="polygon", vertices=L_SHAPE), ORIGIN, CELL, 4)
    assert not ((points[:, 0] > 0.2) & (points[:, 1] > 0.2)).any()
    assert ((points[:, 0] > 0.2) & (points[:, 1] < 0.2)).any()


# Parts of one region whose common edges run through points of the lattice: 45 degrees, along x and y, any slope, and
# a corner of one on an edge of another.
WHOLE = [(0.0, 0.0), (1.2, 0.0), (1.2, 0.6), (0.0, 0.6)]
DIVISIONS = {
    "45 degrees": [[WHOLE[0], WHOLE[1], (0.6, 0.6), WHOLE[3]], [WHOLE[1], WHOLE[2], (0.6, 0.6)]],
    "axes": [
        [(0.0, 0.0), (0.3125, 0.0), (0.3125, 0.6), (0.0, 0.6)],
        [(0.3125, 0.0), (1.2, 0.0), (1.2, 0.2125), (0.3125, 0.2125)],
        [(0.3125, 0.2125), (1.2, 0.2125), (1.2, 0.6), (0.3125, 0.6)],
    ],
    "diagonals": [[*edge, (0.6, 0.3)] for edge in zip(WHOLE, WHOLE[1:] + WHOLE[:1], strict=True)],
    "corner on an edge": [
        [WHOLE[0], WHOLE[1], WHOLE[2]],
        [WHOLE[0], (0.42, 0.21), (0.42, 0.6), WHOLE[3]],
        [(0.42, 0.21), WHOLE[2], (0.42, 0.6)],
    ],
}


@pytest.mark.parametrize("division", DIVISIONS)
@pytest.mark.parametrize("backwards", [[], [0], [1], [0, 1, 2, 3]])
def test_points_on_a_common_edge_belong_to_one_polygon_whatever_the_order_of_corners(division, backwards):
    parts = DIVISIONS[division]
    found = []
    for number, corners in enumerate(parts):
        turned = corners[number % 3 :] + corners[: number % 3]
        vertices = turned[::-1] if number in backwards else turned
        found.append(lattice(Polygon(kind="polygon", vertices=vertices), ORIGIN, CELL, 4))
        assert len(found[-1]) == pytest.approx(polygon_area(corners) * 1600, abs=0.5 * 2.2 * 40)
    together = np.concatenate(found)
    assert len(np.unique(together, axis=0)) == len(together) == 1152


def test_touching_polygons_are_bodies_of_one_scene_and_overlapping_ones_are_not():
    first, second = (
        {"kind": "polygon", "vertices": [list(corner) for corner in corners]} for corners in DIVISIONS["45 degrees"]
    )
    bodies = [BLOCK["body"][0] | {"shape": shape} for shape in (first, second)]
    scene = Scene.from_dict(BLOCK | {"grid": {"cell_size": CELL, "upper": [1.5, 1.0]}, "body": bodies}, "scene.toml")
    assert sum(body.count for body in build_bodies(scene)) == 1152
    second["vertices"][2] = [0.5, 0.6]
    scene = Scene.from_dict(BLOCK | {"grid": {"cell_size": CELL, "upper": [1.5, 1.0]}, "body": bodies}, "scene.toml")
    with pytest.raises(InputError, match=r"body\.0 and body\.1 overlap"):
        build_bodies(scene)


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        ([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)], r"crosses or touches itself at \(0\.5, 0\.5\)"),
        ([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.0), (0.0, 2.0)], r"crosses or touches itself at \(1, 0\)"),
        ([(0.0, 0.0), (0.0, 0.0), (1.0, 1.0)], "has no area"),
    ],
)
def test_a_polygon_that_is_not_simple_is_refused_with_the_place(vertices, message):
    with pytest.raises(ValidationError, match=message):
        Polygon(kind="polygon", vertices=vertices)


def test_both_groups_of_a_gmsh_file_fill_its_region_and_one_must_be_chosen(tmp_path):
    path = tmp_path / "parts.msh"
    nodes = np.array([[0.0, 0.0], [1.2, 0.0], [1.2, 0.6], [0.0, 0.6], [0.6, 0.6]])
    blocks = [("line", np.array([[0, 1]])), ("triangle", np.array([[1, 2, 4]])), ("quad", np.array([[0, 1, 4, 3]]))]
    tags = [np.array([3]), np.array([8]), np.array([4])]
    meshio.Mesh(
        np.column_stack([nodes, np.zeros(5)]),
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"floor": np.array([3, 1]), "sand": np.array([8, 2])},
    ).write(path, file_format="gmsh22", binary=False)
    sand, rest = (lattice(MeshRegion(kind="mesh", file=path, group=name), ORIGIN, CELL, 4) for name in ("sand", "4"))
    np.testing.assert_array_equal(
        sand, lattice(Polygon(kind="polygon", vertices=DIVISIONS["45 degrees"][1]), ORIGIN, CELL, 4)
    )
    assert len(np.unique(np.concatenate([sand, rest]), axis=0)) == len(sand) + len(rest) == 1152
    with pytest.raises(ValidationError, match=r'several groups; choose one with group = \.\.\., of "sand", "4"'):
        MeshRegion(kind="mesh", file=path)
    with pytest.raises(ValidationError, match='no cells of a group "floor"; it has "sand", "4"'):
        MeshRegion(kind="mesh", file=path, group="floor")


def test_an_msh_4_1_file_may_leave_entities_without_a_group(tmp_path):
    path = tmp_path / "partly.msh"
    path.write_text(MSH41)
    assert area(MeshRegion(kind="mesh", file=path)) == pytest.approx(1.0, rel=1e-12)
    base = lattice(MeshRegion(kind="mesh", file=path, group="base"), ORIGIN, CELL, 4)
    assert len(base) == 800
    assert base[:, 1].max() < 0.5


def test_parts_with_their_own_nodes_on_the_interface_are_one_region(tmp_path):
    left = [(0.0, 0.0), (0.7, 0.0), (0.5, 0.6), (0.0, 0.6)]
    right = [(0.7, 0.0), (1.2, 0.0), (1.2, 0.6), (0.5, 0.6), (0.6, 0.3)]  # a node of its own on the common edge
    nodes = np.array(left + right)
    quads, triangles = np.array([[0, 1, 2, 3]]), 4 + np.array([[0, 1, 4], [4, 1, 2], [4, 2, 3]])
    path = tmp_path / "parts.vtk"
    meshio.Mesh(np.column_stack([nodes, np.zeros(9)]), [("quad", quads), ("triangle", triangles)]).write(path)
    assert area(MeshRegion(kind="mesh", file=path)) == pytest.approx(0.72, rel=1e-12)


@pytest.mark.parametrize(("kind", "corners"), [("triangle6", 3), ("quad8", 4), ("quad9", 4)])
def test_second_order_cells_follow_the_nodes_on_their_edges(tmp_path, kind, corners):
    angle = 2 * np.pi * (np.arange(corners) + np.array([[0.0], [0.5]])) / corners
    nodes = 0.5 + 0.4 * np.column_stack([np.cos(angle).ravel(), np.sin(angle).ravel()])
    nodes = np.vstack([nodes, [[0.5, 0.5]]])[: int(kind[-1])]
    path = tmp_path / "curved.vtk"
    meshio.Mesh(np.column_stack([nodes, np.zeros(len(nodes))]), [(kind, np.arange(len(nodes))[None])]).write(path)
    polygon = 0.5 * 2 * corners * 0.4**2 * math.sin(math.pi / corners)
    assert area(MeshRegion(kind="mesh", file=path), 16) == pytest.approx(polygon, abs=0.01)


@pytest.mark.parametrize("kind", ["quad", "triangle"])
def test_a_mesh_file_gives_the_region_of_its_cells(tmp_path, kind):
    shape = MeshRegion(kind="mesh", file=mesh_file(tmp_path, kind))
    outline = QUAD_NODES[[0, 1, 2, 5, 4, 3]]
    assert area(shape, 16) == pytest.approx(polygon_area(outline), abs=0.25 * CELL * 2.4)
    assert shape.bounds() == ((0.0, 0.0), (0.8, 0.6))
    assert shape.contains(np.array([[0.3, 0.3], [0.6, 0.3], [0.05, 0.05], [0.7, 0.02]])).tolist() == [1, 1, 0, 0]


def test_a_mesh_path_counts_from_the_scene_file_and_holds_from_anywhere(tmp_path, monkeypatch):
    mesh_file(tmp_path, "quad")
    changes = {"body.0.shape": {"kind": "mesh", "file": "region.vtk"}}
    monkeypatch.chdir(tmp_path)
    scene_file = write_scene(tmp_path / "scene.toml", BLOCK, changes)
    scene = Scene.load(scene_file.relative_to(tmp_path))
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (tmp_path / "elsewhere" / "copy.toml").write_text(scene.to_toml())
    assert Scene.load(tmp_path / "elsewhere" / "copy.toml").body[0].shape.bounds() == ((0.0, 0.0), (0.8, 0.6))


def _without_cells(path):
    meshio.Mesh(np.zeros((2, 3)), [("line", np.array([[0, 1]]))]).write(path)


def _overlapping(path):
    nodes = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
    meshio.Mesh(nodes, [("triangle", np.array([[0, 1, 2], [0, 1, 3]]))]).write(path)


def _one_cell_twice(path):
    meshio.Mesh(np.column_stack([QUAD_NODES, np.zeros(6)]), [("quad", QUADS[[0, 1, 1]])]).write(path)


def _surface_in_space(path):
    heights = 0.25 * (QUAD_NODES[:, :1] > 0.5)
    meshio.Mesh(np.hstack([QUAD_NODES, heights]), [("quad", QUADS)]).write(path)


def _wedge(path):
    nodes = np.vstack([np.zeros(3), np.eye(3), np.eye(3)[:2] + 1.0])
    meshio.Mesh(nodes, [("wedge", np.arange(6)[None])]).write(path)


def _volume(path):
    meshio.Mesh(np.vstack([np.zeros(3), np.eye(3)]), [("tetra", np.array([[0, 1, 2, 3]]))]).write(path)


@pytest.mark.parametrize(
    ("name", "write", "message"),
    [
        ("missing.vtk", lambda path: None, "there is no mesh file"),
        ("empty.vtk", _without_cells, "holds no triangles, quadrilaterals or tetrahedra"),
        ("rubbish.vtk", lambda path: path.write_text("rubbish\n"), "it is no valid .vtk file .*Illegal VTK header"),
        ("rubbish.vtu", lambda path: path.write_text("<VTKFile"), "it is no valid .vtu file"),
        ("region.unheard", lambda path: path.write_text("rubbish\n"), "Could not deduce file format"),
        ("overlapping.vtk", _overlapping, "overlap or have no area"),
        ("twice.vtk", _one_cell_twice, "overlap or have no area"),
        ("version.msh", lambda path: path.write_text("$MeshFormat\n9.1 0 8\n"), r"got 9\.1"),
        ("hill.vtk", _surface_in_space, "a surface in space that is not closed: 6 edges"),
        ("wedge.vtk", _wedge, "cells of kind wedge; known are triangle"),
        ("volume.vtk", _volume, "has a volume; allowed: triangles and quadrilaterals in the x-y plane"),
        (
            "lost_node.msh",
            lambda path: path.write_text(MSH41.replace("4 3 5 9", "4 3 5 8")),
            "nodes that it does not hold",
        ),
    ],
)
def test_a_mesh_file_that_is_no_region_is_refused_in_one_line(tmp_path, capfd, name, write, message):
    write(tmp_path / name)
    capfd.readouterr()
    content = changed(BLOCK, {"body.0.shape": {"kind": "mesh", "file": str(tmp_path / name)}})
    with pytest.raises(InputError, match=message) as caught:
        Scene.from_dict(content, "scene.toml")
    assert "body.0.shape" in str(caught.value)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "make",
    [
        lambda: Rectangle(kind="rectangle", lower=(0.0, 0.0), upper=(0.0, 1.0)),
        lambda: Disc(kind="disc", center=(0.0, 0.0), radius=math.inf),
        lambda: Disc(kind="disc", center=(0.0, math.nan), radius=1.0),
        lambda: Polygon(kind="polygon", vertices=[(0.0, 0.0), (1.0, 0.0)]),
    ],
)
def test_a_shape_without_a_finite_area_is_refused(make):
    with pytest.raises(ValidationError):
        make()
