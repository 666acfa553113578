"""Terrain from files: heights as they are written, distances as geometry has them, and what cannot be ground."""

import numpy as np
import pytest
from scenes_for_tests import CUBE, changed

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.outline import outline_of
from grainlaw.mpm_core.scene.build_obstacles import build_obstacles
from grainlaw.mpm_core.scene.heights import read_heights

# Heights every 0.2 m along x (7) and y (6); a plane, of which (1, 2, 4)/sqrt(21) is the normal.
X, Y = 0.2 * np.arange(7) - 0.1, 0.2 * np.arange(6) - 0.1
PLANE = 0.4 - 0.25 * X[:, None] - 0.5 * Y[None, :]
NORMAL = np.array([1.0, 2.0, 4.0]) / np.sqrt(21.0)
DOMAIN = {"grid": {"cell_size": 0.1, "lower": [0.0, 0.0, -0.4], "upper": [1.0, 0.8, 0.6]}}


def ascii_grid(path, heights, header="ncols 7\nnrows 6\nxllcorner -0.2\nyllcorner -0.2\ncellsize 0.2\n"):
    rows = [" ".join(f"{height:.12g}" for height in row) for row in heights.T[::-1]]
    path.write_text(header + "NODATA_value -9999\n" + "\n".join(rows) + "\n")
    return path


def ground(file, changes=None, **keys):
    """The obstacle that a file makes."""
    shape = {"kind": "terrain", "file": str(file), **keys}
    content = {**DOMAIN, "obstacle": [{"name": "ground", "friction": 0.3, "shape": shape}]}
    scene = Scene.from_dict(changed(changed(CUBE, content), changes or {}))
    (obstacle,) = build_obstacles(scene)
    return scene, obstacle


def test_every_kind_of_file_gives_the_same_heights(tmp_path):
    files = [
        ascii_grid(tmp_path / "corner.asc", PLANE),
        ascii_grid(
            tmp_path / "center.ASC", PLANE, "NCOLS 7\nNROWS 6\nXLLCENTER -0.1\nYLLCENTER -0.1\nDX 0.2\nDY 0.2\n"
        ),
        tmp_path / "table.csv",
        tmp_path / "array.npy",
    ]
    x, y = (part.ravel() for part in np.meshgrid(X, Y, indexing="ij"))
    rows = np.random.default_rng(1).permutation(np.column_stack([PLANE.ravel(), x, y]))
    np.savetxt(files[2], rows, delimiter=",", header="z,x,y", comments="", fmt="%.12g")
    np.save(files[3], PLANE)
    for file in files:
        place = ((-0.1, -0.1), 0.2) if file.suffix == ".npy" else (None, None)
        found = read_heights(file, *place)
        np.testing.assert_allclose(found.values, PLANE, atol=1e-11)
        np.testing.assert_allclose([*found.lower, *found.upper, found.spacing], [-0.1, -0.1, 1.1, 0.9, 0.2], atol=1e-9)
    assert read_heights(files[0], (5.0, 7.0), None).lower == (5.0, 7.0)


def test_a_tilted_grid_is_an_oblique_plane(tmp_path):
    scene, tilted = ground(ascii_grid(tmp_path / "plane.asc", PLANE))
    generator = np.random.default_rng(2)
    places = generator.uniform(scene.grid.lower, scene.grid.upper, (500, 3))
    exact = (places - [0.0, 0.0, 0.4]) @ NORMAL
    near = np.abs(exact) < 0.25
    assert near.sum() > 100
    np.testing.assert_allclose(distances(tilted, places[near].T.copy()), exact[near], atol=1e-9)
    assert (np.sign(distances(tilted, places.T.copy())) == np.sign(exact)).all()


def test_a_ridge_has_the_distances_of_its_faces_and_of_its_edge(tmp_path):
    """A roof along y, 45 degrees to both sides of x = 0.5: over its edge the distance is that from the edge."""
    roof = np.broadcast_to(0.2 - np.abs(X[:, None] - 0.5), (7, 6))
    _, obstacle = ground(ascii_grid(tmp_path / "roof.asc", roof))
    places = np.array([[0.5, 0.4, 0.3], [0.2, 0.3, 0.1], [0.8, 0.5, -0.2], [0.5, 0.4, 0.1]])
    exact = np.array([0.1, 0.2 / np.sqrt(2.0), -0.1 / np.sqrt(2.0), -0.1 / np.sqrt(2.0)])
    # linear between nodes half a cell apart, of which the edge is one
    np.testing.assert_allclose(distances(obstacle, places.T.copy()), exact, atol=2e-3)


def test_its_outline_is_closed(tmp_path):
    from trimesh import Trimesh

    scene, obstacle = ground(ascii_grid(tmp_path / "plane.asc", PLANE))
    found = outline_of(obstacle, scene.grid.lower, scene.grid.upper)
    solid = Trimesh(found.points, np.array(found.faces))
    solid.update_faces(solid.nondegenerate_faces())
    assert solid.is_watertight
    assert (found.points.min(axis=0) < scene.grid.lower).all()


def test_ground_goes_through_a_file_in_two_axes(tmp_path):
    from scenes_for_tests import BLOCK

    file = tmp_path / "line.csv"
    file.write_text("x,y\n0.0,0.1\n0.5,0.15\n1.0,0.1\n")
    shape = {"kind": "terrain", "file": str(file)}
    obstacles = []
    for one in (shape, {"kind": "terrain", "points": [[0.0, 0.1], [0.5, 0.15], [1.0, 0.1]]}):
        content = changed(BLOCK, {"obstacle": [{"name": "ground", "friction": 0.3, "shape": one}]})
        scene = Scene.from_dict(content)
        import tomllib

        again = Scene.from_dict(tomllib.loads(scene.to_toml()))
        obstacles += build_obstacles(again)
    first, second = obstacles
    assert (first.surface.numbers == second.surface.numbers).all()


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (
            lambda text: text.replace("cellsize 0.2", "dx 0.2\ndy 0.1"),
            r"its cells are 0\.2 m by 0\.1 m; allowed: squares",
        ),
        (lambda text: text.replace("cellsize 0.2\n", ""), "its header needs ncols, nrows, xllcorner"),
        (lambda text: text.replace("nrows 6", "nrows 5"), "has 42 heights; its header says 5 rows of 7"),
        (lambda text: text.replace("nrows 6", "nrows six"), "nrows is 'six', no number"),
        (lambda text: text[:-7] + " -9999\n", r"no height \(NODATA\) at 1 places, the first at x = 1\.1, y = -0\.1"),
        (lambda text: text[:-7] + " high\n", "could not convert string to float: 'high'"),
        (
            lambda text: text.replace("-0.2", "0.2"),
            r"its heights cover x = 0\.2 to 1\.6 m; the domain reaches from 0 to 1 m",
        ),
    ],
)
def test_a_grid_that_is_no_ground_is_refused_in_a_line(tmp_path, edit, message):
    file = ascii_grid(tmp_path / "plane.asc", PLANE)
    file.write_text(edit(file.read_text()))
    with pytest.raises(InputError, match=message) as refused:
        ground(file)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("gap.csv", "x,y,z\n0,0,1\n1,0,1\n2,0,1\n0,1,1\n2,1,1\n", r"at 1 places, the first at x = 1, y = 1"),
        ("off.csv", "x,y,z\n0,0,1\n1,0,1\n2.4,0,1\n0,1,1\n1,1,1\n2.4,1,1\n", "is on no grid of"),
        ("long.csv", "x,y,z\n0,0,1\n1,0,1\n0,2,1\n1,2,1\n", "its cells are 1 m by 2 m"),
        ("names.csv", "a,b\n0,0\n", "needs the columns x, y and z"),
        ("one.csv", "x,y,z\n0,0,1\n0,1,1\n", "all x are 0"),
        ("word.csv", "x,y,z\n0,0,one\n", "could not convert"),
        ("none.csv", None, "cannot be read: No such file"),
        ("grid.txt", "1 2\n", r"no kind of terrain; allowed: \.asc, \.csv"),
        ("flat.tif", "", "rasterio, which is not installed"),
        ("array.npy", "", r"allowed: with lower = \[x, y\] and spacing"),
    ],
)
def test_a_file_that_holds_no_heights_is_refused_in_a_line(tmp_path, name, text, message):
    if name.endswith("tif"):
        pytest.importorskip("numpy")
        try:
            import rasterio  # noqa: F401
        except ImportError:
            pass
        else:
            pytest.skip("rasterio is there")
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message) as refused:
        ground(tmp_path / name)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"obstacle.0.velocity": [1.0, 0.0, 0.0]}, "terrain in 3D rests"),
        ({"obstacle.0.hollow": True}, "a terrain is neither free nor hollow"),
        ({"obstacle.0.shape.points": [[0.0, 0.0], [1.0, 0.0]]}, "takes a file of heights, and no points"),
        ({"obstacle.0.shape.spacing": 0.1}, r"a spacing belongs to \.npy"),
    ],
)
def test_ground_of_another_kind_is_refused(tmp_path, changes, message):
    with pytest.raises(InputError, match=message):
        ground(ascii_grid(tmp_path / "plane.asc", PLANE), changes)
