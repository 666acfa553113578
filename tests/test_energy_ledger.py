"""The parts of the ledger: elastic energy comes back, friction is Coulomb's, flow dissipates."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes_for_tests import BLOCK, COLUMN, simulation
from test_walls import G, block_on_a_plane

from grainlaw.mpm_core.kernels.elastic_energy import elastic_energy

# Strains of the bar are a thousandth, the share by which elasticity in rate form misses an energy.
SPEED = 0.005


def parts(case):
    """Kinetic, elastic and inelastic energy at the end of the step."""
    elastic = case.elastic_energy()
    return case.ledger.kinetic_at_end, elastic, case.ledger.inelastic_work(elastic)


def bar(law, parameters):
    """A bar held at its left end, thrown into its first mode, and the energy that it starts with."""
    case = simulation(
        BLOCK,
        {
            "material": {law: parameters},
            "body.0.material": law,
            "body.0.shape": {"kind": "rectangle", "lower": [0.0, 0.2], "upper": [0.6, 0.4]},
            "transfer.time_constant": 10.0,
        },
    )
    (body,) = case.bodies
    phase = 0.5 * np.pi * body.positions[0] / 0.6
    body.velocity[0] = SPEED * np.sin(phase)
    body.velocity_gradient[0, 0] = body.affine[0, 0] = SPEED * 0.5 * np.pi / 0.6 * np.cos(phase)
    squares = (body.velocity**2).sum() + 0.25 * case.grid.cell_size**2 * (body.affine**2).sum()
    case.ledger.kinetic = case.ledger.initial_kinetic = 0.5 * body.point_mass * float(squares)
    return case, case.ledger.initial_kinetic


@pytest.mark.parametrize("law", ["linear_elastic", "neo_hookean"])
def test_an_oscillating_bar_keeps_kinetic_and_elastic_energy_but_for_the_numerical_dissipation(law):
    case, start = bar(law, {"bulk_modulus": 1e4, "poisson_ratio": 0.2})
    largest, worst = 0.0, 0.0
    while case.time < 0.6:
        case.step(0.05 * case.critical_time_step())
        kinetic, elastic, inelastic = parts(case)
        largest = max(largest, elastic / start)
        worst = max(worst, abs(inelastic) / start)
        assert kinetic + elastic + case.ledger.numerical_dissipation == pytest.approx(start, rel=1e-3)
    assert largest > 0.95
    assert worst < 1e-3


def test_a_block_that_bounces_under_gravity_exchanges_three_energies():
    case = simulation(
        BLOCK,
        {
            "gravity": [0.0, -G],
            "body.0.shape": {"kind": "rectangle", "lower": [0.3, 0.0], "upper": [0.7, 0.4]},
            "body.0.initial_stress": {"kind": "none"},
            "material.linear_elastic.bulk_modulus": 1e6,
        },
    )
    released, largest = 0.0, 0.0
    while case.time < 0.2:
        case.step(0.1 * case.critical_time_step())
        ledger, (kinetic, elastic, inelastic) = case.ledger, parts(case)
        released, largest = max(released, -ledger.potential), max(largest, elastic)
        assert abs(inelastic) < 5e-3 * released
        total = (
            kinetic + ledger.potential + ledger.rise_to_come + elastic + ledger.wall_work + ledger.numerical_dissipation
        )
        assert abs(total) < 5e-3 * released
    assert largest > 0.5 * released


def test_the_friction_of_a_sliding_block_is_that_of_coulomb():
    """A rigid one; a softer one shakes, and its bottom slides less where it presses more (0.6 % at 1 MPa)."""
    angle, friction = 30.0, 0.3
    case = block_on_a_plane(angle, friction, bulk_modulus=1e7)
    (body,) = case.bodies
    body.stress[3] = -friction * body.stress[1]
    case.ledger.initial_elastic = case.elastic_energy()
    start = float(body.positions[0].mean())
    while case.time < 0.3:
        case.step(0.2 * case.critical_time_step())
    distance = float(body.positions[0].mean()) - start
    force = friction * body.count * body.point_mass * G * math.cos(math.radians(angle))
    assert distance > 0.1
    assert case.ledger.wall_friction == pytest.approx(force * distance, rel=5e-3)
    assert case.ledger.wall_work == pytest.approx(case.ledger.wall_friction, rel=5e-3)


def test_a_wall_that_slides_dissipates_by_its_sliding_and_does_work():
    case = simulation(
        BLOCK,
        {
            "gravity": [0.0, -G],
            "boundary.bottom": {"kind": "friction", "coefficient": 0.3, "velocity": 1.0},
            "body.0.shape": {"kind": "rectangle", "lower": [0.3, 0.0], "upper": [0.7, 0.1]},
            "body.0.initial_stress": {"kind": "geostatic", "horizontal_ratio": 0.0, "out_of_plane_ratio": 0.2},
        },
    )
    while case.time < 0.1:
        case.step(0.2 * case.critical_time_step())
    (body,) = case.bodies
    ledger, mass = case.ledger, body.count * body.point_mass
    speed = float(body.velocity[0].mean())
    assert speed == pytest.approx(0.3 * G * 0.1, rel=0.1)
    # The floor slides by 1 m/s t less the path of the block; what it gives becomes heat or moves the block.
    assert ledger.wall_friction == pytest.approx(0.3 * mass * G * (0.1 - 0.5 * speed * 0.1), rel=0.05)
    # What the floor gives moves the block, strains it and lifts its middle.
    assert ledger.kinetic == pytest.approx(0.5 * mass * speed**2, rel=0.05)
    assert ledger.wall_work == pytest.approx(-(ledger.kinetic + ledger.internal_work + ledger.potential), rel=0.02)


def test_a_collapse_dissipates_more_and_more_by_plastic_flow():
    case = simulation(COLUMN, {"material.mu_i_lc.bulk_modulus": 2e5})
    found = []
    while case.time < 0.3:
        case.step(0.4 * case.critical_time_step())
        found.append(parts(case)[2])
    released = -case.ledger.potential
    assert found[-1] > 0.2 * released
    assert min(np.diff(found)) > -1e-4 * released


def test_a_law_without_energy_leaves_the_columns_undefined():
    case = simulation(BLOCK)
    (body,) = case.bodies
    assert elastic_energy(body) == 0.0
    body.law = replace(body.law, stored_energy=None)
    assert math.isnan(case.elastic_energy())
    assert math.isnan(case.ledger.inelastic_work(case.elastic_energy()))
