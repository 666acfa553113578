"""Shapes of bodies and the lattice that fills them: area, region, and what is no shape."""

import math

import meshio
import numpy as np
import pytest
from pydantic import ValidationError
from scenes_for_tests import BLOCK, changed, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.scene.shapes import Disc, MeshRegion, Polygon, Rectangle, lattice

ORIGIN, CELL = (0.0, 0.0), 0.05
L_SHAPE = [(0.0, 0.0), (0.6, 0.0), (0.6, 0.2), (0.2, 0.2), (0.2, 0.5), (0.0, 0.5)]
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
QUAD_NODES = np.array([[0.1, 0.0], [0.4, 0.0], [0.8, 0.1], [0.0, 0.5], [0.4, 0.6], [0.7, 0.5]])


def area(shape, points_per_cell=4):
    return len(lattice(shape, ORIGIN, CELL, points_per_cell)) * CELL**2 / points_per_cell


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


@pytest.mark.parametrize(
    ("name", "write", "message"),
    [
        ("missing.vtk", lambda path: None, "there is no mesh file"),
        ("empty.vtk", _without_cells, "holds no triangles or quadrilaterals"),
        ("rubbish.vtk", lambda path: path.write_text("rubbish\n"), "it is no valid .vtk file"),
        ("rubbish.vtu", lambda path: path.write_text("<VTKFile"), "it is no valid .vtu file"),
        ("region.unheard", lambda path: path.write_text("rubbish\n"), "Could not deduce file format"),
        ("overlapping.vtk", _overlapping, "overlap or have no area"),
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
