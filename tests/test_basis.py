"""Shape functions: consistency up to first order, their second moment, and interpolation at walls."""

import numpy as np
import pytest

from grainlaw.mpm_core.grid.grid import NO_GHOSTS
from grainlaw.mpm_core.kernels.shape_functions import (
    BASES,
    SMALLEST_MOMENT_AT_WALL,
    SMALLEST_MOMENT_OF_HATS,
    make_stencil,
)

CELLS = 6
FIRST_NODE, LAST_NODE = 2, 2 + CELLS
WALLS = (FIRST_NODE - 1, LAST_NODE + 1)
NO_WALLS = NO_GHOSTS
INSIDE = np.linspace(FIRST_NODE, LAST_NODE, 97)


def moments(name, coordinate, ghosts):
    """Sums of the weights times (node - coordinate)^k, and the second moment as the basis gives it."""
    first, f, weights, moment, _ = make_stencil(BASES[name])(coordinate, *ghosts)
    distances = first + np.arange(len(weights)) - coordinate
    assert f == pytest.approx(-distances[0])
    return [float(np.sum(weights * distances**k)) for k in range(3)], moment


@pytest.mark.parametrize("ghosts", [WALLS, NO_WALLS], ids=["walls", "no walls"])
@pytest.mark.parametrize("name", BASES)
def test_weights_reproduce_linear_fields_and_their_second_moment_is_the_one_given(name, ghosts):
    for coordinate in INSIDE:
        (sum_, first, second), given = moments(name, coordinate, ghosts)
        assert sum_ == pytest.approx(1.0, abs=1e-14)
        assert first == pytest.approx(0.0, abs=1e-14)
        smallest = SMALLEST_MOMENT_OF_HATS if name == "linear" else SMALLEST_MOMENT_AT_WALL
        assert given == pytest.approx(max(second, smallest), abs=2e-12)


@pytest.mark.parametrize(("name", "moment"), [("quadratic", 1 / 4), ("cubic", 1 / 3)])
def test_away_from_walls_the_second_moment_is_constant(name, moment):
    assert {moments(name, x, NO_WALLS)[1] for x in INSIDE} == {moment}


@pytest.mark.parametrize("name", BASES)
def test_no_weight_lies_beyond_a_wall_and_none_is_negative(name):
    for coordinate in INSIDE:
        first, _, weights, _, _ = make_stencil(BASES[name])(coordinate, *WALLS)
        for node, weight in enumerate(weights, start=int(first)):
            assert weight >= -1e-15
            if not FIRST_NODE <= node <= LAST_NODE:
                assert weight == 0.0


@pytest.mark.parametrize("name", BASES)
@pytest.mark.parametrize(("wall", "toward_inside"), [(FIRST_NODE, 1.0), (LAST_NODE, -1.0)])
def test_shape_functions_interpolate_at_walls(name, wall, toward_inside):
    first, _, weights, _, _ = make_stencil(BASES[name])(wall + toward_inside * 1e-9, *WALLS)
    assert weights[wall - int(first)] == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize("name", BASES)
def test_weights_are_continuous_across_the_change_of_stencil(name):
    def spread(coordinate):
        first, _, weights, _, _ = make_stencil(BASES[name])(coordinate, *WALLS)
        nodes = np.zeros(LAST_NODE + 3)
        nodes[int(first) : int(first) + len(weights)] = weights
        return nodes

    for border in np.arange(FIRST_NODE + 0.5, LAST_NODE, 0.5):
        np.testing.assert_allclose(spread(border - 1e-9), spread(border + 1e-9), atol=1e-8)
