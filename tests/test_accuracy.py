"""`accuracy` in a scene: what it sets, what it leaves alone, what it refuses."""

import pytest
from scenes_for_tests import CAM_CLAY, COLUMN, changed

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene


def clay(ratio):
    """Changes that make the column one of clay with this overconsolidation ratio."""
    parameters = {**CAM_CLAY, "overconsolidation_ratio": ratio}
    return {"material": {"modified_cam_clay": parameters}, "body.0.material": "modified_cam_clay"}


def test_it_sets_what_the_scene_leaves_open():
    scene = Scene.from_dict(changed(COLUMN, {"accuracy": "10%", "grid.cell_size": None}))
    assert scene.grid.cell_size == pytest.approx(1.0 / 35.0)
    assert (scene.time.safety, scene.body[0].points_per_cell) == (0.4, 25)
    assert scene.precision == "single"
    stated = Scene.from_dict(changed(COLUMN, {"accuracy": "10%", "time.safety": 0.2, "body.0.points_per_cell": 9}))
    assert (stated.grid.cell_size, stated.time.safety, stated.body[0].points_per_cell) == (0.025, 0.2, 9)
    exact = Scene.from_dict(changed(COLUMN, {"accuracy": "10%", "precision": "double"}))
    assert exact.precision == "double"


@pytest.mark.parametrize(
    ("accuracy", "height", "most"), [("10%", 0.2, 0.2 / 8), ("3%", 0.2, 0.2 / 32), ("3%", 1.0, 1 / 68)]
)
def test_settings_resolve_width_and_size(accuracy, height, most):
    block = {"kind": "rectangle", "lower": [1.0, 0.0], "upper": [2.0, height]}
    scene = Scene.from_dict(changed(COLUMN, {"accuracy": accuracy, "grid.cell_size": None, "body.0.shape": block}))
    cell_size = scene.grid.cell_size
    assert 0.95 * most < cell_size < 1.000001 * most


def test_the_blend_time_follows_the_cells_unless_it_is_stated():
    assert Scene.from_dict(changed(COLUMN, {"grid.cell_size": 0.0125})).blend_time == pytest.approx(0.00125)
    assert Scene.from_dict(changed(COLUMN, {"transfer.time_constant": 0.02})).blend_time == 0.02
    assert Scene.from_dict(changed(COLUMN, {"transfer.scheme": "apic"})).blend_time == 0.0


def test_normally_consolidated_clay_has_settings_of_its_own():
    square = {"kind": "rectangle", "lower": [1.0, 0.0], "upper": [1.6, 0.6]}
    scene = Scene.from_dict(
        changed(COLUMN, {**clay(1.0), "accuracy": "10%", "grid.cell_size": None, "body.0.shape": square})
    )
    assert scene.grid.cell_size == pytest.approx(0.6 / 60)
    assert scene.body[0].points_per_cell == 16


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {**clay(1.0), "accuracy": "3%"},
            "confirmed by no measurement with material.modified_cam_clay and its parameters; allowed: 10%",
        ),
        ({"accuracy": "1%"}, "confirmed by no measurement with material.mu_i_lc and its parameters; allowed: 10%, 3%"),
        ({**clay(1.0), "accuracy": "10%"}, "up to 1 times as high as wide, not 2.67 times"),
        (
            {**clay(4.0), "accuracy": "10%"},
            "with material.modified_cam_clay and its parameters; state grid.cell_size and time.safety instead",
        ),
        ({"accuracy": "10%", "grid.cell_size": None, "grid.upper": [3.1, 1.037]}, "divide the domain"),
        (
            {"accuracy": "10%", "grid.cell_size": None, "material.mu_i_lc.grain_diameter": 0.03},
            "cells of 0.0286 m, finer than the grains of 0.03 m",
        ),
    ],
)
def test_what_no_measurement_confirms_is_refused(changes, message):
    with pytest.raises(InputError, match=message):
        Scene.from_dict(changed(COLUMN, changes))


def test_a_scene_without_material_is_told_so():
    with pytest.raises(InputError, match="material"):
        Scene.from_dict(changed(COLUMN, {"accuracy": "10%", "material": None}))
