"""Shapes in three dimensions and the lattice that fills them: volume, region, and what is no solid."""

import math

import meshio
import numpy as np
import pytest
import trimesh
from pydantic import ValidationError

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene import shapes
from grainlaw.mpm_core.scene.mesh_region import MeshRegion
from grainlaw.mpm_core.scene.shapes import lattice
from grainlaw.mpm_core.scene.solids import Box, Cone, Cylinder, Sphere

ORIGIN, CELL = (0.0, 0.0, 0.0), 0.1
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
# A cube of five tetrahedra, the last of which touches all the others.
TETRAHEDRA = np.array([[0, 4, 2, 1], [6, 2, 4, 7], [5, 4, 1, 7], [3, 1, 2, 7], [1, 2, 4, 7]])


def volume(shape, points_per_cell=8):
    return len(lattice(shape, ORIGIN, CELL, points_per_cell)) * CELL**3 / points_per_cell


def box(lower, upper):
    return Box(kind="box", lower=lower, upper=upper)


def cylinder(**changes):
    standing = {"center": (0.8, 0.7, 0.2), "radius": 0.45, "height": 0.9}
    return Cylinder(kind="cylinder", **standing | changes)


def surface_file(path, mesh):
    mesh.export(path)
    return MeshRegion(kind="mesh", file=path)


def ball(subdivisions=3, radius=0.47, center=(0.61, 0.62, 0.63)):
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    mesh.apply_translation(center)
    return mesh


def without_triangles(mesh, far_from, count):
    """The mesh without the triangles at the top that are nearest to a place."""
    distance = np.linalg.norm(mesh.triangles_center - far_from, axis=1)
    return trimesh.Trimesh(mesh.vertices, mesh.faces[np.argsort(distance)[count:]], process=False)


@pytest.mark.parametrize("points_per_cell", [1, 8, 27, 64])
def test_a_box_of_whole_cells_is_filled_exactly(points_per_cell):
    shape = box((0.1, 0.2, 0.3), (0.6, 0.4, 0.7))
    points = lattice(shape, ORIGIN, CELL, points_per_cell)
    assert len(points) == 5 * 2 * 4 * points_per_cell
    np.testing.assert_allclose(points.mean(axis=0), [0.35, 0.3, 0.5])
    edge = CELL / round(points_per_cell ** (1 / 3))
    np.testing.assert_allclose(points.min(axis=0), np.array([0.1, 0.2, 0.3]) + 0.5 * edge)
    assert shape.contains(points).all()


@pytest.mark.parametrize(
    ("shape", "exact"),
    [
        (Sphere(kind="sphere", center=(0.6, 0.7, 0.8), radius=0.53), 4 / 3 * math.pi * 0.53**3),
        (cylinder(), math.pi * 0.45**2 * 0.9),
        (cylinder(axis=(0.0, 2.0, 0.0)), math.pi * 0.45**2 * 0.9),
        (cylinder(axis=(1.0, 1.0, 1.0), center=(0.5, 0.5, 0.5)), math.pi * 0.45**2 * 0.9),
        (Cone(kind="cone", center=(0.7, 0.7, 0.1), radius=0.6, height=0.9), math.pi * 0.6**2 * 0.3),
        (
            Cone(kind="cone", center=(0.7, 0.7, 0.1), radius=0.3, upper_radius=0.6, height=0.9),
            math.pi * 0.3 * (0.3**2 + 0.3 * 0.6 + 0.6**2),
        ),
    ],
)
def test_solids_have_their_volume_and_lie_in_their_bounds(shape, exact):
    for points_per_cell in (8, 64):
        assert volume(shape, points_per_cell) == pytest.approx(exact, rel=0.02)
    lower, upper = (np.array(corner) for corner in shape.bounds())
    points = lattice(shape, tuple(lower - 0.2), 0.02, 1)
    assert (np.abs(points.min(axis=0) - lower) < 0.04).all()
    assert (np.abs(points.max(axis=0) - upper) < 0.04).all()
    assert not shape.contains(np.array([lower - 0.01, upper + 0.01])).any()


def test_solids_stacked_on_planes_through_lattice_points_share_none_and_lose_none():
    lower, upper = cylinder(height=0.375), cylinder(center=(0.8, 0.7, 0.575), height=0.525)
    whole = lattice(cylinder(), ORIGIN, CELL, 8)
    parts = [lattice(part, ORIGIN, CELL, 8) for part in (lower, upper)]
    assert sum(map(len, parts)) == len(whole)
    assert len(np.unique(np.concatenate(parts), axis=0)) == len(whole)
    assert (np.abs(whole[:, 2] - 0.575) < 1e-9).any()


@pytest.mark.parametrize("form", ["stl", "ply", "obj", "off"])
def test_a_closed_surface_holds_the_points_inside_it(tmp_path, form):
    shape = surface_file(tmp_path / f"ball.{form}", ball())
    exact = float(ball().volume)
    assert volume(shape, 64) == pytest.approx(exact, rel=0.005)
    places = np.array([[0.61, 0.62, 0.63], [0.61, 0.62, 1.09], [0.61, 0.62, 1.11], [0.2, 0.2, 0.2]])
    assert shape.contains(places).tolist() == [True, True, False, False]
    np.testing.assert_allclose(shape.bounds(), ball().bounds, atol=1e-6)
    assert shape.contains(np.empty((0, 3))).shape == (0,)


def test_a_surface_agrees_with_the_solid_that_it_bounds_point_by_point(tmp_path):
    mesh = trimesh.creation.box(bounds=[[0.1, 0.2, 0.3], [0.7, 0.65, 0.9]])
    expected = lattice(box((0.1, 0.2, 0.3), (0.7, 0.65, 0.9)), ORIGIN, CELL, 8)
    np.testing.assert_array_equal(lattice(surface_file(tmp_path / "box.ply", mesh), ORIGIN, CELL, 8), expected)
    mesh.invert()
    np.testing.assert_array_equal(lattice(surface_file(tmp_path / "inside_out.ply", mesh), ORIGIN, CELL, 8), expected)


@pytest.mark.parametrize("top", [(0.61, 0.62, 1.1), (1.08, 0.62, 0.63), (0.9, 0.9, 0.9)])
def test_small_holes_change_nothing(tmp_path, top):
    whole = ball(subdivisions=4)
    damaged = without_triangles(whole, np.array(top), 3)
    expected = lattice(surface_file(tmp_path / "whole.ply", whole), ORIGIN, CELL, 27)
    found = lattice(surface_file(tmp_path / "damaged.ply", damaged), ORIGIN, CELL, 27)
    np.testing.assert_array_equal(found, expected)
    axis = np.argmax(np.abs(np.array(top) - [0.61, 0.62, 0.63]))
    through = np.array([0.61, 0.62, 0.63])
    through[axis] = 0.2
    assert MeshRegion(kind="mesh", file=tmp_path / "damaged.ply").contains(through[None]).all()


def test_a_cavity_is_left_out(tmp_path):
    hollow = trimesh.util.concatenate([ball(), ball(radius=0.3)])
    cavity = ball(radius=0.3)
    cavity.invert()
    shape = surface_file(tmp_path / "hollow.ply", trimesh.util.concatenate([ball(), cavity]))
    assert volume(shape, 64) == pytest.approx(ball().volume - ball(radius=0.3).volume, rel=0.01)
    wrong = surface_file(tmp_path / "wrong.ply", hollow)
    with pytest.raises(InputError, match=r"wrong\.ply: parts of the surface overlap, or a cavity's .* at \(0\.\d+, "):
        lattice(wrong, ORIGIN, CELL, 8)


def test_tetrahedra_that_touch_share_no_point_and_lose_none(tmp_path):
    whole = tmp_path / "cube.vtk"
    meshio.Mesh(CUBE, [("tetra", TETRAHEDRA)]).write(whole)
    expected = lattice(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), ORIGIN, 0.125, 8)
    np.testing.assert_array_equal(lattice(MeshRegion(kind="mesh", file=whole), ORIGIN, 0.125, 8), expected)
    parts = []
    for number, corners in enumerate(TETRAHEDRA):
        path = tmp_path / f"part{number}.vtk"
        meshio.Mesh(CUBE, [("tetra", corners[[1, 0, 2, 3]][None])]).write(path)
        parts.append(lattice(MeshRegion(kind="mesh", file=path), ORIGIN, 0.125, 8))
    together = np.concatenate(parts)
    assert len(together) == len(np.unique(together, axis=0)) == len(expected)
    assert len(parts[-1]) == pytest.approx(len(expected) / 3, rel=0.02)


def test_a_group_of_tetrahedra_is_chosen_by_name(tmp_path):
    path = tmp_path / "parts.msh"
    tags = [np.array([2]), np.array([7, 7, 7, 7, 9])]
    meshio.Mesh(
        CUBE,
        [("triangle", np.array([[0, 1, 2]])), ("tetra", TETRAHEDRA)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"floor": np.array([2, 2]), "shell": np.array([7, 3]), "core": np.array([9, 3])},
    ).write(path, file_format="gmsh22", binary=False)
    core = MeshRegion(kind="mesh", file=path, group="core")
    assert volume(core) == pytest.approx(1.0 / 3.0, rel=0.02)
    assert volume(core) + volume(MeshRegion(kind="mesh", file=path, group="shell")) == pytest.approx(1.0)
    with pytest.raises(ValidationError, match=r'choose one with group = \.\.\., of "shell", "core"'):
        MeshRegion(kind="mesh", file=path)


def _opposite_ways(path):
    mesh = ball(1)
    mesh.faces[:20] = mesh.faces[:20, ::-1]
    trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(path)


def _overlapping(path):
    apex = CUBE[[0, 1, 2, 4, 7, 6]]
    meshio.Mesh(apex, [("tetra", np.array([[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]))]).write(path)


def _flat(path):
    meshio.Mesh(CUBE, [("tetra", np.array([[0, 1, 2, 3]]))]).write(path)


def _sheet(path):
    faces = np.array([[0, 4, 1], [0, 1, 4], [1, 4, 5], [1, 5, 4], [0, 1, 2], [0, 2, 1]])
    trimesh.Trimesh(CUBE, faces, process=False).export(path)


@pytest.mark.parametrize(
    ("name", "write", "message"),
    [
        ("open.stl", lambda path: without_triangles(ball(), np.array([0.6, 0.6, 1.1]), 40).export(path),
         r"not closed: \d+ edges belong to one triangle only, most around \(0\.59\d*, 0\.61\d*, 1\.\d+\); allowed: "),
        ("turned.ply", _opposite_ways, "at [0-9]+ edges of the surface neighbours face opposite ways"),
        ("thrice.vtk", _overlapping, "tetrahedra of .* overlap: three share a face"),
        ("flat.vtk", _flat, "has a tetrahedron without a volume"),
        ("sheet.ply", _sheet, "encloses no volume"),
        ("points.ply", lambda path: trimesh.PointCloud(CUBE).export(path), "holds no triangles"),
        ("rubbish.stl", lambda path: path.write_bytes(b"solid\x00rubbish" * 9), "rubbish.stl holds no triangles"),
        ("empty.obj", lambda path: path.write_text("# nothing\n"), "empty.obj"),
        ("far.off", lambda path: ball(0, center=(1e12, 0.0, 0.0)).export(path), "has a coordinate of 1e"),
    ],
)  # fmt: skip
def test_a_mesh_file_that_is_no_solid_is_refused_with_the_reason(tmp_path, capfd, name, write, message):
    write(tmp_path / name)
    capfd.readouterr()
    with pytest.raises(ValidationError, match=message) as caught:
        MeshRegion(kind="mesh", file=tmp_path / name)
    (fault,) = caught.value.errors()
    assert "\n" not in fault["msg"]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: box((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)), "must lie above lower"),
        (lambda: cylinder(axis=(0.0, 0.0, 0.0)), "has no direction"),
        (lambda: cylinder(height=-1.0), "greater than 0"),
        (lambda: Sphere(kind="sphere", center=(0.0, 0.0, math.nan), radius=1.0), "finite"),
    ],
)
def test_a_shape_without_a_volume_is_refused(make, message):
    with pytest.raises(ValidationError, match=message):
        make()


@pytest.mark.parametrize("candidates", [1, 1000])
def test_a_shape_filled_in_layers_holds_the_same_points(monkeypatch, candidates):
    halves = ((0.5, -1.0, -1.0), (2.0, 2.0, 0.45))
    arguments = cylinder(), ORIGIN, CELL, 8, (0.25, 0.0, -0.5)
    whole = lattice(*arguments)
    expected = whole[((whole > halves[0]) & (whole < halves[1])).all(axis=1)]
    assert 0 < len(expected) < len(whole)
    monkeypatch.setattr(shapes, "CANDIDATES_AT_ONCE", candidates)
    np.testing.assert_array_equal(lattice(*arguments), whole)
    np.testing.assert_array_equal(lattice(*arguments, halves), expected)
