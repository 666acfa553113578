"""The bodies at the start: mass, geostatic stress, a law's state in equilibrium with it."""

from itertools import pairwise

import numpy as np
import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, COLUMN, ELASTIC, MU_I_LC, changed, simulation

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.space import PLANE_STRAIN

WEIGHT = 1500.0 * 9.8
ROWS = layout_of(PLANE_STRAIN)
X, Y, DENSITY = 0, 1, ROWS.density
SXX, SYY, SZZ, SXY = range(ROWS.stress, ROWS.stress + 4)
LXX, LYY = ROWS.gradient, ROWS.gradient + 3


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


def bodies_of(*sections, **changes):
    """Bodies of Cam Clay under their weight; a section is a shape, and further keys of the body."""
    common = {"density": 1500.0, "material": "modified_cam_clay", "initial_stress": {"kind": "geostatic"}}
    content = changed(COLUMN, {"material": {"modified_cam_clay": CAM_CLAY}} | changes)
    content["body"] = [common | {"shape": shape} | further for shape, further in sections]
    return build_bodies(Scene.from_dict(content))


def by_place(bodies):
    """Rows of all points of some bodies, ordered by place."""
    points = np.concatenate([body.points for body in bodies], axis=1)
    return points[:, np.lexsort((np.round(points[Y], 9), np.round(points[X], 9)))]


SLOPE = [[0.1, 0.0], [1.1, 0.0], [0.8, 0.8], [0.4, 0.8]]


@pytest.mark.parametrize("pieces", [2, 4])
@pytest.mark.parametrize("points_per_cell", [4, 9])
def test_a_column_or_heap_cut_into_bodies_has_the_stress_of_one(pieces, points_per_cell):
    density = {"density": 1450.3, "points_per_cell": points_per_cell}
    heights = np.linspace(0.0, 0.8, pieces + 1)
    layers = [(box(1.5, low, 1.8, high), density) for low, high in pairwise(heights)]
    left, right = np.interp(heights, [0.0, 0.8], [0.1, 0.4]), np.interp(heights, [0.0, 0.8], [1.1, 0.8])
    for i in range(pieces):
        vertices = [[left[i], heights[i]], [right[i], heights[i]]]
        vertices += [[right[i + 1], heights[i + 1]], [left[i + 1], heights[i + 1]]]
        layers.insert(0, ({"kind": "polygon", "vertices": vertices}, density))
    whole = bodies_of((box(1.5, 0.0, 1.8, 0.8), density), ({"kind": "polygon", "vertices": SLOPE}, density))
    cut, whole = by_place(bodies_of(*layers)), by_place(whole)
    np.testing.assert_allclose(cut[SXX:], whole[SXX:], rtol=1e-9)


@pytest.mark.parametrize("points_per_cell", [(4, 4), (4, 9), (16, 1), (25, 36)])
def test_layers_of_two_densities_weigh_what_they_weigh(points_per_cell):
    lower, upper = bodies_of(
        (box(0.5, 0.0, 0.8, 0.5), {"density": 1800.0, "points_per_cell": points_per_cell[0]}),
        (box(0.5, 0.5, 0.7, 0.8), {"density": 1200.0, "points_per_cell": points_per_cell[1]}),
    )
    np.testing.assert_allclose(upper.points[SYY], -9.8 * 1200.0 * (0.8 - upper.points[Y]), rtol=1e-9)
    covered = lower.points[X] < 0.7
    expected = 1800.0 * (0.5 - lower.points[Y]) + np.where(covered, 1200.0 * 0.3, 0.0)
    np.testing.assert_allclose(lower.points[SYY], -9.8 * expected, rtol=1e-9)


def test_bodies_of_other_spacings_beside_each_other_share_the_columns_between_them():
    """A wall between them at 0.6875, within columns of both: no weight counts twice."""
    fine = {"points_per_cell": 25}
    bodies = bodies_of((box(0.5, 0.0, 0.6875, 0.8), {}), (box(0.6875, 0.0, 0.8, 0.8), fine))
    for body in bodies:
        depth = 0.8 - body.points[Y]
        np.testing.assert_allclose(body.points[SYY], -WEIGHT * depth, rtol=1e-9)


def test_nothing_rests_on_a_body_across_a_gap_of_air():
    roof = [[0.5, 0.0], [0.9, 0.0], [0.9, 0.2], [0.6, 0.2], [0.6, 0.3], [0.9, 0.3], [0.9, 0.5], [0.5, 0.5]]
    (bracket,) = bodies_of(({"kind": "polygon", "vertices": roof}, {}))
    parts = bodies_of((box(0.5, 0.0, 0.9, 0.2), {}), (box(0.5, 0.2, 0.6, 0.3), {}), (box(0.5, 0.3, 0.9, 0.5), {}))
    under_air = (bracket.points[X] > 0.6) & (bracket.points[Y] < 0.2)
    top = np.where(under_air, 0.2, 0.5)
    np.testing.assert_allclose(bracket.points[SYY], -WEIGHT * (top - bracket.points[Y]), rtol=1e-9)
    np.testing.assert_allclose(by_place(parts)[SXX:], by_place([bracket])[SXX:], rtol=1e-9)


def test_bodies_that_touch_between_lattice_lines_of_both_rest_on_each_other():
    """The slope between them leaves gaps and overlaps of the squares of their points, narrower than a cell."""
    low = {"kind": "polygon", "vertices": [[0.5, 0.0], [0.8, 0.0], [0.8, 0.5], [0.5, 0.3]]}
    high = {"kind": "polygon", "vertices": [[0.5, 0.3], [0.8, 0.5], [0.8, 0.8], [0.5, 0.8]]}
    for body in bodies_of((low, {"points_per_cell": 4}), (high, {"points_per_cell": 9})):
        np.testing.assert_allclose(body.points[SYY], -WEIGHT * (0.8 - body.points[Y]), atol=WEIGHT * 0.0125)


@pytest.mark.parametrize("on_the_lower_too", [False, True])
def test_a_surcharge_acts_on_free_tops_and_is_carried_down_once(on_the_lower_too):
    loaded = {"initial_stress": {"kind": "geostatic", "surcharge": 500.0}}
    (alone,) = bodies_of((box(0.5, 0.0, 0.8, 0.8), loaded))
    np.testing.assert_allclose(alone.points[SYY], -WEIGHT * (0.8 - alone.points[Y]) - 500.0, rtol=1e-9)
    layers = (box(0.5, 0.0, 0.8, 0.5), loaded if on_the_lower_too else {}), (box(0.5, 0.5, 0.8, 0.8), loaded)
    np.testing.assert_allclose(by_place(bodies_of(*layers))[SXX:], by_place([alone])[SXX:], rtol=1e-9)


def test_a_surcharge_that_would_be_lost_is_refused():
    loaded = {"initial_stress": {"kind": "geostatic", "surcharge": 500.0}}
    with pytest.raises(InputError, match=r"body\.0\.initial_stress\.surcharge = 500: .* give it to the body on top"):
        bodies_of((box(0.5, 0.0, 0.8, 0.5), loaded), (box(0.5, 0.5, 0.8, 0.8), {}))
    with pytest.raises(InputError, match="a surcharge belongs to kind = 'geostatic'"):
        bodies_of((box(0.5, 0.0, 0.8, 0.5), {"initial_stress": {"kind": "uniform", "surcharge": 500.0}}))


TABLE = {"kind": "table", "depth": [0.0, 0.2, 0.8], "vertical_stress": [100.0, 4100.0, 5300.0], "horizontal_ratio": 0.5}


def test_a_table_gives_the_vertical_stress_over_depth_below_the_free_top():
    (alone,) = bodies_of((box(0.5, 0.0, 0.8, 0.8), {"initial_stress": TABLE}))
    depth = 0.8 - alone.points[Y]
    vertical = -np.where(depth < 0.2, 100.0 + 2e4 * depth, 3700.0 + 2e3 * depth)
    np.testing.assert_allclose(alone.points[SYY], vertical, rtol=1e-9)
    np.testing.assert_allclose(alone.points[SXX], 0.5 * vertical, rtol=1e-9)
    stress = {"initial_stress": TABLE}
    layers = bodies_of((box(0.5, 0.0, 0.8, 0.5), stress), (box(0.5, 0.5, 0.8, 0.8), stress | {"density": 900.0}))
    np.testing.assert_allclose(by_place(layers)[SXX : SXY + 1], by_place([alone])[SXX : SXY + 1], rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"depth": [0.0, 0.2, 0.7]}, r"body\.0\.initial_stress\.depth spans 0 to 0\.7 m, the points .* 0\.79375 m"),
        ({"depth": [0.0, 0.8]}, "lists of one length"),
        ({"vertical_stress": None}, "needs depth and vertical_stress"),
        ({"depth": [0.0, 0.9, 0.8]}, "depth must increase"),
        ({"vertical_stress": [0.0, -1.0, 2.0]}, "vertical_stress holds -1 Pa; allowed: 0 to 1e\\+12 Pa"),
        ({"kind": "geostatic"}, "depth and vertical_stress belong to kind = 'table'"),
    ],
)
def test_a_table_that_says_too_little_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        bodies_of((box(0.5, 0.0, 0.8, 0.8), {"initial_stress": TABLE | changes}))


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
