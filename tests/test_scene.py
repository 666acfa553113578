"""Scenes: TOML and back, values set by dotted key, the scenes that are shipped."""

import tomllib
from pathlib import Path

import pytest
from scenes_for_tests import BLOCK, COLUMN, ELASTIC, changed, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.scene.initial_state import build_bodies

SHIPPED = sorted((Path(__file__).parent.parent / "scenes").glob("*.toml"))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_scene_loads_builds_and_survives_the_round_trip(path):
    scene = Scene.load(path)
    again = Scene.from_dict(tomllib.loads(scene.to_toml()))
    assert again.model_dump() == scene.model_dump()
    assert again.to_toml() == scene.to_toml()
    assert scene.title
    assert all(body.count > 0 for body in build_bodies(scene))


@pytest.mark.parametrize("content", [BLOCK, COLUMN])
def test_a_resolved_scene_reads_back_as_it_was_with_every_default_written_out(tmp_path, content):
    scene = Scene.from_dict(content)
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    assert Scene.load(tmp_path / "scene.toml").model_dump() == scene.model_dump()
    written = tomllib.loads(scene.to_toml())
    assert written["time"]["safety"] == scene.time.safety
    assert written["transfer"]["basis"] == "quadratic"
    assert written["boundary"]["top"]["kind"] == "free_slip"


def test_a_wall_may_be_given_by_its_kind_alone():
    short = Scene.from_dict(changed(BLOCK, {"boundary.left": "no_slip"}))
    long = Scene.from_dict(changed(BLOCK, {"boundary.left": {"kind": "no_slip"}}))
    assert short.boundary.left.kind == "no_slip"
    assert short.model_dump() == long.model_dump()


def test_values_are_set_by_dotted_key(tmp_path):
    path = write_scene(tmp_path / "scene.toml", BLOCK)
    overrides = {
        "grid.cell_size": 0.05,
        "time.safety": 0.2,
        "material.linear_elastic.poisson_ratio": 0.3,
        "body.0.density": 1234.0,
        "body.0.velocity.1": -2.0,
        "body.0.shape.upper.0": 0.5,
        "output.fields": ["velocity"],
    }
    path.write_text(path.read_text().replace("density = 1000.0", "density = 1000.0\nvelocity = [1.0, 0.0]"))
    scene = Scene.load(path, overrides)
    assert (scene.grid.cell_size, scene.time.safety, scene.body[0].density) == (0.05, 0.2, 1234.0)
    assert scene.parameters("linear_elastic").poisson_ratio == 0.3
    assert scene.body[0].velocity == (1.0, -2.0)
    assert scene.body[0].shape.upper == (0.5, 0.6)
    assert scene.output.fields == ["velocity"]


def test_a_material_may_have_a_name_of_its_own():
    materials = {"soft": ELASTIC | {"law": "linear_elastic"}, "stiff": {"law": "linear_elastic"} | ELASTIC}
    scene = Scene.from_dict(changed(BLOCK, {"material": materials, "body.0.material": "soft"}))
    assert scene.law("soft").name == scene.law("stiff").name == "linear_elastic"
    assert scene.parameters("soft").bulk_modulus == ELASTIC["bulk_modulus"]


def test_a_domain_may_have_a_corner_anywhere_and_its_cells_are_counted():
    scene = Scene.from_dict(changed(BLOCK, {"grid": {"cell_size": 0.1, "lower": [-0.3, -0.2], "upper": [0.9, 0.8]}}))
    assert scene.grid.cells == (12, 10)


def test_the_scene_names_its_file_in_messages(tmp_path):
    path = write_scene(tmp_path / "mine.toml", BLOCK, {"grid.cell_size": -0.1})
    with pytest.raises(InputError, match=r"mine\.toml: grid\.cell_size = -0\.1"):
        Scene.load(path)


def test_a_material_takes_what_it_does_not_state_from_its_parameter_file(tmp_path):
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "fitted.toml").write_text("bulk_modulus = 2e5\npoisson_ratio = 0.1\n")
    material = {"linear_elastic": {"parameters": "fitted.toml", "poisson_ratio": 0.3}}
    path = write_scene(folder / "scene.toml", changed(BLOCK, {"material": material}))
    resolved = Scene.load(path).parameters("linear_elastic")
    assert (resolved.bulk_modulus, resolved.poisson_ratio) == (2e5, 0.3)
    stiffer = Scene.load(path, {"material.linear_elastic.bulk_modulus": 3e5})
    assert stiffer.parameters("linear_elastic").bulk_modulus == 3e5
    assert "parameters" not in tomllib.loads(stiffer.to_toml())["material"]["linear_elastic"]
    (folder / "fitted.toml").unlink()
    with pytest.raises(InputError, match=r"scene\.toml: parameter file .*fitted\.toml cannot be read"):
        Scene.load(path)
