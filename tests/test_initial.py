"""The bodies at the start: mass, geostatic stress, a law's state in equilibrium with it."""

import numpy as np
import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, COLUMN, ELASTIC, MU_I_LC, changed, simulation

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.layout import DENSITY, LXX, LYY, SXX, SXY, SYY, SZZ, X, Y
from grainlaw.mpm_core.scene.initial_state import build_bodies

WEIGHT = 1500.0 * 9.8


def column(**changes):
    return build_bodies(Scene.from_dict(changed(COLUMN, changes)))[0]


def test_mass_density_and_velocity_are_those_of_the_scene():
    body = column(**{"body.0.velocity": [0.3, -0.1], "body.0.points_per_cell": 9})
    assert body.count * body.point_mass == pytest.approx(1500.0 * 0.3 * 0.8, rel=1e-12)
    assert (body.density == 1500.0).all()
    np.testing.assert_array_equal(body.velocity, np.tile([[0.3], [-0.1]], body.count))


def test_the_geostatic_stress_is_the_weight_of_the_material_above():
    stress = {"kind": "geostatic", "horizontal_ratio": 0.6, "out_of_plane_ratio": 0.3}
    points = column(**{"body.0.initial_stress": stress}).points
    vertical = -WEIGHT * (0.8 - points[Y])
    np.testing.assert_allclose(points[SYY], vertical, rtol=1e-9)
    np.testing.assert_allclose(points[SXX], 0.6 * vertical, rtol=1e-9)
    np.testing.assert_allclose(points[SZZ], 0.3 * 1.6 * vertical, rtol=1e-9)
    assert not points[SXY].any()


def test_the_depth_under_a_slope_counts_from_the_slope():
    heap = {"kind": "polygon", "vertices": [[0.5, 0.0], [1.5, 0.0], [1.0, 0.4]]}
    points = column(**{"body.0.shape": heap}).points
    surface = 0.4 - 0.8 * np.abs(points[X] - 1.0)
    spacing = 0.0125
    np.testing.assert_allclose(points[SYY], -WEIGHT * (surface - points[Y]), atol=WEIGHT * 0.6 * spacing)
    assert (points[SYY] < 0.0).all()


def test_a_uniform_pressure_and_no_stress_are_what_they_say():
    uniform = column(**{"body.0.initial_stress": {"kind": "uniform", "pressure": 750.0}}).points
    np.testing.assert_array_equal(uniform[[SXX, SYY, SZZ]], -750.0)
    assert not column(**{"body.0.initial_stress": {"kind": "none"}}).points[[SXX, SYY, SZZ]].any()


LAWS = {
    "linear_elastic": ELASTIC,
    "mu_i_lc": MU_I_LC,
    "modified_cam_clay": CAM_CLAY,
    "modified_cam_clay, OCR 4": CAM_CLAY | {"overconsolidation_ratio": 4.0},
}


@pytest.mark.parametrize("name", LAWS)
def test_the_initial_state_is_in_equilibrium_with_the_initial_stress(name):
    law = name.split(",")[0]
    stress = {"kind": "geostatic", "horizontal_ratio": 0.7, "out_of_plane_ratio": 0.3}
    changes = {"material": {law: LAWS[name]}, "body.0.material": law, "body.0.initial_stress": stress}
    (body,) = simulation(COLUMN, changes).bodies
    before = body.points.copy()
    assert not body.points[LXX : LYY + 1].any()
    body.update_stress(1e-4)
    np.testing.assert_allclose(body.stress, before[SXX : SXY + 1], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(body.points[DENSITY:], before[DENSITY:], rtol=1e-12)


def test_the_overconsolidation_ratio_scales_the_yield_surface_through_the_initial_stress():
    sizes = []
    for ratio in (1.0, 4.0):
        parameters = CAM_CLAY | {"overconsolidation_ratio": ratio}
        material = {"material": {"modified_cam_clay": parameters}, "body.0.material": "modified_cam_clay"}
        sizes.append(column(**material).state("preconsolidation_pressure"))
    np.testing.assert_allclose(sizes[1], 4.0 * sizes[0], rtol=1e-12)


def test_bodies_are_numbered_one_after_the_other_and_may_have_laws_of_their_own():
    other = {"material": "linear_elastic", "shape": {"kind": "disc", "center": [0.5, 0.5], "radius": 0.2}}
    content = changed(COLUMN, {"material.linear_elastic": ELASTIC})
    content["body"].append(other | {"density": 900.0})
    first, second = build_bodies(Scene.from_dict(content))
    assert (first.law.name, second.law.name) == ("mu_i_lc", "linear_elastic")
    np.testing.assert_array_equal(np.concatenate([first.ids, second.ids]), np.arange(first.count + second.count))


def two_bodies(first, second, points_per_cell=(4, 4)):
    content = changed(BLOCK, {"body.0.shape": first, "body.0.points_per_cell": points_per_cell[0]})
    content["body"].append(content["body"][0] | {"shape": second, "points_per_cell": points_per_cell[1]})
    return Scene.from_dict(content)


def box(left, bottom, right, top):
    return {"kind": "rectangle", "lower": [left, bottom], "upper": [right, top]}


@pytest.mark.parametrize(
    ("first", "second", "points_per_cell"),
    [
        (box(0.1, 0.1, 0.5, 0.5), box(0.4, 0.4, 0.8, 0.7), (4, 4)),
        # Between the points of the first body, so that none of them lies in the second, and the other way round.
        (box(0.1, 0.1, 0.5, 0.5), box(0.2, 0.2, 0.24, 0.24), (1, 16)),
        (box(0.2, 0.2, 0.24, 0.24), box(0.1, 0.1, 0.5, 0.5), (16, 1)),
    ],
)
def test_overlapping_bodies_are_refused_with_a_place(first, second, points_per_cell):
    with pytest.raises(InputError, match=r"body.0 and body.1 overlap, for instance at \(0\.\d+, 0\.\d+\)"):
        build_bodies(two_bodies(first, second, points_per_cell))


def test_bodies_may_touch():
    assert len(build_bodies(two_bodies(box(0.1, 0.1, 0.5, 0.5), box(0.5, 0.1, 0.8, 0.5)))) == 2
