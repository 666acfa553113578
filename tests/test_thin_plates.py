"""Obstacles too thin for the grid: what parts two fills, what is refused, and what is told of later."""

import warnings

import pytest
from scenes_for_tests import MU_I_LC, simulation

from grainlaw.materials import InputError
from grainlaw.materials.errors import InputWarning

SAND = {
    "gravity": [0.0, 0.0],
    "grid": {"cell_size": 0.025, "upper": [0.5, 0.5]},
    "time": {"end": 0.2},
    "boundary": {"bottom": {"kind": "friction", "coefficient": 0.5}},
    "material": {"mu_i_lc": MU_I_LC},
}


def parted(thickness, room=0.0, velocities=((0.0, 0.0), (1.0, 0.0))):
    """Sand below and above a plate of some cells without gravity, some room away from it."""
    low, high = 0.25 - 0.0125 * thickness, 0.25 + 0.0125 * thickness
    corners = (([0.1, low - room - 0.1], [0.4, low - room]), ([0.1, high + room], [0.4, high + room + 0.1]))
    bodies = [
        {
            "material": "mu_i_lc",
            "density": 1500.0,
            "shape": {"kind": "rectangle", "lower": lower, "upper": upper},
            "velocity": list(velocity),
        }
        for (lower, upper), velocity in zip(corners, velocities, strict=True)
    ]
    shape = {"kind": "line", "points": [[-0.1, 0.25], [0.6, 0.25]], "thickness": 0.025 * thickness}
    plate = {"name": "plate", "friction": 0.3, "shape": shape}
    return simulation(SAND | {"body": bodies, "obstacle": [plate]})


def test_a_plate_of_three_cells_parts_two_fills_and_a_thinner_one_is_refused():
    case = parted(3.0)
    case.advance_to(0.02)
    below, above = (float(body.velocity[0].mean()) for body in case.bodies)
    assert below == pytest.approx(0.0, abs=1e-12)
    assert above == pytest.approx(1.0, rel=1e-9)
    with pytest.raises(
        InputError, match=r"'plate' is 0.05 m thick, 2 cells: .*; allowed: 0.075 m or more, or cells of"
    ):
        parted(2.0)


def test_a_thin_plate_is_told_of_when_material_has_come_to_both_sides_and_not_before():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        one_sided = parted(0.8, room=0.05, velocities=((0.0, 1.0), (0.0, 0.0)))
        one_sided.advance_to(0.08)
        case = parted(0.8, room=0.05, velocities=((0.0, 1.0), (0.0, -1.0)))
        case.advance_to(0.02)
    with pytest.warns(InputWarning, match=r"both sides .* 'plate' is 0.02 m thick, 0.8 cells; what would do: 0.075 m"):
        case.advance_to(0.08)
