"""LIGGGHTS and YADE with our contact law against exact two-body answers."""

import shutil

import pytest

from grainlaw.validation.dem.description import Contact
from grainlaw.validation.dem.programs import PROGRAMS
from grainlaw.validation.dem.two_body import exact, measured


@pytest.mark.parametrize("code", PROGRAMS)
@pytest.mark.parametrize("contact", [Contact(), Contact(restitution=0.8, rolling_arm=0.05)], ids=["case", "other"])
def test_rolling_and_restitution(code, contact, tmp_path):
    if shutil.which(PROGRAMS[code].executable) is None:
        pytest.skip(f"{PROGRAMS[code].name} is not installed (Debian package {PROGRAMS[code].package})")
    found, right = measured(code, contact, tmp_path), exact(contact)
    assert found.deceleration == pytest.approx(right.deceleration, rel=0.01)
    assert found.restitution == pytest.approx(right.restitution, rel=0.02)
