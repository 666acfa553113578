"""Points that their law holds at the smallest value of a state variable are counted."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from grainlaw.materials import get_material
from grainlaw.materials.declarations import DeclarationError
from grainlaw.materials.law import check_law
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.output.bounded_points import limited
from grainlaw.mpm_core.space import PLANE_STRAIN


@pytest.mark.parametrize("name", ["modified_cam_clay", "mu_i_mcc"])
@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_points_at_the_smallest_yield_surface_are_counted(name, precision):
    law = get_material(name)
    parameters = law.parameter_sets["paper"].parameters._replace(stress_free_pressure=0.05)
    states = np.zeros((len(law.state._fields), 4), precision)
    states[law.state._fields.index("preconsolidation_pressure")] = [0.1, 0.1001, 0.08, 1e3]
    body = SimpleNamespace(
        law=law, parameters=parameters, states=states, stress=np.ones((4, 4)), count=4, positions=np.ones((2, 4))
    )
    grid = Grid(PLANE_STRAIN, (0.0, 0.0), (4, 4), 1.0)
    simulation = SimpleNamespace(bodies=[body], grid=grid, ways_bounded=0)
    assert limited(simulation)["points_at_a_bound_of_their_law"] == 2


def test_a_bound_of_what_is_no_state_variable_is_refused():
    law = replace(get_material("modified_cam_clay"), lower_bounds={"porosity": lambda parameters: 0.0})
    with pytest.raises(DeclarationError, match="'porosity', which is no state variable"):
        check_law(law)
