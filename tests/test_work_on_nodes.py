"""The work of the forces on the nodes: what moves them, exactly; and the energy that is made, by it."""

import math

import numpy as np
import pytest
from scenes_for_tests import BLOCK, CUBE, RING, changed, simulation
from test_energy_ledger import bar

from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.held_nodes import nodes_where
from grainlaw.mpm_core.ledger import Ledger
from grainlaw.mpm_core.space import PLANE_STRAIN
from grainlaw.validation.cases.spaces.every_law import column, subject_of

ROUGH_FLOOR = {"boundary.bottom": {"kind": "friction", "coefficient": 0.3}}
FLAT = changed(
    BLOCK, {"gravity": [1.0, -9.81], "body.0.shape": {"kind": "rectangle", "lower": [0, 0], "upper": [1, 0.4]}}
)
SHELF = {"name": "shelf", "friction": 0.3, "shape": {"kind": "rectangle", "lower": [-0.1, 0.0], "upper": [1.1, 0.2]}}
SCENES = {
    "plane strain": (FLAT, ROUGH_FLOOR),
    "axisymmetric": (RING, ROUGH_FLOOR),
    "3d": (CUBE, ROUGH_FLOOR),
    "periodic": (FLAT, ROUGH_FLOOR | {"boundary.left": "periodic", "boundary.right": "periodic"}),
    "periodic 3d": (CUBE, ROUGH_FLOOR | {"body.0.shape.lower": [0.3, 0.0, 0.0], "body.0.shape.upper": [0.7, 0.8, 0.4],
                                         "boundary.front": "periodic", "boundary.back": "periodic"}),
    "periodic along the columns": (FLAT, {"body.0.shape.lower": [0.0, 0.0], "body.0.shape.upper": [0.4, 0.8],
                                          "boundary.bottom": "periodic", "boundary.top": "periodic",
                                          "boundary.left": "no_slip", "body.0.velocity": [-1.0, 0.0]}),
    "obstacle": (FLAT, {"body.0.shape.lower": [0.0, 0.2], "obstacle": [SHELF]}),
}  # fmt: skip


def each_node_once(case, numbers):
    """Those of numbers of the nodes that belong to a counted node, shape (n, components)."""
    counted, rows = case.grid.counted, np.arange(case.grid.shape[-1])
    of_rows = (counted.first_row <= rows) & (rows < counted.row_behind)
    return numbers.reshape(-1, COMPONENTS)[np.outer(counted.columns, of_rows).ravel()].astype(float)


def shaken(content, changes):
    """A scene some steps after its points were set in motion at random."""
    case = simulation(content, changes)
    rng = np.random.default_rng(0)
    (body,) = case.bodies
    body.velocity[:] = rng.normal(scale=0.3, size=body.velocity.shape)
    for _ in range(3):
        case.step(0.4 * case.critical_time_step())
    return case


def grid_update(case, dt):
    """The first half of a step: the nodes before and after it, and what the ledger counts."""
    case._clear_nodes(False)
    case._p2g()
    before = each_node_once(case, case.grid.nodes.copy())
    ledger = case.ledger
    start = np.array([ledger.work_on_nodes, ledger.wall_work, ledger.obstacle_work])
    case._update_grid(dt, False)
    counted = np.array([ledger.work_on_nodes, ledger.wall_work, ledger.obstacle_work]) - start
    return before, each_node_once(case, case.grid.nodes), counted


def split(case, nodes):
    """Mass of the nodes that have any, and two vectors of each: momentum and force, or new and old velocity."""
    of_node, axes = case.grid.components, case.space.axes
    nodes = nodes[nodes[:, of_node.mass] > 0.0]
    vectors = (nodes[:, first : first + axes] for first in (of_node.momentum, of_node.force))
    return nodes[:, of_node.mass], *vectors


ROUND_OFF = {"double": 1e-13, "single": 1e-6}


@pytest.mark.parametrize(
    ("name", "precision"), [*((name, "double") for name in SCENES), ("plane strain", "single"), ("3d", "single")]
)
def test_nodes_gain_in_a_step_what_forces_give_and_walls_and_obstacles_leave(name, precision):
    content, changes = SCENES[name]
    case = shaken(content, changes | {"precision": precision})
    _, after, (work, by_walls, by_obstacles) = grid_update(case, 0.3 * case.critical_time_step())
    mass, new, old = split(case, after)
    gained, kinetic = (0.5 * (mass[:, None] * squares).sum() for squares in (new**2 - old**2, new**2))
    assert abs(work) > 1e-3 * kinetic
    assert abs(by_obstacles if name == "obstacle" else by_walls) > 1e-3 * kinetic
    assert gained == pytest.approx(work - by_walls - by_obstacles, abs=ROUND_OFF[precision] * kinetic)


def on_the_floor():
    return shaken(FLAT, {"body.0.shape.lower": [0.2, 0.0], "body.0.shape.upper": [0.8, 0.4], **ROUGH_FLOOR})


def half_asleep():
    case = shaken(BLOCK, {"gravity": [0.0, -9.81], "sleep": {"speed": 1e-9}})
    (body,) = case.bodies
    body.divide(body.positions[0] > 0.5)
    case._sort()
    case.sleep.bring_sleepers()
    return case


def with_held_nodes():
    case = shaken(BLOCK, {"gravity": [0.0, -9.81], "boundary.left": "periodic", "boundary.right": "periodic"})
    case.held_nodes = nodes_where(case.grid, lambda x, y: (np.abs(x - 0.5) < 0.15) & (y < 0.35))
    return case


@pytest.mark.parametrize("make", [on_the_floor, half_asleep, with_held_nodes])
def test_forces_work_at_the_mean_velocity_that_what_holds_the_nodes_leaves(make):
    """Each node is held by one thing only: the impulse of its forces times the mean of its velocities, exactly."""
    case = make()
    dt = 0.3 * case.critical_time_step()
    before, after, (work, _, _) = grid_update(case, dt)
    mass, momentum, force = split(case, before)
    _, new, old = split(case, after)
    impulse = 0.5 * (case.last_step + dt) * (force + mass[:, None] * case.scene.gravity)
    unheld = old + impulse / mass[:, None]
    assert not np.allclose(unheld, new, rtol=0.0, atol=1e-3 * np.abs(new).max())
    assert momentum == pytest.approx(mass[:, None] * old)
    exact = 0.5 * impulse * (old + new)
    assert work == pytest.approx(exact.sum(), abs=1e-13 * np.abs(exact).sum())


def test_a_viscous_law_dissipates_more_at_its_points_than_its_nodes_lose_and_makes_nothing():
    case = simulation(column(subject_of("mu_i_lc_viscous"), PLANE_STRAIN))
    case.advance_to(0.05 * case.scene.time.end)
    assert case.ledger.numerical_dissipation < -0.01 * case.ledger.released
    assert case.ledger.made(case.elastic_energy()) == 0.0
    assert case.ledger.made(math.nan) == -case.ledger.numerical_dissipation


def test_steps_beyond_the_stable_one_make_energy_that_no_transfer_gives():
    case, start = bar("linear_elastic", {"bulk_modulus": 1e4, "poisson_ratio": 0.2})
    for _ in range(10):
        case.step(1.5 * case.critical_time_step())
    assert case.ledger.transfer_dissipation > 0.0
    assert case.ledger.made(case.elastic_energy()) > 10.0 * start


def test_what_points_store_without_work_is_made_by_their_law_and_what_nodes_did_not_pay_is_made_by_the_method():
    ledger = Ledger(kinetic=0.0, initial_kinetic=0.0, initial_elastic=1.0)
    assert ledger.made(2.0) == 0.0
    ledger.internal_work = 0.75
    assert ledger.made(2.0) == 0.75
    assert ledger.made(1.5) == 0.5
    ledger.kinetic = 0.25
    assert ledger.made(1.5) == 0.75
