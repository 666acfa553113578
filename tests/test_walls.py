"""What the sides of the domain do: free fall until contact, Coulomb friction, no-slip, free-slip, periodic."""

import math

import numpy as np
import pytest
from scenes_for_tests import BLOCK, COLUMN, momentum, simulation

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene.model import FEWEST_PERIODIC_CELLS

G = 9.81


def advance(case, end):
    while case.time < end:
        case.step(min(0.4 * case.critical_time_step(), end - case.time))


def test_free_fall_is_exact():
    dt, steps = 2e-3, 60
    case = simulation(BLOCK, {"gravity": [0.0, -G]})
    (body,) = case.bodies
    start = body.positions[1][np.argsort(body.ids)]
    for _ in range(steps):
        case.step(dt)
    fallen = start - body.positions[1][np.argsort(body.ids)]
    time = steps * dt
    # Velocities belong to the middles of steps.
    np.testing.assert_allclose(fallen, 0.5 * G * time**2, rtol=1e-10)
    np.testing.assert_allclose(body.velocity[1], -G * (time - 0.5 * dt), rtol=1e-10)
    np.testing.assert_allclose(body.stress[:2], 0.0, atol=1e-6)
    # What the half step from rest to the first velocity leaves out.
    left_out = 0.5 * body.count * body.point_mass * (0.5 * G * dt) ** 2
    assert case.ledger.numerical_dissipation == pytest.approx(left_out, rel=1e-6)


DIRECTIONS = {"bottom": (0.0, -G), "top": (0.0, G), "left": (-G, 0.0), "right": (G, 0.0)}


def distances_from(side, case):
    """Of the points from a side of the domain, in cells."""
    axis = 0 if side in ("left", "right") else 1
    place = case.grid.lower[axis] if side in ("left", "bottom") else case.grid.upper[axis]
    return np.abs(case.bodies[0].positions[axis] - place) / case.grid.cell_size


@pytest.mark.parametrize("side", DIRECTIONS)
@pytest.mark.parametrize("basis", ["quadratic", "cubic"])
def test_a_block_that_is_lowered_on_a_friction_wall_touches_it(side, basis):
    changes = {
        "gravity": DIRECTIONS[side],
        "transfer.basis": basis,
        "boundary": {side: {"kind": "friction", "coefficient": 0.5}},
        "material.linear_elastic.bulk_modulus": 1e6,
    }
    case = simulation(BLOCK, changes)
    time_constant = 0.05
    case.body_force = lambda body, time: -body.velocity / time_constant
    advance(case, 0.3 / (G * time_constant) + 0.5)
    # A quarter of a cell, less the strain of the lowest row.
    assert distances_from(side, case).min() == pytest.approx(0.25, abs=2e-3)


def test_a_friction_wall_is_not_felt_before_the_material_is_there():
    case = simulation(BLOCK, {"gravity": [0.0, -G], "boundary.bottom": {"kind": "friction", "coefficient": 0.5}})
    (body,) = case.bodies
    start = body.positions[1].mean()
    time = math.sqrt(2.0 * 0.2 / G)
    while case.time < time:
        case.step(min(1e-3, time - case.time))
    assert start - body.positions[1].mean() == pytest.approx(0.2, rel=1e-10)
    assert abs(case.ledger.wall_work) < 1e-9


def test_a_layer_that_falls_across_periodic_sides_stays_flat():
    changes = {
        "gravity": [0.0, -G],
        "boundary": {
            "left": "periodic",
            "right": "periodic",
            "bottom": {"kind": "friction", "coefficient": 0.5},
        },
        "body.0.shape": {"kind": "rectangle", "lower": [0.0, 0.1], "upper": [1.0, 0.3]},
        "body.0.velocity": [0.5, 0.0],
    }
    case = simulation(BLOCK, changes)
    advance(case, 0.2)
    rows = np.sort(case.bodies[0].positions[1]).reshape(4, 20)
    np.testing.assert_allclose(rows, np.broadcast_to(rows.mean(axis=1, keepdims=True), rows.shape), rtol=1e-10)
    assert rows[0, 0] < 0.03


@pytest.mark.parametrize("cells", [2, 4, 5])
def test_all_copies_of_a_node_across_periodic_sides_are_the_same(cells):
    """A grid that is periodic over four cells has three copies of a node."""
    layer = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.1 * cells, 0.3]}
    sides = {"left": "periodic", "right": "periodic", "bottom": {"kind": "friction", "coefficient": 0.5}}
    case = simulation(BLOCK, {"grid.upper": [0.1 * cells, 0.8], "boundary": sides, "body.0.shape": layer})
    (body,) = case.bodies
    case._sort()
    # As far as points may drift before they are sorted again.
    body.positions[0] += np.where(body.positions[0] < 0.2, -0.08, 0.08)
    case._p2g()
    (clearances,) = case.wall_clearance.clearances()
    nodes = case.grid.nodes.reshape(*case.grid.shape, -1)
    for copy in range(cells, case.grid.shape[0]):
        np.testing.assert_array_equal(nodes[copy], nodes[copy - cells])
        assert clearances[copy] == clearances[copy - cells]
    assert nodes[:cells, :, case.grid.components.mass].sum() == pytest.approx(body.count * body.point_mass, rel=1e-12)


@pytest.mark.parametrize("threads", [1, 2])
def test_the_gap_of_a_node_is_that_of_the_lowest_point_in_its_support(threads):
    case = simulation(BLOCK, {"boundary.bottom": {"kind": "friction", "coefficient": 0.5}})
    case.threads = threads
    (body,) = case.bodies
    body.positions[1] -= 0.15

    def gaps():
        case.find_active_nodes()
        (found,) = case.wall_clearance.clearances()
        return found

    expected = np.full(case.grid.shape[0], np.inf)
    # The block from 0.3 to 0.7 m; nodes lie 0.1 m apart and begin at -0.2 m.
    expected[4:11] = 0.05
    np.testing.assert_allclose(gaps(), expected, rtol=1e-12)
    body.points[:] = body.points[:, np.random.default_rng(1).permutation(body.count)]
    np.testing.assert_allclose(gaps(), expected, rtol=1e-12)
    body.density = 500.0
    np.testing.assert_allclose(gaps(), expected, rtol=1e-12, err_msg="what an opened point gained is void")
    body.density = 4000.0
    np.testing.assert_allclose(gaps(), expected + 0.0125, rtol=1e-12)
    body.positions[1, np.argmin(body.positions[0])] = 0.01
    assert gaps()[4] == 0.0


def block_on_a_plane(angle, friction, bulk_modulus=1e6):
    """A flat stiff block on a plane of this angle, at rest and without shear stress at the start."""
    angle = math.radians(angle)
    changes = {
        "gravity": [G * math.sin(angle), -G * math.cos(angle)],
        "grid": {"cell_size": 0.05, "upper": [1.2, 0.4]},
        "boundary.bottom": {"kind": "friction", "coefficient": friction},
        "material.linear_elastic.bulk_modulus": bulk_modulus,
        "body.0.shape": {"kind": "rectangle", "lower": [0.2, 0.0], "upper": [0.6, 0.1]},
        "body.0.initial_stress": {"kind": "geostatic", "horizontal_ratio": 0.0, "out_of_plane_ratio": 0.2},
    }
    return simulation(BLOCK, changes)


def test_a_block_below_the_friction_angle_sticks():
    case = block_on_a_plane(angle=20.0, friction=0.45)
    x = case.bodies[0].positions[0]
    start = x.mean()
    advance(case, 0.2)
    stuck = x.mean()
    advance(case, 0.5)
    assert abs(stuck - start) < 2e-4
    assert abs(x.mean() - stuck) < 1e-6


@pytest.mark.parametrize(("angle", "friction"), [(30.0, 0.3), (30.0, 0.0), (40.0, 0.6)])
def test_a_block_above_the_friction_angle_slides_at_the_rate_of_coulomb(angle, friction):
    """It starts with the shear stress of steady sliding; without, it sticks until a shear wave has brought that."""
    case = block_on_a_plane(angle, friction)
    case.bodies[0].stress[3] = -friction * case.bodies[0].stress[1]
    start = case.bodies[0].positions[0].mean()
    advance(case, 0.3)
    steep = math.radians(angle)
    expected = 0.5 * G * (math.sin(steep) - friction * math.cos(steep)) * 0.3**2
    assert case.bodies[0].positions[0].mean() - start == pytest.approx(expected, rel=0.01)


def test_friction_brings_a_thrown_block_to_rest_after_the_distance_of_coulomb():
    case = block_on_a_plane(angle=0.0, friction=0.5)
    (body,) = case.bodies
    body.velocity[0] = 1.0
    start = body.positions[0].mean()
    advance(case, 0.5)
    assert abs(body.velocity[0].mean()) < 1e-3
    assert body.positions[0].mean() - start == pytest.approx(1.0 / (2.0 * 0.5 * G), rel=0.03)
    # All of the block's kinetic energy went into the floor, but for what the transfer took.
    assert case.ledger.wall_work == pytest.approx(0.5 * body.count * body.point_mass, rel=0.1)


def test_material_may_leave_a_friction_wall_but_not_the_others():
    at_floor = {"kind": "rectangle", "lower": [0.3, 0.0], "upper": [0.7, 0.4]}
    rises = {}
    for kind in ("friction", "free_slip"):
        wall = {"kind": kind, "coefficient": 0.5} if kind == "friction" else {"kind": kind}
        case = simulation(BLOCK, {"body.0.shape": at_floor, "body.0.velocity": [0.0, 0.5], "boundary.bottom": wall})
        advance(case, 0.1)
        rises[kind] = case.bodies[0].positions[1].min()
    assert rises["friction"] == pytest.approx(0.025 + 0.05, rel=1e-6)
    assert rises["free_slip"] < 0.05


def test_a_free_slip_wall_keeps_tangential_momentum_and_a_no_slip_wall_takes_it():
    at_floor = {"kind": "rectangle", "lower": [0.2, 0.0], "upper": [0.4, 0.2]}
    kept = {}
    for kind in ("free_slip", "no_slip"):
        changes = {"body.0.shape": at_floor, "body.0.velocity": [0.5, -0.2], "boundary.bottom": kind}
        case = simulation(BLOCK, changes)
        before = momentum(case)
        advance(case, 0.05)
        kept[kind] = momentum(case)[0] / before[0]
        lowest = case.bodies[0].positions[1] < 0.5 * case.grid.cell_size
        if kind == "no_slip":
            assert np.abs(case.bodies[0].velocity[0][lowest]).mean() < 0.2
    assert kept["free_slip"] == pytest.approx(1.0, rel=1e-12)
    assert kept["no_slip"] < 0.7


@pytest.mark.parametrize(("precision", "round_off", "off"), [("double", 1e-12, 1e-11), ("single", 1e-6, 1e-6)])
def test_uniform_motion_around_a_periodic_box_comes_back_to_the_same_state(precision, round_off, off):
    sides = dict.fromkeys(("left", "right", "bottom", "top"), "periodic")
    disc = {"kind": "disc", "center": [0.5, 0.4], "radius": 0.25}
    changes = {"boundary": sides, "body.0.shape": disc, "body.0.velocity": [1.0, 0.8], "precision": precision}
    case = simulation(BLOCK, changes)
    (body,) = case.bodies
    start = body.positions[:, np.argsort(body.ids)]
    before = momentum(case)
    for _ in range(500):
        case.step(2e-3)
    np.testing.assert_allclose(momentum(case), before, rtol=round_off)
    end = body.positions[:, np.argsort(body.ids)]
    size = np.array([[1.0], [0.8]])
    away = np.mod(end - start + 0.5 * size, size) - 0.5 * size
    np.testing.assert_allclose(away, 0.0, atol=off)
    np.testing.assert_allclose(body.stress[:2], 0.0, atol=1e5 * off)


@pytest.mark.parametrize("basis", ["linear", "quadratic", "cubic"])
def test_momentum_is_exact_across_the_narrowest_periodic_box(basis):
    cells = FEWEST_PERIODIC_CELLS
    changes = {
        "transfer.basis": basis,
        "grid.upper": [cells * 0.1, 0.8],
        "boundary": {"left": "periodic", "right": "periodic"},
        "body.0.shape": {"kind": "rectangle", "lower": [0.0, 0.2], "upper": [cells * 0.1, 0.6]},
    }
    case = simulation(BLOCK, changes)
    (body,) = case.bodies
    body.velocity[0] = 1.0 + 0.1 * np.random.default_rng(4).normal(size=body.count)
    before = momentum(case)
    for _ in range(50):
        case.step(1e-3)
    np.testing.assert_allclose(momentum(case), before, rtol=1e-12, atol=1e-10)


@pytest.mark.parametrize(("basis", "tolerance"), [("quadratic", 0.005), ("cubic", 0.02)])
def test_a_column_between_smooth_walls_keeps_its_geostatic_stress(basis, tolerance):
    changes = {
        "transfer.basis": basis,
        "grid": {"cell_size": 0.05, "upper": [0.2, 1.0]},
        "boundary.bottom": {"kind": "friction", "coefficient": 0.5},
        "body.0.shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.2, 0.8]},
        "material.mu_i_lc.bulk_modulus": 2e5,
    }
    case = simulation(COLUMN, changes)
    (body,) = case.bodies
    advance(case, 0.5)
    largest = 1500.0 * 9.8 * 0.8
    depth = 0.8 - body.positions[1]
    assert np.abs(body.velocity[1]).max() < 1e-3
    np.testing.assert_allclose(body.stress[1], -1500.0 * 9.8 * depth, atol=tolerance * largest)


GRIPPING = ({"kind": "no_slip", "velocity": 0.2}, {"kind": "friction", "coefficient": 5.0, "velocity": 0.2})


@pytest.mark.parametrize("wall", GRIPPING)
def test_a_sliding_wall_drags_a_block_along(wall):
    """At rest relative to the floor the block is at rest: what moves with it keeps its place on it."""
    changes = {
        "gravity": [0.0, -9.81],
        "boundary": {"bottom": wall},
        "body.0.shape.lower": [0.3, 0.0],
        "body.0.shape.upper": [0.7, 0.4],
        "body.0.velocity": [0.2, 0.0],
        "body.0.initial_stress": {"kind": "geostatic"},
    }
    present = simulation(BLOCK, changes)
    body = present.bodies[0]
    start = body.positions[0].mean()
    for _ in range(100):
        present.step(1e-3)
    assert body.positions[0].mean() - start == pytest.approx(0.02, rel=1e-3)


def test_a_sliding_wall_takes_a_resting_block_along_by_friction():
    """The impulse of friction is mu g t per mass, towards the wall's motion."""
    changes = {
        "gravity": [0.0, -9.81],
        "boundary": {"bottom": {"kind": "friction", "coefficient": 0.2, "velocity": -5.0}},
        "body.0.shape.lower": [0.3, 0.0],
        "body.0.shape.upper": [0.7, 0.4],
        "body.0.initial_stress": {"kind": "geostatic"},
        "material.linear_elastic.bulk_modulus": 1e6,
    }
    present = simulation(BLOCK, changes)
    body = present.bodies[0]
    for _ in range(400):
        present.step(2.5e-4)
    assert body.velocity[0].mean() == pytest.approx(-0.2 * 9.81 * 0.1, rel=0.05)


def test_a_velocity_of_a_smooth_wall_is_refused():
    with pytest.raises(InputError, match="a velocity belongs to kind = 'friction' or 'no_slip'"):
        simulation(BLOCK, {"boundary": {"bottom": {"kind": "free_slip", "velocity": 1.0}}})
