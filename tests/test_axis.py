"""Material next to the axis of axisymmetry: what stretches it there, and points that come close to the axis."""

import numpy as np
import pytest
from scenes_for_tests import ELASTIC, simulation

# Two columns of points, the inner one nearest to the axis, in a space where nothing else moves them.
DISC = {
    "title": "disc",
    "space": "axisymmetric",
    "gravity": [0.0, 0.0],
    "grid": {"cell_size": 0.1, "upper": [0.5, 0.6]},
    "time": {"end": 1.0},
    "transfer": {"time_constant": 1e3},
    "material": {"linear_elastic": ELASTIC},
    "body": [
        {
            "material": "linear_elastic",
            "shape": {"kind": "rectangle", "lower": [0.0, 0.2], "upper": [0.05, 0.4]},
            "density": 1000.0,
        }
    ],
}


def column_at(radius):
    """A single column of points at a radius [m], that moves by chance."""
    moved = simulation(DISC)
    (body,) = moved.bodies
    assert body.count == 4
    body.points[body.layout.mass] *= radius / body.positions[0]
    body.positions = np.array([np.full(body.count, radius), body.positions[1]])
    body.velocity = 1e-4 * np.random.default_rng(0).uniform(-1.0, 1.0, body.velocity.shape)
    return moved


@pytest.mark.parametrize("cells", [1e-6, 0.01, 0.05, 0.08, 0.2])
def test_a_lone_column_next_to_the_axis_holds_at_the_default_step(cells):
    moved = column_at(0.1 * cells)
    (body,) = moved.bodies
    start = 0.5 * float((body.masses * body.speed**2).sum())
    for _ in range(300):
        moved.step(moved.adaptive_step())
    assert moved.ledger.kinetic_at_end + moved.elastic_energy() < 1.01 * start


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.1])
def test_a_lone_point_in_the_corner_of_axis_and_wall_holds_at_the_default_step(poisson_ratio):
    corner = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.1, 0.1]}
    alone = simulation(
        DISC,
        {
            "material.linear_elastic.poisson_ratio": poisson_ratio,
            "body.0.shape": corner,
            "body.0.points_per_cell": 1,
        },
    )
    (body,) = alone.bodies
    assert body.count == 1
    # where the stiffness of a point over the bound is largest
    place = np.array([[0.0054], [0.0412 if poisson_ratio == 0.0 else 0.0054]])
    body.points[body.layout.mass] *= place[0] / body.positions[0]
    body.positions = place
    body.velocity = np.array([[1e-5], [1e-5]])
    start = 0.5 * float((body.masses * body.speed**2).sum())
    for _ in range(300):
        alone.step(alone.adaptive_step())
    # so near to its limit an oscillation swells and ebbs, but does not grow
    assert alone.ledger.kinetic_at_end + alone.elastic_energy() < 10.0 * start


def test_a_point_on_the_axis_is_not_stretched_around_it():
    moved = column_at(0.1)
    (body,) = moved.bodies
    body.positions = np.array([np.array([0.0, 0.1, 0.1, 0.1]), body.positions[1]])
    moved.step(1e-6)
    around = body.points[body.layout.hoop_gradient]
    on_axis = np.isclose(body.positions[0], 0.0)
    assert np.count_nonzero(on_axis) == 1
    assert around[on_axis] == 0.0
    assert np.isfinite(body.points).all()
