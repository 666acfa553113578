"""Volumes of points tied to one another and to their room: what loose grains take on, and what is left alone."""

import numpy as np
import pytest
from scenes_for_tests import BLOCK, MU_I_LC, set_affine_velocity, simulation

from grainlaw.mpm_core.failures import LARGEST_INCREMENT
from grainlaw.mpm_core.grid.grid import COMPONENTS, GHOSTS, NODE_OVERFILL, Grid
from grainlaw.mpm_core.kernels.shape_functions import BASES, make_stencil
from grainlaw.mpm_core.kernels.volume_coupling import (
    NEARLY_FULL,
    STEPS_PER_COUPLING,
    closing_strain,
    overfill_of,
    shifting_rate,
    smoothing_share,
    smoothing_strain,
)

LOOSE = {
    "material": {"mu_i_lc": MU_I_LC},
    "body.0.material": "mu_i_lc",
    "body.0.initial_stress": {"kind": "uniform", "pressure": 100.0},
}
FILLING = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 0.8]}
INSTANT = 1e-12


def pressures(body):
    return -body.stress[:3].mean(axis=0)


@pytest.mark.parametrize("name", list(BASES))
def test_the_width_of_a_node_is_the_integral_of_its_shape_function_over_the_domain(name):
    basis, cells, fine = BASES[name], 8, 2000
    grid = Grid((0.0, 0.0), (cells, cells), 1.0, wall_node_fraction=basis.wall_node_fraction)
    stencil = make_stencil(basis)
    integrals = np.zeros(grid.shape[0])
    for coordinate in GHOSTS + (np.arange(cells * fine) + 0.5) / fine:
        first, _, weights, _, _ = stencil(coordinate, *grid.ghosts[:2])
        integrals[first : first + basis.width] += np.array(weights) / fine
    inside = slice(GHOSTS, GHOSTS + cells + 1)
    np.testing.assert_allclose(integrals[inside], grid.node_widths[0][inside], atol=1e-6)


def test_a_lattice_that_fills_the_domain_is_not_crowded():
    case = simulation(BLOCK, {**LOOSE, "body.0.shape": FILLING})
    case.step(INSTANT)
    (x, y), overfill = case.bodies[0].positions, case.bodies[0].overfill
    # Two points per cell and axis do not integrate the changed weights at a wall exactly.
    near_wall = (np.minimum(x, 1.0 - x) < 0.25) | (np.minimum(y, 0.8 - y) < 0.25)
    assert np.abs(overfill[~near_wall]).max() < 1e-9
    assert np.abs(overfill).max() < 0.03


def test_overfill_is_the_excess_of_volume_and_a_free_surface_has_none():
    assert overfill_of(1.25, 1.0) == 0.25
    assert overfill_of(0.95, 1.0) == pytest.approx(-0.05)
    assert overfill_of(NEARLY_FULL - 0.01, 1.0) == 0.0


def test_nothing_happens_at_rest():
    assert smoothing_share(0.0, 0.01) == 0.0
    assert shifting_rate(0.0, 1e-4) == 0.0


def test_pressures_move_towards_the_mean_and_points_only_close():
    assert smoothing_strain(50.0, 100.0, 1e4, 0.1) > 0.0 > smoothing_strain(150.0, 100.0, 1e4, 0.1)
    assert smoothing_strain(100.0, 100.0, 1e4, 0.1) == 0.0
    assert smoothing_strain(1.0, 1e6, 1.0, 1.0) <= 0.1
    assert closing_strain(1400.0, 1500.0, 0.5) == pytest.approx(0.5 * np.log(1500.0 / 1400.0), rel=1e-3)
    assert closing_strain(1500.0, 1400.0, 0.5) == 0.0


def test_the_pressures_of_a_sheared_block_even_out_and_its_volume_stays():
    case = simulation(BLOCK, {**LOOSE, "body.0.shape": FILLING, "transfer.time_constant": 0.01})
    (body,) = case.bodies
    body.density *= 1.0 + 1e-3 * np.random.default_rng(1).normal(size=body.count)
    volume = (body.volume).sum()
    body.velocity_gradient[0, 1] = 1e-6
    body.update_stress(1e-9)
    scatter = pressures(body).std()
    for _ in range(20):
        body.velocity_gradient[0, 1] = 5.0
        has_stress = (body.stress[0] != 0.0) | (body.stress[1] != 0.0)
        body.neighbour_mean = np.where(has_stress, pressures(body).mean(), 1000.0)
        body.update_stress(1e-3, 1e-3, 0.1)
    assert pressures(body).std() < 0.3 * scatter
    assert (body.volume).sum() == pytest.approx(volume, rel=1e-4)


def test_what_couples_volumes_bounds_no_step():
    """The strain that closes an open point is no motion: the next step has none of it, and no law is to blame."""
    case = simulation(BLOCK, {**LOOSE, "body.0.shape": FILLING, "transfer.time_constant": 1e-4})
    (body,) = case.bodies
    shear = 0.1
    set_affine_velocity(body, (0.0, 0.0), [[0.0, shear], [0.0, 0.0]])
    open_point = int(np.argmin(np.hypot(*(body.positions - 0.4))))
    body.density[open_point], body.stress[:, open_point] = 300.0, 0.0
    open_point, dt = body.ids[open_point], 1e-3
    case.step(dt)
    assert body.density[body.ids == open_point] > 300.0 * np.exp(LARGEST_INCREMENT)
    assert case.strain_rate < 1.0
    assert case.adaptive_step() == pytest.approx(case.scene.time.safety * case.critical_time_step())


def test_material_that_carries_tension_is_left_alone():
    results = []
    for mean_pressure, overfill in ((0.0, 0.0), (1e3, 0.5)):
        (body,) = simulation(BLOCK).bodies
        body.velocity_gradient[0, 1], body.neighbour_mean, body.overfill = 5.0, mean_pressure, overfill
        body.update_stress(1e-3, 1e-3, 0.1)
        results.append(np.vstack([body.stress, body.density]))
    np.testing.assert_array_equal(*results)


def test_crowded_grains_are_compressed():
    (body,) = simulation(BLOCK, LOOSE).bodies
    body.velocity_gradient[0, 1], body.overfill = 5.0, 0.2
    body.neighbour_mean = 1000.0
    before = body.density.copy()
    body.update_stress(1e-3, 1e-3, 0.0)
    assert (body.density > before).all()


@pytest.mark.parametrize(("material", "apart"), [(LOOSE, True), ({}, False)])
def test_crowded_grains_move_apart(material, apart):
    transfer = {"transfer.scheme": "apic", "transfer.spreading": True}
    case = simulation(BLOCK, {**material, **transfer, "body.0.shape": FILLING})
    case.walls.clear()
    (body,) = case.bodies
    set_affine_velocity(body, (0.0, 0.0), [[0.0, 2.0], [0.0, 0.0]])
    crowded = (np.abs(body.positions[0] - 0.5) < 0.1) & (np.abs(body.positions[1] - 0.4) < 0.1)
    body.density[crowded] *= 0.8
    case.step(INSTANT)
    assert case.grid.nodes.reshape(-1, COMPONENTS)[:, NODE_OVERFILL].max() > 0.1
    left = (np.abs(body.positions[1] - 0.4) < 0.03) & (np.abs(body.positions[0] - 0.4) < 0.03)
    before = body.positions[0, left].copy()
    dt = 1e-4
    case.steps = STEPS_PER_COUPLING
    case.step(dt)
    moved = (body.positions[0, left] - before) / dt - body.velocity[0, left]
    assert (moved < -1e-3).all() if apart else np.abs(moved).max() < 1e-6
