"""The transfers: what they conserve, what they reproduce exactly, and that neither threads nor steps leave a trace."""

import tracemalloc

import numba
import numpy as np
import pytest
from scenes_for_tests import BLOCK, COLUMN, momentum, node_mass_and_momentum, set_affine_velocity, simulation

from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.kernels.shape_functions import BASES
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.space import PLANE_STRAIN

BASIS_NAMES = list(BASES)
# A hair above no step at all: the transfers happen, the stress and the positions stay.
INSTANT = 1e-12
# The rows of velocity, L and A.
MOTION = slice(layout_of(PLANE_STRAIN).velocity, layout_of(PLANE_STRAIN).stress)
GRADIENT = [[0.3, -0.7], [1.1, -0.3]]
FILLING = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 0.8]}


def block(basis="quadratic", **changes):
    return simulation(BLOCK, {"transfer.basis": basis, **changes})


@pytest.mark.parametrize(("precision", "round_off"), [("double", 1e-12), ("single", 1e-6)])
@pytest.mark.parametrize("shape", [BLOCK["body"][0]["shape"], FILLING], ids=["free", "at walls"])
@pytest.mark.parametrize("basis", BASIS_NAMES)
def test_mass_and_momentum_reach_the_grid_whole(basis, shape, precision, round_off):
    case = block(basis, **{"body.0.shape": shape, "precision": precision})
    (body,) = case.bodies
    body.affine = np.random.default_rng(1).normal(size=(2, 2, body.count))
    body.velocity = np.random.default_rng(2).normal(size=(2, body.count))
    brought = momentum(case)
    case.step(INSTANT)
    mass, received = node_mass_and_momentum(case)
    assert mass.sum() == pytest.approx(body.count * body.point_mass, rel=round_off)
    np.testing.assert_allclose(
        received.sum(axis=(1, 2)), brought, rtol=round_off, atol=round_off * body.point_mass * body.count
    )


@pytest.mark.parametrize(("precision", "round_off"), [("double", 1e-9), ("single", 1e-4)])
@pytest.mark.parametrize("scheme", ["apic", "affine_flip"])
@pytest.mark.parametrize("basis", BASIS_NAMES)
def test_an_affine_velocity_field_survives_the_way_to_the_grid_and_back(basis, scheme, precision, round_off):
    # Walls would hold the field; the points are near them, but the walls are taken away after the scene is built.
    case = block(basis, **{"transfer.scheme": scheme, "body.0.shape": FILLING, "precision": precision})
    case.walls.clear()
    (body,) = case.bodies
    set_affine_velocity(body, (0.4, -0.2), GRADIENT)
    before = body.points[MOTION].copy()
    ids = body.ids.copy()
    case.step(INSTANT)
    order = np.argsort(ids)[body.ids]
    np.testing.assert_allclose(body.points[MOTION], before[:, order], atol=round_off)


@pytest.mark.parametrize("basis", ["quadratic", "cubic"])
def test_a_spinning_stressed_disc_keeps_momentum_and_angular_momentum(basis):
    disc = {"kind": "disc", "center": [0.5, 0.4], "radius": 0.2}
    case = block(basis, **{"body.0.shape": disc, "transfer.scheme": "apic"})
    (body,) = case.bodies
    # Drift (0.1, -0.05) and 3 rad/s about the centre of the disc.
    set_affine_velocity(body, (0.1 + 3.0 * 0.4, -0.05 - 3.0 * 0.5), [[0.0, -3.0], [3.0, 0.0]])
    body.stress = np.random.default_rng(3).normal(size=(4, body.count)) * 50.0
    # The affine field of a point carries angular momentum of its own: second moment times vorticity.
    moment = {"quadratic": 1 / 4, "cubic": 1 / 3}[basis] * case.grid.cell_size**2

    def angular_momentum():
        x, y, vx, vy = [*body.positions, *body.velocity]
        own = moment * (body.velocity_gradient[1, 0] - body.velocity_gradient[0, 1])
        return body.point_mass * float(np.sum(x * vy - y * vx + own))

    linear, angular = momentum(case), angular_momentum()
    for _ in range(200):
        case.step(1e-3)
    np.testing.assert_allclose(momentum(case), linear, rtol=1e-11)
    assert angular_momentum() == pytest.approx(angular, rel=1e-11)
    assert abs(case.ledger.internal_work) > 0.0


def final_state(threads, precision, steps=400):
    changes = {"grid.cell_size": 0.0125, "precision": precision, "body.0.velocity": [0.8, 0.0]}
    case = simulation(COLUMN, changes, threads)
    width = np.ptp(case.bodies[0].positions[0])
    for _ in range(steps):
        case.step(0.5 * case.critical_time_step())
    return case, width


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one core")
@pytest.mark.parametrize("precision", PRECISIONS)
def test_two_threads_give_the_bits_of_one(precision):
    one, width = final_state(1, precision)
    two, _ = final_state(2, precision)
    (first,), (second,) = one.bodies, two.bodies
    assert np.ptp(first.positions[0]) > 2.0 * width
    assert len(first.stripe_starts) > 6
    assert first.points.tobytes() == second.points.tobytes()
    assert first.ids.tobytes() == second.ids.tobytes()
    assert one.ledger == two.ledger


def test_single_precision_halves_what_is_kept_and_hardly_changes_the_result():
    # As long as the column falls: on the ground two runs part as two of different steps do.
    double, single = (final_state(1, precision, steps=200)[0] for precision in PRECISIONS)
    (exact,), (rounded,) = double.bodies, single.bodies
    places = [body.positions[:, np.argsort(body.ids)] for body in (exact, rounded)]
    moved = np.abs(places[1] - places[0]) / double.grid.cell_size
    assert moved.max() > 1e-9
    assert np.quantile(moved, 0.99) < 1e-4
    assert single.grid.nodes.nbytes == double.grid.nodes.nbytes // 2
    assert rounded.points.itemsize == exact.points.itemsize // 2


def test_a_step_allocates_nothing_in_proportion_to_the_points():
    case = simulation(COLUMN, {"body.0.points_per_cell": 16})
    (body,) = case.bodies
    for _ in range(3):
        case.step(1e-7)
    tracemalloc.start()
    for _ in range(5):
        case.step(1e-7)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < body.positions[0].nbytes
