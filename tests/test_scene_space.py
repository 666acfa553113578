"""Scenes in axisymmetry and three dimensions: their defaults, what is refused in them, and how bodies start."""

import re
import tomllib

import numpy as np
import pytest
from scenes_for_tests import BLOCK, CUBE, RING, changed

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.scene.geostatic import vertical_stresses
from grainlaw.mpm_core.scene.initial_state import build_bodies, normal_stresses, point_masses
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, THREE_D
from grainlaw.mpm_core.stepping.run import built_simulation

GRIPS = {"kind": "friction", "coefficient": 0.3}
WEIGHT = 1000.0 * 9.81


def bodies(content, changes=None):
    """A scene and the places of the points of its bodies."""
    scene = Scene.from_dict(changed(content, changes or {}))
    return scene, [scene.lattice(body) for body in scene.body]


def test_each_space_has_its_defaults_and_reads_back_as_it_was():
    expected = ((RING, (0.0, -9.81), 4, (0.0, 0.0)), (CUBE, (0.0, 0.0, -9.81), 8, (0.0, 0.0, 0.0)))
    for content, gravity, points, nowhere in expected:
        scene = Scene.from_dict(content)
        assert (scene.gravity, scene.grid.lower) == (gravity, nowhere)
        assert (scene.body[0].points_per_cell, scene.body[0].velocity) == (points, nowhere)
        again = Scene.from_dict(tomllib.loads(scene.to_toml()))
        assert again.model_dump() == scene.model_dump()
    assert Scene.from_dict(CUBE).grid.cells == (10, 8, 6)
    assert tomllib.loads(Scene.from_dict(CUBE).to_toml())["boundary"]["back"]["kind"] == "free_slip"
    assert "front" not in tomllib.loads(Scene.from_dict(RING).to_toml())["boundary"]
    assert Scene.from_dict(BLOCK).in_space is PLANE_STRAIN
    assert Scene.from_dict(BLOCK).model_dump() == Scene.from_dict(BLOCK | {"space": "plane_strain"}).model_dump()


def test_the_left_side_is_the_axis_where_the_radius_is_zero_and_nowhere_else():
    assert Scene.from_dict(RING).left_is_axis
    assert Scene.from_dict(changed(RING, {"boundary": {"left": "free_slip"}})).left_is_axis
    assert not Scene.from_dict(BLOCK).left_is_axis
    around_a_hole = {"grid.lower": [0.2, 0.0], "body.0.shape.lower": [0.3, 0.0], "boundary": {"left": "no_slip"}}
    assert not Scene.from_dict(changed(RING, around_a_hole)).left_is_axis


def test_walls_have_a_velocity_along_themselves():
    walls = {"left": GRIPS | {"velocity": 0.5}, "bottom": GRIPS | {"velocity": -2}}
    plane = Scene.from_dict(changed(BLOCK, {"boundary": walls}))
    assert [plane.wall_velocity(side) for side in ("left", "bottom", "top")] == [(0.0, 0.5), (-2.0, 0.0), (0.0, 0.0)]
    pipe = Scene.from_dict(changed(RING, {"boundary": {"right": GRIPS | {"velocity": 0.5}}}))
    assert pipe.wall_velocity("right") == (0.0, 0.5)
    cube = Scene.from_dict(changed(CUBE, {"boundary": {"back": GRIPS | {"velocity": [1, 0, -0.5]}}}))
    assert cube.wall_velocity("back") == (1.0, 0.0, -0.5)
    assert cube.wall_velocity("front") == (0.0, 0.0, 0.0)
    assert Scene.from_dict(tomllib.loads(cube.to_toml())).wall_velocity("back") == (1.0, 0.0, -0.5)


def test_obstacles_turn_about_a_vector_in_3d():
    drum = {"name": "drum", "friction": 0.3, "angular_velocity": [0, 1, 0.0],
            "shape": {"kind": "sphere", "center": [0.1, 0.1, 0.5], "radius": 0.05}}  # fmt: skip
    scene = Scene.from_dict(CUBE | {"obstacle": [drum]})
    again = Scene.from_dict(tomllib.loads(scene.to_toml()))
    assert again.obstacle[0].angular_velocity == (0.0, 1.0, 0.0)
    for spin in (float("nan"), [0.0, 1.0], [0.0, float("inf"), 0.0], "fast", True):
        with pytest.raises(InputError, match=r"obstacle\.0\.angular_velocity: .* is no angular velocity; allowed"):
            Scene.from_dict(CUBE | {"obstacle": [drum | {"angular_velocity": spin}]})


OTHER = CUBE["body"][0] | {"shape": {"kind": "sphere", "center": [0.3, 0.2, 0.1], "radius": 0.1}}

IN_3D = {
    "misspelt space": ({"space": "3D"}, r"space = '3D': allowed: 'plane_strain', 'axisymmetric' or '3d'; did you mean"),
    "space is a list": ({"space": ["3d"]}, r"space = \['3d'\]: allowed: 'plane_strain', 'axisymmetric' or '3d'$"),
    "space of the plane": ({"space": "plane_strain"},
                           r"grid\.upper = \[1\.0, 0\.8, 0\.6\]: space = 'plane_strain' takes 2 components, x, y"),
    "gravity of the plane": ({"gravity": [0.0, -9.81]},
                             r"gravity = \[0\.0, -9\.81\]: space = '3d' takes 3 components, x, y, z"),
    "four components": ({"gravity": [0, 0, 0, -9.81]}, r"gravity = \[0, 0, 0, -9\.81\]: space = '3d' takes 3"),
    "text in a vector": ({"gravity": [0.0, "down", -9.81]}, r"gravity\.1 = 'down': allowed: a number"),
    "lower corner of the plane": ({"grid.lower": [0.0, 0.0]}, r"grid\.lower = \[0\.0, 0\.0\]: space = '3d' takes 3"),
    "upper corner is a number": ({"grid.upper": 1.0}, r"grid\.upper = 1\.0: allowed: a list"),
    "part of a cell": ({"grid.upper": [1.0, 0.8, 0.65]}, r"grid: the domain is 0\.65 m along z, not a whole number of"),
    "domain inside out": ({"grid.upper": [1.0, -0.8, 0.6]}, r"grid: the domain is -0\.8 m along y"),
    "velocity of the plane": ({"body.0.velocity": [1.0, 0.0]},
                              r"body\.0\.velocity = \[1\.0, 0\.0\]: space = '3d' takes 3 components, x, y, z"),
    "fast body": ({"body.0.velocity": [0.0, 0.0, 1e9]}, r"body\.0\.velocity: 1e\+09 m/s is out of bounds"),
    "shape of the plane": ({"body.0.shape.kind": "rectangle"},
                           r"body\.0\.shape\.kind = 'rectangle': allowed: 'box', 'cylinder', 'cone', 'sphere', 'mesh' "
                           r'in space = "3d"'),
    "misspelt shape": ({"body.0.shape.kind": "spere"}, r"kind = 'spere': allowed: .*; did you mean 'sphere'\?"),
    "corner of the plane": ({"body.0.shape.lower": [0.3, 0.2]}, r"shape\.lower = \[0\.3, 0\.2\]: takes x, y, z"),
    "corner is a text": ({"body.0.shape.lower": "0.3"}, r"body\.0\.shape\.lower = '0\.3': allowed: a list"),
    "box inside out": ({"body.0.shape.upper": [0.7, 0.6, -0.4]}, r"body\.0\.shape: upper = .* must lie above lower"),
    "misspelt key of a shape": ({"body.0.shape": {"kind": "sphere", "centre": [0.5, 0.4, 0.2], "radius": 0.1}},
                                r"unknown key 'body\.0\.shape\.centre'.*'body\.0\.shape\.center' is missing"),
    "axis without direction": ({"body.0.shape": {"kind": "cylinder", "center": [0.5, 0.4, 0], "radius": 0.2,
                                                 "height": 0.3, "axis": [0, 0, 0]}}, r"axis = .* has no direction"),
    "no mesh file": ({"body.0.shape": {"kind": "mesh", "file": "none.stl"}}, r"there is no mesh file none\.stl"),
    "squares of points": ({"body.0.points_per_cell": 4}, r"body\.0\.points_per_cell = 4: allowed: 1, 8, 27 or 64$"),
    "ratio out of no plane": ({"body.0.initial_stress": {"kind": "geostatic", "out_of_plane_ratio": 0.5}},
                              r"body\.0\.initial_stress\.out_of_plane_ratio belongs to space = 'plane_strain'; in"),
    "accuracy": ({"accuracy": "3%"}, r"accuracy = '3%' was measured in plane strain, in no other space"),
    "half periodic": ({"boundary": {"front": "periodic"}}, r"boundary: periodic sides .* set both front and"),
    "narrow periodic": ({"grid.upper": [1.0, 0.1, 0.6], "boundary": {"front": "periodic", "back": "periodic"}},
                        r"boundary\.front is periodic over 1 cells of the grid; allowed: 2 or more"),
    "misspelt side": ({"boundary": {"botom": "no_slip"}}, r"unknown key 'boundary\.botom'; did you mean 'bottom'\?"),
    "boundary is a text": ({"boundary": "no_slip"}, r"boundary = 'no_slip': allowed: a table"),
    "speed of a wall": ({"boundary": {"bottom": GRIPS | {"velocity": 1.0}}},
                        r"boundary\.bottom\.velocity = 1\.0: space = '3d' takes three components"),
    "wall of the plane": ({"boundary": {"bottom": GRIPS | {"velocity": [1.0, 0.0]}}},
                          r"boundary\.bottom\.velocity: \[1\.0, 0\.0\] is no velocity; allowed: .*in 3D three numbers"),
    "wall that leaves": ({"boundary": {"back": GRIPS | {"velocity": [1.0, 0.5, 0.0]}}},
                         r"boundary\.back\.velocity = .*: a wall slides along itself; allowed: 0 along y"),
    "slippery belt": ({"boundary": {"back": {"kind": "free_slip", "velocity": [1.0, 0.0, 0.0]}}},
                      r"boundary\.back: a velocity belongs to kind = 'friction' or 'no_slip'"),
    "overlap": ({"body": [CUBE["body"][0], OTHER]}, r"body\.0 and body\.1 overlap, .* at \(0\.\d+, 0\.\d+, 0"),
    "points outside": ({"body.0.shape.upper": [0.7, 0.6, 0.7]},
                       r"body\.0: 128 of 896 points lie outside the .*, the first at \(0\.325, 0\.225, 0\.625\)"),
    "body too small": ({"body.0.shape.upper": [0.31, 0.21, 0.01]}, r"body\.0: the shape holds no point"),
    "body in millimetres": ({"body.0.shape.upper": [700.0, 600.0, 400.0]},
                            r"body\.0: the shape is 1\.4e\+04 x 1\.2e\+04 x 8e\+03 points .*; lengths are in metres"),
    "surcharge below others": ({"body": [CUBE["body"][0] | {"initial_stress": {"kind": "geostatic", "surcharge": 1.0}},
                                         OTHER | {"shape": {"kind": "box", "lower": [0.3, 0.2, 0.4],
                                                            "upper": [0.7, 0.6, 0.5]}}]},
                               r"body\.0\.initial_stress\.surcharge = 1: the body is covered by others everywhere"),
}  # fmt: skip

IN_AXISYMMETRY = {
    "negative radius": ({"grid.lower": [-0.1, 0.0]}, r"grid\.lower = \[-0\.1, 0\.0\]: x is the .*; allowed: x >= 0"),
    "wall on the axis": ({"boundary": {"left": "no_slip"}},
                         r"boundary\.left = 'no_slip': the left side is the axis, x = 0, where no wall can stand"),
    "periodic along the radius": ({"grid.lower": [0.2, 0.0], "boundary": {"left": "periodic", "right": "periodic"},
                                   "body.0.shape.lower": [0.3, 0.0]}, r"nothing repeats along the radius"),
    "gravity along the radius": ({"gravity": [1.0, -9.81]}, r"gravity = \[1\.0, -9\.81\]: .*; allowed: x = 0"),
    "floor along the radius": ({"boundary": {"bottom": GRIPS | {"velocity": 1.0}}},
                               r"boundary\.bottom\.velocity = 1\.0: no floor slides along the radius"),
    "side of 3D": ({"boundary": {"front": "no_slip"}},
                   r"boundary\.front: space = 'axisymmetric' has no such side; left, right, bottom, top"),
    "wall of 3D": ({"boundary": {"right": GRIPS | {"velocity": [0.0, 0.0, 1.0]}}},
                   r"boundary\.right\.velocity = .*: space = 'axisymmetric' takes a number"),
    "shape of 3D": ({"body.0.shape": {"kind": "cylinder", "center": [0, 0, 0], "radius": 0.1, "height": 0.1}},
                    r"kind = 'cylinder': allowed: 'rectangle', 'disc', 'polygon', 'mesh' in space = \"axisymmetric\""),
    "cubes of points": ({"body.0.points_per_cell": 8}, r"points_per_cell = 8: allowed: 1, 4, 9, 16, 25 or 36"),
    "ratio out of the plane": ({"body.0.initial_stress": {"kind": "geostatic", "out_of_plane_ratio": 0.2}},
                               r"out_of_plane_ratio belongs to space = 'plane_strain'"),
}  # fmt: skip


@pytest.mark.parametrize(
    ("content", "changes", "message"),
    [(CUBE, *IN_3D[name]) for name in IN_3D] + [(RING, *IN_AXISYMMETRY[name]) for name in IN_AXISYMMETRY],
    ids=[*IN_3D, *IN_AXISYMMETRY],
)
def test_a_bad_scene_is_refused_in_one_line(content, changes, message):
    with pytest.raises(InputError) as caught:
        build_bodies(Scene.from_dict(changed(content, changes), "scene.toml"))
    line = str(caught.value)
    assert re.search(message, line)
    assert "\n" not in line
    assert len(line) < 400
    assert not re.search(r"Input should|should have at|valid (number|list|dictionary)|extract", line)


def test_more_cells_than_memory_are_refused_in_3d():
    scene = Scene.from_dict(changed(CUBE, {"grid.upper": [1e4, 8e3, 6e3], "body.0.points_per_cell": 1}), "scene.toml")
    with pytest.raises(InputError, match=r"^scene\.toml: grid: 100000 x 80000 x 60000 cells do not fit into memory$"):
        built_simulation(scene, 1)


def test_none_is_no_ratio_in_plane_strain():
    with pytest.raises(InputError, match=r"body\.0\.initial_stress\.out_of_plane_ratio = None: allowed: a number in"):
        Scene.from_dict(BLOCK | {"body": [BLOCK["body"][0] | {"initial_stress": {"out_of_plane_ratio": None}}]})


def test_a_quarter_is_clipped_from_a_shape_at_the_domain():
    whole = {"kind": "cylinder", "center": [0.5, 0.4, 0.0], "radius": 0.3, "height": 0.5}
    _, (full,) = bodies(CUBE, {"body.0.shape": whole})
    quarter = {"body.0.shape": whole | {"center": [0.0, 0.0, 0.0]}, "body.0.clip": True}
    _, (clipped,) = bodies(CUBE, quarter)
    assert len(clipped) * 4 == len(full)
    assert (clipped > 0.0).all()
    with pytest.raises(InputError, match="points lie outside the domain"):
        build_bodies(Scene.from_dict(changed(CUBE, quarter | {"body.0.clip": False})))


def test_masses_are_those_of_a_width_of_a_radian_and_of_the_whole():
    for content, mass in ((BLOCK, 1000.0 * 0.4 * 0.4), (RING, 1000.0 * 0.5**2 / 2 * 0.4), (CUBE, 1000.0 * 0.4**3)):
        scene, (places,) = bodies(content)
        masses = point_masses(scene, scene.body[0], places)
        assert masses.shape == (len(places),)
        assert masses.sum() == pytest.approx(mass, rel=1e-12)
    scene, (places,) = bodies(RING, {"body.0.points_per_cell": 9, "body.0.shape.lower": [0.2, 0.0]})
    masses = point_masses(scene, scene.body[0], places)
    assert masses.sum() == pytest.approx(1000.0 * (0.5**2 - 0.2**2) / 2 * 0.4, rel=1e-12)


def test_under_its_weight_a_body_is_stressed_alike_in_each_space():
    for content in (RING, CUBE):
        scene, places = bodies(content, {"body.0.initial_stress": {"kind": "geostatic", "surcharge": 50.0}})
        (vertical,) = vertical_stresses(scene, places)
        np.testing.assert_allclose(vertical, -WEIGHT * (0.4 - places[0][:, -1]) - 50.0, rtol=1e-12)


def test_horizontal_stresses_follow_from_the_vertical_one():
    stress = Scene.from_dict(changed(CUBE, {"body.0.initial_stress": {"kind": "geostatic", "horizontal_ratio": 0.5}}))
    section, vertical = stress.body[0].initial_stress, np.array([-1.0, -8.0])
    np.testing.assert_array_equal(
        normal_stresses(THREE_D, section, vertical), [0.5 * vertical, 0.5 * vertical, vertical]
    )
    np.testing.assert_array_equal(
        normal_stresses(AXISYMMETRIC, section, vertical), [0.5 * vertical, vertical, 0.5 * vertical]
    )
    plane = Scene.from_dict(BLOCK).body[0].initial_stress.model_copy(update={"kind": "geostatic"})
    np.testing.assert_array_equal(normal_stresses(PLANE_STRAIN, plane, vertical), [vertical] * 3)


def test_columns_of_bodies_weigh_on_one_another_in_3d():
    on_top = {"kind": "box", "lower": [0.3, 0.2, 0.4], "upper": [0.5, 0.4, 0.6]}
    stress = {"kind": "geostatic"}
    below = CUBE["body"][0] | {"initial_stress": stress}
    above = below | {"shape": on_top, "density": 500.0, "points_per_cell": 27}
    scene, places = bodies(CUBE, {"body": [below, above]})
    lower, upper = vertical_stresses(scene, places)
    x, y, z = places[0].T
    is_covered = (x < 0.5) & (y < 0.4)
    np.testing.assert_allclose(lower, -WEIGHT * (0.4 - z + 0.1 * is_covered), rtol=1e-9)
    np.testing.assert_allclose(upper, -0.5 * WEIGHT * (0.6 - places[1][:, 2]), rtol=1e-9)


def test_a_point_takes_the_mean_over_the_columns_that_its_cube_covers():
    # A coarse slab under a fine box that covers a third of the cubes along x, and two thirds along y.
    slab = CUBE["body"][0] | {
        "points_per_cell": 1,
        "initial_stress": {"kind": "geostatic"},
        "shape": {"kind": "box", "lower": [0.0, 0.0, 0.0], "upper": [1.0, 0.8, 0.2]},
    }
    fine = slab | {
        "points_per_cell": 27,
        "shape": {"kind": "box", "lower": [0.3, 0.2, 0.2], "upper": [0.3 + 0.1 / 3, 0.2 + 0.2 / 3, 0.6]},
    }
    scene, places = bodies(CUBE, {"body": [slab, fine]})
    lower, _ = vertical_stresses(scene, places)
    x, y, z = places[0].T
    share = np.where((abs(x - 0.35) < 0.01) & (abs(y - 0.25) < 0.01), 2.0 / 9.0, 0.0)
    np.testing.assert_allclose(lower, -WEIGHT * (0.2 - z + 0.4 * share), rtol=1e-9)


def test_a_gap_of_a_cell_breaks_a_column_and_a_table_counts_from_its_top_in_3d():
    table = {"kind": "table", "depth": [0.0, 0.5], "vertical_stress": [100.0, 600.0]}
    low = CUBE["body"][0] | {"initial_stress": table, "shape": {"kind": "box", "lower": [0.3, 0.2, 0.0],
                                                                "upper": [0.7, 0.6, 0.2]}}  # fmt: skip
    far = low | {"shape": low["shape"] | {"lower": [0.3, 0.2, 0.3], "upper": [0.7, 0.6, 0.5]}}
    scene, places = bodies(CUBE, {"body": [low, far]})
    for stress, place, top in zip(vertical_stresses(scene, places), places, (0.2, 0.5), strict=True):
        np.testing.assert_allclose(stress, -(100.0 + 1000.0 * (top - place[:, 2])), rtol=1e-9)
    near = {"body.1.shape.lower": [0.3, 0.2, 0.25]}
    scene, places = bodies(changed(CUBE, {"body": [low, far]}), near)
    lower, _ = vertical_stresses(scene, places)
    np.testing.assert_allclose(lower, -(100.0 + 1000.0 * (0.5 - places[0][:, 2])), rtol=1e-9)
