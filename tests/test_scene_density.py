"""A body's density [kg/m3]: refused above that of its grains, warned about where it looks like one in g/cm3."""

import warnings

import pytest
from scenes_for_tests import BLOCK, COLUMN, call_command_line, changed, write_scene

import grainlaw as gl
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.scene.initial_state import build_bodies


def built(content, density):
    """The bodies of a scene of such a density; nothing has to be compiled for them."""
    return build_bodies(Scene.from_dict(changed(content, {"body.0.density": density})))


@pytest.mark.parametrize("density", [2450.1, 9e5])
def test_a_body_denser_than_its_grains_is_refused_in_one_line(tmp_path, monkeypatch, capsys, density):
    path = write_scene(tmp_path / "scene.toml", COLUMN, {"body.0.density": density})
    assert call_command_line(monkeypatch, "run", path, "--out", tmp_path / "out") == 2
    assert capsys.readouterr().err == (
        f"error: {path}: body.0.density = {density:g} kg/m3 is above the density of the grains, "
        "material.mu_i_lc.grain_density = 2450 kg/m3; allowed: up to that\n"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("density", [1.5, 99.9])
def test_grains_lighter_than_any_are_warned_about(density):
    with pytest.warns(
        gl.InputWarning, match=rf"^scene: body\.0\.density = {density} kg/m3 is lighter than .*{1000 * density:g}"
    ):
        built(COLUMN, density)


@pytest.mark.parametrize(("content", "density"), [(COLUMN, 100.0), (COLUMN, 2450.0), (BLOCK, 1.0), (BLOCK, 1e5)])
def test_what_may_be_meant_is_not(content, density):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        built(content, density)
