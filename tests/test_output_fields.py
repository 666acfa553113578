"""Which fields frames hold: those that are asked for, that of the pictures, and the body where materials differ."""

import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, changed

from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.output.fields import chosen_fields

USUAL = ["velocity", "pressure", "deviatoric_stress", "shear_strain"]
OTHER = BLOCK["body"][0] | {"shape": {"kind": "rectangle", "lower": [0.7, 0.2], "upper": [0.9, 0.6]}}
CLAY = {"material.modified_cam_clay": CAM_CLAY, "body": [BLOCK["body"][0], OTHER | {"material": "modified_cam_clay"}]}


@pytest.mark.parametrize(
    ("changes", "fields"),
    [
        ({}, USUAL),
        ({"output.picture_field": "pressure"}, USUAL),
        ({"output.picture_field": "density"}, [*USUAL, "density"]),
        ({"output": {"fields": ["velocity"], "picture_field": "stress_xx"}}, ["velocity", "stress_xx"]),
        ({"output.fields": []}, []),
        ({"body": [BLOCK["body"][0], OTHER]}, USUAL),
        ({**CLAY, "output.fields": ["velocity"]}, ["velocity", "body"]),
        ({**CLAY, "output.fields": ["body", "velocity"]}, ["body", "velocity"]),
    ],
)
def test_frames_hold_what_is_asked_for_and_what_pictures_need(changes, fields):
    assert chosen_fields(Scene.from_dict(changed(BLOCK, changes))) == fields
