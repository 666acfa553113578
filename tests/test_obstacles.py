"""Obstacles: distances, contact on planes at any angle, motion, forces, and what is wrong with a scene."""

import math

import numpy as np
import pytest
import trimesh
from scenes_for_tests import ELASTIC, MU_I_LC, changed, simulation, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.obstacles import surface as surfaces
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.motion import Steady, at_rest
from grainlaw.mpm_core.obstacles.obstacle import Obstacle
from grainlaw.mpm_core.output.checkpoint import Clock, read_checkpoint, write_checkpoint
from grainlaw.mpm_core.scene.mesh_region import MeshRegion
from grainlaw.mpm_core.scene.model import GridSection
from grainlaw.mpm_core.scene.obstacle_surfaces import placed

G = 9.81
STIFF = {"bulk_modulus": 1e6, "poisson_ratio": 0.2}
# A block of 16 x 8 cells that floats over nothing until a plane is put below it.
SLOPE = {
    "gravity": [0.0, -G],
    "grid": {"cell_size": 0.025, "upper": [3.0, 3.0]},
    "time": {"end": 0.5},
    "material": {"linear_elastic": STIFF},
    "body": [
        {
            "material": "linear_elastic",
            "density": 1500.0,
            "shape": {"kind": "rectangle", "lower": [1.0, 1.0], "upper": [1.4, 1.2]},
        }
    ],
}


def at(surface, *places, space_axes=2):
    """Distances of places from a surface whose frame is that of space."""
    obstacle = Obstacle("it", surface, 0.0, Steady(at_rest((0.0,) * space_axes), *np.zeros((3, 3))))
    return distances(obstacle, np.array(places, dtype=float).T)


def test_distances_of_shapes_are_exact():
    square = surfaces.polygon([(0, 0), (0, 1), (1, 1), (1, 0)])
    np.testing.assert_allclose(
        at(square, (0.5, 1.25), (0.5, 0.9), (1.3, 1.4), (0.5, 0.5), (1.0, 0.3)), [0.25, -0.1, 0.5, -0.5, 0.0]
    )
    notched = surfaces.polygon([(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)])
    np.testing.assert_allclose(at(notched, (1.0, 2.0), (1.0, 0.9)), [math.sqrt(0.5), -0.1])
    np.testing.assert_allclose(at(surfaces.ball(0.5), (0.3, 0.4), (3.0, 4.0)), [0.0, 4.5], atol=1e-15)
    box = surfaces.box([1.0, 2.0, 3.0])
    np.testing.assert_allclose(at(box, (2, 0, 0), (4, 6, 0), (0.9, 0, 0), space_axes=3), [1.0, 5.0, -0.1])
    cylinder = surfaces.cylinder(1.0, 2.0)
    np.testing.assert_allclose(
        at(cylinder, (3, 0, 0), (0, 4, 6), (0.5, 0, 0), (0, 0, 1.9), space_axes=3), [2.0, 5.0, -0.5, -0.1]
    )


def test_a_grid_of_distances_interpolates_linear_ones_exactly():
    axes = [np.linspace(-1.0, 1.0, 5)] * 3
    x, y, z = np.meshgrid(*axes, indexing="ij")
    normal = np.array([2.0, 1.0, 2.0]) / 3.0
    tilted = surfaces.distance_grid((-1, -1, -1), 0.5, normal[0] * x + normal[1] * y + normal[2] * z)
    places = np.random.default_rng(1).uniform(-1, 1, size=(50, 3))
    np.testing.assert_allclose(at(tilted, *places, space_axes=3), places @ normal, atol=1e-12)


def on_plane(angle, friction, slope, **changes):
    """A block on a plane turned by an angle, with gravity at an angle `slope` to its normal; and both directions."""
    turn, tilt = math.radians(angle), math.radians(slope)
    along, normal = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
    plane = {"kind": "plane", "point": [1.2, 1.0], "normal": normal.tolist()}
    gravity = G * (math.sin(tilt) * along - math.cos(tilt) * normal)
    # The obstacle comes after the bodies, which are first turned onto it.
    case = simulation(SLOPE, {"gravity": gravity.tolist(), **changes})
    (body,) = case.bodies
    axes, start = np.stack([along, normal], axis=1), np.array([[1.2], [1.0]])
    in_plane = body.positions - start
    body.positions = start + axes @ in_plane
    pressure = 1500.0 * G * math.cos(tilt) * (0.2 - in_plane[1])
    shear = min(friction, math.tan(tilt)) * pressure
    stress = np.array([[-0.25 * pressure, shear], [shear, -pressure]])
    stress = np.einsum("ij,jkp,lk->ilp", axes, stress, axes)
    body.stress = [stress[0, 0], stress[1, 1], -0.25 * pressure, stress[0, 1]]
    obstacle = {"name": "plane", "shape": plane, "friction": friction}
    put_obstacle(case, obstacle)
    return case, along, normal


def put_obstacle(case, content):
    """Put an obstacle into a simulation that has its bodies where they belong."""
    content = changed(
        SLOPE, {"obstacle": [content], "body.0.shape.lower": [2.8, 2.8], "body.0.shape.upper": [2.9, 2.9]}
    )
    case.obstacles = simulation(content).obstacles
    case.obstacles._free_room.grid = case.grid
    case.measure_signals()


@pytest.mark.parametrize("angle", [0, 27, 45])
def test_a_block_slides_down_a_plane_at_any_angle_as_the_exact_one(angle):
    case, along, normal = on_plane(angle, 0.3, 30.0)
    (body,), (plane,) = case.bodies, case.obstacles.all
    start = body.positions.mean(axis=1)
    case.advance_to(0.25)
    way = body.positions.mean(axis=1) - start
    exact = 0.5 * G * (math.sin(math.radians(30)) - 0.3 * math.cos(math.radians(30))) * 0.25**2
    assert way @ along == pytest.approx(exact, rel=3e-3)
    assert abs(way @ normal) < 1e-3
    force, _ = plane.forces.means()
    weight = body.masses.sum() * G * math.cos(math.radians(30))
    assert -force[:2] @ normal == pytest.approx(weight, rel=0.015)
    # mobilised friction, and no more
    assert force[:2] @ along == pytest.approx(-0.3 * (force[:2] @ normal), rel=0.03)
    # a wall of the domain takes as much: while the block rings, it is faster where it presses less
    assert case.ledger.obstacle_friction == pytest.approx(0.3 * weight * exact, rel=0.08)
    assert case.ledger.numerical_dissipation > -0.01 * case.ledger.obstacle_friction


def test_a_block_sticks_where_friction_holds_it():
    case, along, _ = on_plane(27, 0.6, 25.0)
    (body,) = case.bodies
    start = body.positions.mean(axis=1)
    case.advance_to(0.25)
    assert abs((body.positions.mean(axis=1) - start) @ along) < 1.5e-3 * 0.2


# A pile of sand in a box, with something in it.
BOX = {
    "gravity": [0.0, -9.8],
    "grid": {"cell_size": 0.025, "upper": [0.5, 0.5]},
    "time": {"end": 0.2},
    "boundary": {"bottom": {"kind": "friction", "coefficient": 0.5}},
    "material": {"mu_i_lc": MU_I_LC},
    "body": [
        {
            "material": "mu_i_lc",
            "density": 1500.0,
            "shape": {"kind": "rectangle", "lower": [0.0, 0.1], "upper": [0.5, 0.3]},
            "initial_stress": {"kind": "geostatic"},
        }
    ],
    "obstacle": [
        {"name": "shelf", "friction": 0.5, "shape": {"kind": "rectangle", "lower": [-0.1, 0.0], "upper": [0.6, 0.1]}}
    ],
}


def test_a_shelf_carries_the_weight_of_what_lies_on_it_and_nothing_leaks():
    case = simulation(BOX)
    (body,), (shelf,) = case.bodies, case.obstacles.all
    case.advance_to(0.1)
    shelf.forces.impulse[:], shelf.forces.duration = 0.0, 0.0
    case.advance_to(0.2)
    force, _ = shelf.forces.means()
    assert -force[1] == pytest.approx(9.8 * body.masses.sum(), rel=5e-3)
    assert distances(shelf, body.positions).min() > 0.0
    assert body.speed.max() < 0.05


SHELF_IN = {
    "axisymmetric": {
        "grid.upper": [0.6, 0.4],
        "body.0.shape.upper": [0.2, 0.3],
        "obstacle.0.shape.upper": [0.7, 0.1],
    },
    "3d": {
        "gravity": [0.0, 0.0, -9.8],
        "grid.upper": [0.4, 0.4, 0.35],
        "boundary.left": "free_slip",
        "boundary.front": "free_slip",
        "body.0.shape": {"kind": "box", "lower": [0.0, 0.0, 0.1], "upper": [0.15, 0.15, 0.25]},
        "obstacle.0.shape": {"kind": "box", "lower": [-0.1, -0.1, 0.0], "upper": [0.5, 0.5, 0.1]},
    },
}


@pytest.mark.parametrize("space", SHELF_IN)
def test_a_heap_weighs_on_a_shelf_what_it_weighs(space):
    case = simulation(BOX, SHELF_IN[space] | {"space": space, "time.end": 1.0})
    (body,), (shelf,) = case.bodies, case.obstacles.all
    start = body.positions[0].max()
    case.advance_to(0.6)
    shelf.forces.reset()
    case.advance_to(1.0)
    up = case.space.axes - 1
    assert body.positions[0].max() > 1.3 * start
    assert -shelf.forces.means()[0][up] == pytest.approx(9.8 * body.masses.sum(), rel=5e-3)


def test_a_piston_does_the_work_that_the_sand_takes_up():
    rising = {"obstacle.0.velocity": [0.0, 0.1], "obstacle.0.shape.lower": [-0.1, -0.5]}
    case = simulation(BOX, rising)
    case.advance_to(0.2)
    lift = case.bodies[0].positions[1].mean() - 0.2
    assert lift == pytest.approx(0.02, rel=0.05)
    assert case.obstacles.all[0].motion.pose.position[1] == pytest.approx(-0.2 + 0.02)
    ledger = case.ledger
    given = -ledger.obstacle_work
    assert given == pytest.approx(ledger.potential + ledger.kinetic + ledger.internal_work, rel=0.1)


@pytest.mark.parametrize(
    "moves",
    [
        {"velocity": [0.0, -40.0]},
        {"angular_velocity": 100.0, "center": [0.25, 0.0]},
        {"motion": {"time": [0.0, 1.0], "displacement": [[0.0, 0.0], [0.0, -40.0]]}},
    ],
)
def test_the_velocity_of_an_obstacle_bounds_the_first_step(moves):
    plate = {"kind": "rectangle", "lower": [0.2, 0.4], "upper": [0.3, 0.45]}
    content = {**BOX, "obstacle": [{"name": "plate", "friction": 0.0, "shape": plate, **moves}]}
    still = {**content, "obstacle": [{"name": "plate", "friction": 0.0, "shape": plate}]}
    fast, slow = (simulation(one).critical_time_step() for one in (content, still))
    cell = simulation(still).grid.cell_size
    assert cell / fast - cell / slow >= 40.0


def test_a_gate_that_is_taken_away_lets_the_sand_fall():
    case = simulation(BOX, {"obstacle.0.until": 0.1})
    case.advance_to(0.1)
    held = case.bodies[0].positions[1].min()
    case.advance_to(0.2)
    assert held > 0.1
    assert case.bodies[0].positions[1].min() < 0.1 - 0.02


def test_a_free_disc_falls_and_takes_the_momentum_that_the_sand_gets():
    disc = {
        "name": "disc",
        "friction": 0.3,
        "shape": {"kind": "disc", "center": [0.25, 0.37], "radius": 0.05},
        "free": {"density": 4000.0, "velocity": [0.0, -2.0]},
    }
    case = simulation(BOX, {"obstacle": [BOX["obstacle"][0], disc], "gravity": [0.0, 0.0]})
    (body,), (shelf, free) = case.bodies, case.obstacles.all
    mass = 4000.0 * math.pi * 0.05**2
    case.advance_to(0.05)
    gained = float((body.masses * body.velocity[1]).sum()) + mass * (free.motion.pose.velocity[1] + 2.0)
    # what the shelf took, and what the points do not hold of the momentum on the grid
    assert gained == pytest.approx(-shelf.forces.impulse[1], abs=0.01 * mass * 2.0)
    assert free.motion.pose.velocity[1] > -1.9


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"shape": {"kind": "rectangle", "lower": [0.1, 0.15], "upper": [0.2, 0.2]}}, "lie inside obstacle 'shelf'"),
        ({"shape": {"kind": "disc", "center": [9.0, 9.0], "radius": 0.1}}, "lies outside the domain"),
        ({"shape": {"kind": "box", "lower": [0, 0, 0], "upper": [1, 1, 1]}}, "allowed in space = 'plane_strain'"),
        ({"shape": {"kind": "polygon", "vertices": [[0, 0], [0.1, 0.1], [0, 0.1], [0.1, 0]]}}, "crosses"),
        ({"shape": {"kind": "terrain", "points": [[0.2, 0], [0.1, 0]]}}, "increasing x"),
        ({"velocity": [0.0, 0.1, 0.0]}, "takes x, y"),
        ({"frction": 0.5}, "did you mean 'friction'"),
        ({"motion": {"time": [0.0, 0.2, 0.1], "displacement": [[0, 0]] * 3}}, "increase from value to value"),
        (
            {"motion": {"time": [0.0, 1e-9], "displacement": [[0, 0], [5, 0]]}},
            "5e+09 m/s from t = 0 to 1e-09 s is out of",
        ),
        ({"free": {"density": 10.0, "mass": 1.0}}, "a density or a mass"),
        ({"center": [0.0, 0.0]}, "belongs to an angular_velocity"),
        ({"name": "two words"}, "obstacle.0.name"),
    ],
)
def test_what_is_wrong_with_an_obstacle_is_said_in_one_line(change, sentence):
    content = changed(BOX, {f"obstacle.0.{key}": value for key, value in change.items()})
    with pytest.raises(InputError) as raised:
        simulation(content)
    assert sentence in str(raised.value)
    assert "\n" not in str(raised.value)


def test_scenes_with_obstacles_survive_being_written_and_read():
    scene = Scene.from_dict(changed(BOX, {"material.linear_elastic": ELASTIC}))
    import tomllib

    assert Scene.from_dict(tomllib.loads(scene.to_toml())) == scene


STIRRED = {
    "obstacle": [
        BOX["obstacle"][0],
        {
            "name": "paddle",
            "friction": 0.4,
            "shape": {"kind": "line", "points": [[0.15, 0.2], [0.35, 0.2]], "thickness": 0.08},
            "angular_velocity": 6.0,
        },
    ],
    "body.0.shape.lower": [0.0, 0.26],
    "body.0.shape.upper": [0.5, 0.4],
    "precision": "single",
}


def end_of(case):
    (body,) = case.bodies
    return body.points.tobytes(), case.obstacles.all[1].state.tobytes(), case.ledger


def test_a_turning_obstacle_gives_the_same_bits_on_two_threads_and_from_a_checkpoint(tmp_path):
    one, two = (simulation(BOX, STIRRED, threads) for threads in (1, 2))
    for case in (one, two):
        case.advance_to(0.05)
    write_checkpoint(tmp_path, one, Clock())
    resumed = simulation(BOX, STIRRED)
    read_checkpoint(tmp_path, resumed)
    for case in (one, two, resumed):
        case.advance_to(0.1)
    assert end_of(one) == end_of(two) == end_of(resumed)
    assert one.obstacles.all[1].forces.moment[2] != 0.0


@pytest.mark.parametrize("speed", [5.0, 50.0])
@pytest.mark.parametrize("thickness", [0.1, 0.5, 2.0])
def test_nothing_is_shot_through_a_plate(speed, thickness):
    plate = {"kind": "line", "points": [[-0.1, 0.06], [0.6, 0.06]], "thickness": thickness * 0.025}
    changes = {
        "obstacle": [{"name": "plate", "friction": 0.3, "shape": plate}],
        "body.0.velocity": [0.0, -speed],
        "body.0.initial_stress": {"kind": "none"},
        "boundary.bottom": "free_slip",
        "grid.upper": [0.5, 3.0],
    }
    case = simulation(BOX, changes)
    case.advance_to(0.02 if speed < 10.0 else 0.004)
    (body,) = case.bodies
    energy = 0.5 * float(body.masses.sum()) * speed**2
    assert body.positions[1].min() > 0.06
    assert case.ledger.kinetic < energy
    assert case.ledger.numerical_dissipation > -1e-3 * energy


def test_a_closed_mesh_has_the_distances_mass_and_inertia_of_what_it_bounds(tmp_path):
    mesh = trimesh.creation.box([0.4, 0.6, 0.8])
    mesh.apply_translation([1.0, 1.0, 1.0])
    mesh.export(tmp_path / "box.stl")
    shape = MeshRegion(kind="mesh", file=tmp_path / "box.stl")
    found = placed(shape, GridSection(cell_size=0.1, lower=(0, 0, 0), upper=(2, 2, 2)))
    np.testing.assert_allclose(found.position, 1.0, atol=1e-6)
    assert found.volume == pytest.approx(0.192, rel=1e-6)
    np.testing.assert_allclose(found.inertia, 0.192 / 12.0 * np.array([1.0, 0.8, 0.52]), rtol=1e-6)
    inside = at(found.surface, (0.0, 0.0, 0.0), (0.15, 0.0, 0.0), (0.3, 0.0, 0.0), space_axes=3)
    np.testing.assert_allclose(inside, [-0.2, -0.05, 0.1], atol=5e-3)


def test_a_mesh_whose_parts_overlap_is_refused(tmp_path):
    boxes = [
        trimesh.creation.box([0.4, 0.4, 0.4], trimesh.transformations.translation_matrix([x, 1, 1])) for x in (1, 1.2)
    ]
    trimesh.util.concatenate(boxes).export(tmp_path / "boxes.stl")
    shape = MeshRegion(kind="mesh", file=tmp_path / "boxes.stl")
    with pytest.raises(ValueError, match=r"parts of the surface overlap, .*, at \(1\.0"):
        placed(shape, GridSection(cell_size=0.1, lower=(0, 0, 0), upper=(2, 2, 2)))


def test_what_sleeps_wakes_before_an_obstacle_that_moves_and_not_before_one_that_rests():
    # a sinker that comes down through the air; below it the sand has gone to sleep
    times = {"time": [0.0, 0.1, 0.2], "displacement": [[0.0, 0.0], [0.0, 0.0], [0.0, -0.15]]}
    sinker = {"name": "sinker", "friction": 0.3, "shape": {"kind": "disc", "center": [0.25, 0.46], "radius": 0.05}}
    changes = {"sleep": {"speed": 5e-3, "window": 0.02}, "obstacle": [BOX["obstacle"][0], sinker]}
    resting = simulation(BOX, changes)
    sinking = simulation(BOX, {**changes, "obstacle": [BOX["obstacle"][0], {**sinker, "motion": times}]})
    awake = []
    for case in (resting, sinking):
        for time in (0.09, 0.2):
            case.advance_to(time)
            awake.append(case.bodies[0].awake)
    assert awake[0] == awake[1] == awake[2] == 0
    assert awake[3] > 50
    depth = sinking.bodies[0].positions[:, np.abs(sinking.bodies[0].positions[0] - 0.25) < 0.02][1].max()
    assert depth < 0.28


def test_a_motion_file_counts_from_the_scene_file(tmp_path):
    (tmp_path / "motion.csv").write_text("t,x,y,angle\n0,0,0,0\n0.1,0.2,0,0.5\n")
    content = changed(BOX, {"obstacle.0.motion": {"file": "motion.csv"}})
    scene = Scene.load(write_scene(tmp_path / "scene.toml", content))
    assert scene.obstacle[0].motion.displacement == [(0.0, 0.0), (0.2, 0.0)]
    assert scene.obstacle[0].motion.angle == [0.0, 0.5]


def test_an_empty_motion_file_is_said_in_one_line(tmp_path):
    (tmp_path / "motion.csv").write_text("")
    content = changed(BOX, {"obstacle.0.motion": {"file": "motion.csv"}})
    with pytest.raises(InputError, match=r"obstacle\.0\.motion: file .*motion\.csv cannot be read: .*Empty input file"):
        Scene.load(write_scene(tmp_path / "scene.toml", content))
