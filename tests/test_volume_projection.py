"""Volume projection: crowded grains are moved apart, and everything else stays where it is."""

import numpy as np
import pytest
from scenes_for_tests import BLOCK, COLUMN, MU_I_LC, changed, simulation

from grainlaw.mpm_core.grid import volume_projection
from grainlaw.mpm_core.grid.cell_volumes import SURFACE_CELLS, CellVolumes, CellWindow, WallGap, cell_volumes
from grainlaw.mpm_core.grid.volume_projection import LONGEST_WAY, project_volumes
from grainlaw.mpm_core.output.observables import interior_overfill

NO_GRAVITY, GRAVITY = (0.0, 0.0), (0.0, -9.8)
LOOSE = {"material": {"mu_i_lc": MU_I_LC}, "body.0.material": "mu_i_lc"}
LAYER = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [2.0, 1.2]}
# A layer of 20 x 12 cells with air above.
FILLED = {
    **LOOSE,
    "grid": {"cell_size": 0.1, "upper": [2.0, 2.0]},
    "body.0.shape": LAYER,
    "body.0.points_per_cell": 16,
}


def layer(changes=None):
    return simulation(BLOCK, FILLED | (changes or {}))


def project(case, times=1, gravity=NO_GRAVITY):
    return [project_volumes(case.bodies, case.grid, case.periodic_axes, gravity) for _ in range(times)]


def crowd(body, axis=0, strength=0.04):
    """Move points towards lines of a wave along an axis."""
    positions = body.positions.copy()
    positions[axis] += strength * np.sin(2.0 * np.pi * positions[axis])
    body.positions = positions


def test_a_lattice_stays_where_it_is():
    case = layer()
    before = case.bodies[0].positions.copy()
    (found,) = project(case)
    assert found.iterations == 0
    np.testing.assert_array_equal(case.bodies[0].positions, before)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_crowded_grains_are_moved_apart(axis, precision):
    case = layer({"precision": precision})
    crowd(case.bodies[0], axis)
    before = interior_overfill(case)
    project(case, 4)
    after = interior_overfill(case)
    assert before.scatter > 0.1
    assert (abs(after.mean), after.scatter) < (0.003, 0.01)
    x, y = case.bodies[0].positions
    assert min(x.min(), y.min()) > 0.0
    assert x.max() < 2.0


def test_the_projection_converges_to_the_displacement_that_undoes_a_long_wave():
    case = layer({"grid.cell_size": 0.05, "grid.upper": [2.0, 1.2]})
    lattice = case.bodies[0].positions.copy()
    crowd(case.bodies[0], strength=0.02)
    project(case, 6)
    assert np.abs(case.bodies[0].positions - lattice).max() < 0.06 * 0.02


def test_what_is_short_inside_is_drawn_together_and_nothing_is_filled_up_at_a_free_surface():
    case = layer()
    body = case.bodies[0]
    top = body.positions[1].max()
    body.density *= 1.04
    project(case, 3)
    assert interior_overfill(case).mean == pytest.approx(0.0, abs=2e-3)
    # Without the two cells below the surface, which may stay as they are.
    sunk = top - body.positions[1].max()
    assert 0.8 * 0.04 < sunk < 1.2 * 0.04


@pytest.mark.parametrize("is_lower", [True, False])
def test_air_before_a_wall_takes_out_the_cells_above_it_and_no_others_whatever_axis_the_wall_lies_across(is_lower):
    full = np.pad(np.ones((10, 7)), 1)
    is_open = np.arange(10) // 3 == 1
    near = slice(1, 1 + SURFACE_CELLS) if is_lower else slice(-1 - SURFACE_CELLS, -1)
    expected = full > 0.0
    expected[4:7, near] = False
    for axis, fill, interior in ((1, full, expected), (0, full.T, expected.T)):
        window = CellWindow((-1, -1), fill.shape, ((True, True), (True, True)), ((False, False),) * 2, ())
        found = CellVolumes(window, fill, np.zeros_like(fill), [WallGap(axis, is_lower, is_open)])
        np.testing.assert_array_equal(found.is_interior(), interior)


def test_what_is_too_much_swells_through_a_free_surface():
    case = layer()
    body = case.bodies[0]
    top = body.positions[1].max()
    body.density /= 1.04
    project(case, 3)
    assert interior_overfill(case).mean == pytest.approx(0.0, abs=2e-3)
    assert body.positions[1].max() - top == pytest.approx(0.04 * 1.2, abs=0.01)


def test_points_that_gain_height_give_it_to_the_ledger():
    case = layer()
    body = case.bodies[0]
    body.density *= 0.9
    before = body.positions[1].sum()
    (found,) = project(case, gravity=GRAVITY)
    risen = body.point_mass * 9.8 * (body.positions[1].sum() - before)
    assert found.raised == pytest.approx(risen, rel=1e-9)
    assert found.raised > 0.0


def test_across_periodic_sides_points_are_moved_as_inside(monkeypatch):
    monkeypatch.setattr(volume_projection, "TOLERANCE", 1e-9)
    periodic = {"boundary.left": "periodic", "boundary.right": "periodic"}
    places = []
    for shift in (0.0, 0.7):
        case = layer(periodic)
        body = case.bodies[0]
        crowd(body)
        positions = body.positions.copy()
        positions[0] = (positions[0] + shift) % 2.0
        body.positions = positions
        project(case)
        body.wrap(0, 0.0, 2.0)
        project(case)
        places.append(np.vstack([(body.positions[0] - shift) % 2.0, body.positions[1]]))
    np.testing.assert_allclose(places[0], places[1], atol=1e-7)


def test_material_that_carries_tension_is_left_alone_and_keeps_its_room():
    case = simulation(BLOCK, {"body.0.density": 1000.0})
    case.bodies[0].positions = case.bodies[0].positions * 0.9
    before = case.bodies[0].positions.copy()
    project(case)
    np.testing.assert_array_equal(case.bodies[0].positions, before)

    plug = {"kind": "rectangle", "lower": [1.0, 0.0], "upper": [2.0, 1.2]}
    case = simulation(
        BLOCK,
        FILLED
        | {
            "material": {"mu_i_lc": MU_I_LC, "linear_elastic": {"bulk_modulus": 1e4, "poisson_ratio": 0.2}},
            "body": [
                {"material": "mu_i_lc", "shape": {**LAYER, "upper": [1.0, 1.2]}, "density": 1500.0},
                {"material": "linear_elastic", "shape": plug, "density": 1500.0},
            ],
        },
    )
    grains, block = case.bodies
    crowd(grains)
    at = block.positions.copy()
    project(case, 4)
    np.testing.assert_array_equal(block.positions, at)
    assert grains.positions[0].max() < 1.0
    fill = cell_volumes(case.bodies, case.grid, []).fill[2:10, 1:9]
    assert np.abs(fill - 1.0).max() < 0.03


def test_two_laws_side_by_side_fill_their_room_together():
    clay = {"law": "mu_i_lc", **MU_I_LC, "static_friction": 0.3}
    case = simulation(
        BLOCK,
        FILLED
        | {
            "material": {"mu_i_lc": MU_I_LC, "other": clay},
            "body": [
                {"material": "mu_i_lc", "shape": {**LAYER, "upper": [1.0, 1.2]}, "density": 1500.0},
                {"material": "other", "shape": {**LAYER, "lower": [1.0, 0.0]}, "density": 1200.0},
            ],
        },
    )
    for body in case.bodies:
        crowd(body)
    assert interior_overfill(case).scatter > 0.1
    project(case, 4)
    assert interior_overfill(case).scatter < 0.02


def test_a_container_that_is_full_to_its_lid_is_evened_out():
    case = layer({"grid.upper": [2.0, 1.2]})
    crowd(case.bodies[0])
    case.bodies[0].density *= 0.98
    project(case, 4)
    after = interior_overfill(case)
    assert after.mean == pytest.approx(1.0 / 0.98 - 1.0, abs=2e-3)
    assert after.scatter < 0.02


def test_no_face_is_moved_far_and_those_that_would_be_are_counted():
    case = layer()
    case.bodies[0].density *= 0.5
    before = case.bodies[0].positions.copy()
    (found,) = project(case)
    moved = np.abs(case.bodies[0].positions - before)
    assert found.bounded > 0
    assert moved.max() <= LONGEST_WAY * 0.1 * (1.0 + 1e-9)
    assert found.longest_way == pytest.approx(np.hypot(*(case.bodies[0].positions - before)).max())


def test_a_run_projects_by_drift_and_not_at_rest(monkeypatch):
    counted = []
    monkeypatch.setattr(
        "grainlaw.mpm_core.simulation.project_volumes",
        lambda *arguments: counted.append(arguments) or project_volumes(*arguments),
    )
    falling = simulation(COLUMN, {"time.end": 0.1})
    falling.advance_to(0.1)
    fast = len(counted)
    counted.clear()
    halved = simulation(COLUMN, {"time.end": 0.1, "time.safety": 0.2})
    halved.advance_to(0.1)
    assert fast > 0
    assert len(counted) == pytest.approx(fast, abs=1)
    counted.clear()
    resting = simulation(changed(COLUMN, {"body.0.shape.lower": [0.0, 0.0], "body.0.shape.upper": [3.2, 0.5]}))
    resting.advance_to(0.1)
    assert counted == []


def test_it_can_be_switched_off():
    case = simulation(COLUMN, {"transfer.volume_projection": False})
    case.advance_to(0.1)
    assert case.ledger.volume_projection == 0.0
