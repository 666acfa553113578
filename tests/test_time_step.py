"""What bounds a step: the stability of a single point, contact, strain, and a floor at which runs stop."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, ELASTIC, simulation

from grainlaw.materials import InputError, SimulationError, get_material
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, THREE_D
from grainlaw.mpm_core.stepping.run import run
from grainlaw.mpm_core.stepping.time_step import LARGEST_STRAIN, SMALLEST_SHARE, signal_bounds


def growth(poisson_ratio, share, place, steps=24):
    """By how much a dilation of a single point grows over steps of a share of the stable one."""
    case = simulation(
        BLOCK,
        {
            "material.linear_elastic.poisson_ratio": poisson_ratio,
            "body.0.points_per_cell": 1,
            "body.0.shape": {"kind": "rectangle", "lower": [0.4, 0.4], "upper": [0.5, 0.5]},
            "transfer.time_constant": 1e6,
        },
    )
    (body,) = case.bodies
    body.positions = 0.4 + 0.1 * np.array(place)[:, None]
    body.velocity_gradient = body.affine = 1e-6 * np.eye(2)[:, :, None]
    dt = share * case.critical_time_step()
    energies = []
    for _ in range(steps):
        case.step(dt)
        energies.append(case.ledger.kinetic + case.elastic_energy())
    return max(energies[-6:]) / max(energies[:6])


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.2, 0.3, 0.45])
@pytest.mark.parametrize("place", [(0.5, 0.5), (0.13, 0.4)])
def test_the_stable_step_is_the_limit_of_a_single_point(poisson_ratio, place):
    assert growth(poisson_ratio, 0.99, place) < 2.0
    assert growth(poisson_ratio, 1.05, place) > 1e6


def test_the_grid_is_stiffer_than_a_wave_by_what_the_law_says():
    def bounds(name, parameters, space=PLANE_STRAIN):
        law = get_material(name)
        parameters = law.parameters(*parameters)
        return signal_bounds(SimpleNamespace(law=law, parameters=parameters, initial_density=1000.0, space=space))

    for ratio, expected in ((0.0, 1.0), (0.2, 1.25), (0.3, 10.0 / 7.0)):
        found = bounds("linear_elastic", (1e6, ratio))
        assert found.wave_factor**2 == pytest.approx(expected, rel=1e-6)
        assert found.contact_speed == 0.0
    for space, stiffest in ((PLANE_STRAIN, 2.0), (AXISYMMETRIC, 3.0), (THREE_D, 3.0)):
        assert bounds("newtonian", (1.0, 1e5), space).wave_factor == pytest.approx(stiffest**0.5)


def oscillation(viscosity, bulk_modulus, share, steps=40):
    """By how much the shear of a single point of fluid under pressure grows over steps of a share of the stable one."""
    case = simulation(
        BLOCK,
        {
            "material": {"newtonian": {"viscosity": viscosity, "bulk_modulus": bulk_modulus}},
            "body.0.material": "newtonian",
            "body.0.points_per_cell": 1,
            "body.0.shape": {"kind": "rectangle", "lower": [0.4, 0.4], "upper": [0.5, 0.5]},
            "body.0.initial_stress": {"kind": "uniform", "pressure": 1e-3 * bulk_modulus},
            "transfer.time_constant": 1e6,
        },
    )
    case.bodies[0].velocity_gradient = case.bodies[0].affine = 1e-2 * np.array([[0.0, 1.0], [1.0, 0.0]])[:, :, None]
    case.step(1e-12)
    energies = []
    for _ in range(steps):
        case.step(share * case.critical_time_step())
        energies.append(case.ledger.kinetic)
    return energies[-1] / energies[0]


def test_a_viscosity_bounds_the_step():
    """Of a fluid without volume viscosity, the limit of a point is 4/3 of the stable step of a grid."""
    assert oscillation(1e4, 1e2, 0.99) < 1.0
    assert oscillation(1e4, 1e2, 1.5) > 1e4


def test_a_law_may_say_that_its_viscosity_bounds_no_step():
    """Near rest mu_i_lc_viscous would ask for steps of rho h^2 alpha/(mu_0 p)."""
    law = get_material("mu_i_lc_viscous")
    parameters = law.parameter_sets["paper"].parameters
    changes = {
        "material": {law.name: parameters._asdict()},
        "body.0.material": law.name,
        "body.0.initial_stress": {"kind": "uniform", "pressure": 1e3},
    }
    speed = simulation(BLOCK, changes).signal_speed
    assert speed < 2.0 * (parameters.bulk_modulus / 1000.0) ** 0.5


def cloud(speed, changes=None):
    """A stress-free block of Cam Clay that closes in on its centre."""
    case = simulation(
        BLOCK,
        {"material": {"modified_cam_clay": CAM_CLAY}, "body.0.material": "modified_cam_clay", **(changes or {})},
    )
    (body,) = case.bodies
    body.velocity = -speed * (body.positions - np.array([[0.5], [0.4]]))
    body.velocity_gradient[0, 0] = body.velocity_gradient[1, 1] = -speed
    case.measure_signals()
    return case


def test_open_material_that_nothing_moves_stays_where_it_is():
    case = cloud(0.0)
    assert 0.0 < case.critical_time_step() < 1.0
    (body,) = case.bodies
    places = body.positions.copy()
    while case.time < 0.1:
        dt, _ = case.next_step(0.1)
        case.step(dt)
    # At the edge of contact Cam Clay starts with its smallest pressure, 1 Pa.
    np.testing.assert_allclose(body.positions[:, np.argsort(body.ids)], places, atol=1e-4)


def test_a_step_strains_no_point_by_more_than_the_largest_strain():
    case = cloud(5.0)
    assert case.adaptive_step() == pytest.approx(LARGEST_STRAIN / 10.0)
    assert case.adaptive_step() < 0.4 * case.critical_time_step()


def test_the_smallest_step_follows_from_the_first():
    case = simulation(BLOCK)
    assert case.smallest_step == pytest.approx(SMALLEST_SHARE * case.adaptive_step())
    assert simulation(BLOCK, {"time.smallest_step": 1e-6}).smallest_step == 1e-6


def test_a_run_that_would_have_to_step_below_the_smallest_step_says_why():
    case = simulation(BLOCK)
    (body,) = case.bodies
    body.velocity[0, 17] = 1e8
    case.measure_signals()
    with pytest.raises(SimulationError) as error:
        case.next_step(0.1)
    assert re.search(
        rf"point {body.ids[17]} of body\.0 \(linear_elastic\) at \(\S+, \S+\) m: the step would have to shrink to "
        r"\S+ s, below the smallest one, \S+ s \(time\.smallest_step\): sound speed 4\.47 m/s, speed 1e\+08 m/s",
        str(error.value),
    )
    body.velocity[0, 17] = 0.0
    body.velocity_gradient[0, 0, 3] = -1e7
    case.measure_signals()
    with pytest.raises(SimulationError, match=rf"point {body.ids[3]} of .*volumetric strain rate 1e\+07 1/s"):
        case.next_step(0.1)


def test_a_smallest_step_above_the_first_is_refused(tmp_path):
    scene = Scene.from_dict(BLOCK | {"time": {"end": 0.1, "smallest_step": 0.05}}, "block.toml")
    with pytest.raises(
        InputError, match=r"block\.toml: time\.smallest_step = 0\.05 s is above the first step, 0\.00\d+"
    ):
        run(scene, tmp_path / "run")


def test_the_limit_of_a_soft_solid_does_not_depend_on_its_modulus():
    steps = [
        simulation(BLOCK, {"material.linear_elastic": ELASTIC | {"bulk_modulus": modulus}}).critical_time_step()
        for modulus in (1e4, 4e4)
    ]
    assert steps[0] == pytest.approx(2.0 * steps[1], rel=1e-9)
