"""Bands: quantiles that hold what they say, parameters and numerics told apart, members of a prediction."""

import numpy as np
import pytest

from grainlaw.materials import InputError, get_material
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.studies.bands import REACH, band, numerical_spread
from grainlaw.studies.draws import Draws
from grainlaw.studies.ensemble import SHIFTS, drawn_members, numerical_members, plan
from grainlaw.studies.predict import check_samples

NOTHING = numerical_spread(np.zeros(1), None, None, [])


@pytest.mark.parametrize("draws", [19, 64])
def test_band_of_draws_holds_another_draw_in_ninety_percent_of_cases(draws):
    """For any number of draws: exact for the k-th of n standing for k/(n + 1)."""
    random = np.random.default_rng(2)
    values = random.normal(size=(draws + 1, 4000))
    share = band(values[:-1], numerical_spread(np.zeros(4000), None, None, [])).holds(values[-1]).mean()
    assert share == pytest.approx(0.9, abs=0.015)


def test_numerical_variance_is_the_sum_of_what_was_varied():
    places = [np.array([value]) for value in (1.0, 2.0, 3.0, 4.0)]
    found = numerical_spread(np.array([2.0]), np.array([2.3]), np.array([1.6]), places)
    assert [found.cell[0], found.step[0], found.place[0]] == pytest.approx([0.09, 0.16, 5.0 / 3.0])
    assert found.variance[0] == pytest.approx(0.09 + 0.16 + 5.0 / 3.0)


def test_numerics_alone_give_their_normal_band_and_no_share_of_parameters():
    draws = np.full((19, 1), 5.0)
    found = band(draws, numerical_spread(np.array([5.0]), np.array([5.3]), None, []))
    assert (found.upper[0] - 5.0, 5.0 - found.lower[0]) == pytest.approx((REACH * 0.3, REACH * 0.3))
    assert found.share_of_parameters[0] == 0.0
    assert np.isnan(band(draws, NOTHING).share_of_parameters[0])


def test_both_parts_add_in_quadrature_and_heights_stay_positive():
    draws = np.linspace(0.0, 2.0, 41)[:, None]
    alone = band(draws, NOTHING)
    both = band(draws, numerical_spread(np.array([1.0]), np.array([3.0]), None, []), least=0.0)
    assert both.upper[0] - 1.0 == pytest.approx(np.hypot(alone.upper[0] - 1.0, REACH * 2.0))
    assert (both.lower[0], both.drawn_lower[0]) == (0.0, pytest.approx(alone.lower[0]))
    assert both.share_of_parameters[0] == pytest.approx(draws.var(ddof=1) / (draws.var(ddof=1) + 4.0))


def test_members_differ_from_the_scene_in_one_thing_each():
    scene = Scene.load(shipped_scenes()["dem_column"], {"grid.cell_size": 0.025})
    members = {
        member.name: Scene.from_dict(dict(member.scene))
        for member in numerical_members(plan(scene, get_material("mu_i_lc")))
    }
    base = members.pop("estimate")
    assert len(members) == 6
    assert members["half-cells"].grid.cell_size == 0.0125
    assert members["half-steps"].time.safety == 0.2
    lattice = build_bodies(base)[0].positions
    for number, shift in enumerate(SHIFTS, start=1):
        moved = build_bodies(members[f"place-{number}"])[0].positions
        assert moved[0] - lattice[0] == pytest.approx(shift * 0.0125)
        assert moved[1] == pytest.approx(lattice[1])


def test_parameters_of_the_calibration_hold_in_the_scene():
    scene = Scene.load(shipped_scenes()["dem_column"])
    content = plan(scene, get_material("mu_i_lc"), {"static_friction": 0.4}).with_parameters({"dynamic_friction": 0.7})
    material = content["material"]["mu_i_lc"]
    assert (material["static_friction"], material["dynamic_friction"]) == (0.4, 0.7)
    assert material["bulk_modulus"] == scene.material["mu_i_lc"]["bulk_modulus"]


def test_rings_around_an_axis_keep_their_places():
    scene = Scene.load(shipped_scenes()["dem_cylinder"])
    law = scene.law(next(iter(scene.material)))
    assert [member.name for member in numerical_members(plan(scene, law))] == ["estimate", "half-cells", "half-steps"]


def test_more_draws_go_on_with_the_folders_of_fewer():
    prepared = plan(Scene.load(shipped_scenes()["dem_column"]), get_material("mu_i_lc"))
    values = tuple({"static_friction": 0.3 + 0.001 * number} for number in range(120))
    few, many = (drawn_members(prepared, Draws(values[:count], 0)) for count in (20, 120))
    assert many[:20] == few


def test_scene_of_another_law_is_refused():
    scene = Scene.load(shipped_scenes()["dem_column"])
    with pytest.raises(InputError, match=r"one material must be of the law mu_i_phi_i; there is mu_i_lc \(mu_i_lc\)"):
        plan(scene, get_material("mu_i_phi_i"))


def test_too_few_samples_are_refused():
    check_samples(19)
    with pytest.raises(InputError, match="samples = 18; a band of 5 to 95 % needs 19 draws or more"):
        check_samples(18)


@pytest.mark.parametrize("shift", [[0.1], [0.1, 0.2, 0.3]])
def test_shift_of_points_needs_a_number_for_each_axis(shift):
    with pytest.raises(InputError, match=r"body.0.lattice_shift = .*: allowed: 2 numbers"):
        Scene.load(shipped_scenes()["dem_column"], {"body.0.lattice_shift": shift})
