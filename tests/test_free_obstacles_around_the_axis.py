"""Free obstacles in axisymmetry: their mass per radian, and the momentum that they give to the material."""

import math

import numpy as np
import pytest
from scenes_for_tests import MU_I_LC, simulation

from grainlaw.materials import InputError

BED = {
    "space": "axisymmetric",
    "grid": {"cell_size": 0.025, "upper": [0.5, 0.7]},
    "gravity": [0.0, 0.0],
    "time": {"end": 1.0},
    "material": {"mu_i_lc": MU_I_LC},
    "body": [
        {
            "material": "mu_i_lc",
            "density": 1500.0,
            "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.5, 0.3]},
        }
    ],
}
DENSITY, SPEED = 4000.0, 2.0


def dropped(shape, **free):
    """A bed without gravity, towards whose middle an obstacle flies."""
    free = {"density": DENSITY, "velocity": [0.0, -SPEED], **free}
    case = simulation(BED, {"obstacle": [{"name": "it", "friction": 0.3, "shape": shape, "free": free}]})
    return case, case.obstacles.all[0]


def swept_by_disc(center, radius):
    """The integral of r over the part of a disc at r > 0, by its chords."""
    r = np.linspace(max(0.0, center - radius), center + radius, 200_001)
    return np.trapezoid(2.0 * r * np.sqrt(np.maximum(radius**2 - (r - center) ** 2, 0.0)), r)


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        ({"kind": "disc", "center": [0.0, 0.5], "radius": 0.1}, 2.0 / 3.0 * 0.1**3),
        ({"kind": "disc", "center": [0.3, 0.5], "radius": 0.1}, 0.3 * math.pi * 0.1**2),
        ({"kind": "disc", "center": [0.04, 0.5], "radius": 0.1}, swept_by_disc(0.04, 0.1)),
        ({"kind": "disc", "center": [-0.04, 0.5], "radius": 0.1}, swept_by_disc(-0.04, 0.1)),
        ({"kind": "rectangle", "lower": [-0.1, 0.4], "upper": [0.2, 0.5]}, 0.5 * 0.2**2 * 0.1),
        ({"kind": "polygon", "vertices": [[-0.2, 0.6], [0.0, 0.4], [0.2, 0.6]]}, 0.2**3 / 6.0),
    ],
)
def test_the_mass_per_radian_is_of_what_the_section_sweeps_around_the_axis(shape, volume):
    _, obstacle = dropped(shape)
    assert obstacle.motion.mass == pytest.approx(DENSITY * volume, rel=1e-6)


def test_a_mass_is_taken_as_it_is_given():
    _, obstacle = dropped({"kind": "disc", "center": [0.0, 0.5], "radius": 0.1}, density=None, mass=2.5)
    assert obstacle.motion.mass == pytest.approx(2.5)


@pytest.mark.parametrize("given", [{}, {"density": None, "mass": 2.5}])
def test_an_obstacle_beyond_the_axis_lies_outside(given):
    with pytest.raises(InputError, match=r"obstacle.0 \('it'\) lies outside the domain"):
        dropped({"kind": "disc", "center": [-0.5, 0.5], "radius": 0.1}, **given)


def test_a_ball_loses_the_momentum_that_the_sand_and_the_floor_get():
    radius = 0.1
    case, ball = dropped({"kind": "disc", "center": [0.0, 0.41], "radius": radius})
    mass = 2.0 / 3.0 * radius**3 * DENSITY
    # the waves have not come to the floor yet
    case.advance_to(0.01)
    (body,) = case.bodies
    taken = -float((body.masses * body.velocity[1]).sum())
    lost = mass * (SPEED + ball.motion.pose.velocity[1])
    assert lost > 0.01 * mass * SPEED
    assert taken == pytest.approx(lost, rel=0.02)
