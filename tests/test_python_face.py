"""`import grainlaw as gl`: what scripts and notebooks get, and what they are told."""

import math
import shutil
import subprocess
import sys
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scenes_for_tests import BLOCK, fresh_registry, write_plugin, write_scene

import grainlaw as gl
from grainlaw.mpm_core.scene.shipped import shipped_scenes

__all__ = ["fresh_registry"]

ROOT = Path(__file__).resolve().parent.parent
QUICK = {"time.end": 0.02, "output": {"pictures": True, "fields": ["velocity", "pressure"]}}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "block"
    return gl.run(gl.Scene(BLOCK, QUICK), folder, threads=1)


def test_importing_is_light():
    program = "import sys, grainlaw; print(sorted({name.partition('.')[0] for name in sys.modules}))"
    done = subprocess.run([sys.executable, "-S", "-c", program], capture_output=True, text=True, cwd=ROOT, check=True)
    assert "numpy" not in done.stdout
    assert "typing" in done.stdout


def test_the_core_loads_what_a_scene_may_need_no_earlier():
    program = "import sys, grainlaw.mpm_core; print(sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True)
    heavy = ("scipy.spatial", "scipy.optimize", "scipy.stats", "matplotlib", "pyvista", "trimesh", "pandas")
    assert [name for name in heavy if repr(name) in done.stdout] == []
    assert "'numba'" in done.stdout


def test_names_are_offered_and_others_refused():
    assert set(gl.__all__) <= set(dir(gl))
    with pytest.raises(AttributeError, match="has no attribute 'lawz'"):
        gl.lawz  # noqa: B018


def test_laws_are_a_table_by_name():
    laws = gl.laws()
    assert laws["mu_i_lc"].definition is gl.law("mu_i_lc").definition
    assert list(laws) == sorted(laws)
    for text in (repr(laws), unescape(laws._repr_html_())):
        assert all(law.name in text and law.summary in text for law in laws.values())


def test_law_says_what_it_declares():
    law = gl.law("mu_i_lc")
    assert law.parameters["bulk_modulus"].unit == "Pa"
    assert law.parameter_sets["paper"].parameters.bulk_modulus == 392e3
    assert "Source: " in law.documentation
    assert "392000" in repr(law)
    with pytest.raises(gl.InputError, match=r"did you mean 'mu_i_lc'\? .* gl.load_plugin"):
        gl.law("mu_i_lcc")


def test_parameter_sets_are_a_table_with_their_sources():
    sets = gl.law("mu_i_lc").parameter_sets
    assert dict(sets) == dict(gl.law("mu_i_lc").definition.parameter_sets)
    for text in (repr(sets), unescape(sets._repr_html_())):
        assert "bulk_modulus" in text
        assert "392000" in text
        assert all(name in text and found.source in text for name, found in sets.items())
        assert "function" not in text
    assert "function" not in repr(sets["paper"])


def test_a_simulation_says_what_it_is():
    simulation = gl.Simulation(BLOCK)
    simulation.advance_to(1e-3)
    assert repr(simulation) == f"Simulation('scene'): t = 0.001 s, step {simulation.steps}, 64 points of linear_elastic"


def test_a_shipped_scene_is_called_by_its_name_in_messages():
    assert gl.scenes()["two_discs"].source == gl.Scene("two_discs").source == "two_discs"
    with pytest.raises(gl.InputError, match=r"^two_discs: grid\.cell_size = -1: "):
        gl.Scene("two_discs", {"grid.cell_size": -1})


def test_element_test_gives_arrays_table_and_picture(tmp_path):
    law = gl.law("linear_elastic")
    result = law.element_test("simple-shear", parameter_set="soft_solid", final_strain=0.1, bulk_modulus=2e4)
    columns = result.to_dict()
    assert result.parameters["bulk_modulus"] == 2e4
    assert result.settings["final_strain"] == 0.1
    assert columns["time"].shape == columns["stress_xy"].shape
    assert np.array_equal(result["pressure"], columns["pressure"])
    frame = result.to_frame()
    assert np.array_equal(frame["stress_xy"].to_numpy(), columns["stress_xy"])
    assert frame.attrs["units"]["stress_xy"] == "Pa"
    figure = result.plot(path=tmp_path / "shear.png")
    assert len(figure.axes) == 4
    assert figure._repr_png_().startswith(b"\x89PNG")
    with Image.open(tmp_path / "shear.png") as picture:
        assert picture.width > 1000
    assert "simple-shear of linear_elastic" in repr(result)
    with pytest.raises(KeyError, match="did you mean 'pressure'"):
        result["presure"]


@pytest.mark.parametrize(
    ("arguments", "values", "message"),
    [
        (["simple-sheer"], {}, "did you mean 'simple-shear'"),
        (["simple-shear"], {"final_strian": 0.1}, "did you mean 'final_strain'"),
        (["simple-shear"], {"final_strain": "much"}, "final_strain = 'much': a number is needed"),
        (["simple-shear"], {"final_strain": -1.0}, "out of bounds"),
        (["simple-shear"], {"parameter_set": "papr"}, "did you mean 'paper'"),
        (["mixed"], {}, "needs a control file"),
    ],
)
def test_element_test_refuses_in_one_line(arguments, values, message):
    with pytest.raises(gl.InputError, match=message):
        gl.law("mu_i_lc").element_test(*arguments, **values)


def test_without_pandas_one_line_says_so(monkeypatch, finished):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(gl.InputError, match="needs pandas, which is not installed"):
        finished.to_frame()


def test_a_file_is_a_law_and_an_edited_file_the_edited_law(tmp_path, fresh_registry):
    path = write_plugin(tmp_path / "mine.py")
    first = gl.law(path)
    assert first.name == "spring"
    assert gl.law(str(path)).definition is not None
    path.write_text(path.read_text() + "\n# another state of the file\n")
    second = gl.law(path)
    assert second.definition is gl.law("spring").definition is not first.definition
    with pytest.raises(gl.InputError, match="was loaded again"):
        first.element_test("simple-shear")
    path.write_text("raise ValueError('half written')")
    with pytest.raises(gl.InputError, match="half written"):
        gl.load_plugin(path)
    assert gl.law("spring").definition is second.definition


@pytest.mark.parametrize("kind", ["tables", "path", "text", "scene", "keywords"])
def test_a_scene_is_made_of_tables_a_path_or_a_scene(kind, tmp_path):
    path = write_scene(tmp_path / "block.toml", BLOCK)
    changes = {"time.end": 0.125}
    tables = gl.Scene(BLOCK)
    made = {
        "tables": lambda: gl.Scene(BLOCK, changes),
        "path": lambda: gl.Scene(path, changes),
        "text": lambda: gl.Scene(str(path), changes),
        "scene": lambda: gl.Scene(tables, changes),
        "keywords": lambda: gl.Scene(**{**BLOCK, "time": {**BLOCK["time"], "end": 0.125}}),
    }[kind]()
    assert made.time.end == 0.125
    assert made.to_toml() == gl.Scene.from_dict({**BLOCK, "time": {**BLOCK["time"], "end": 0.125}}).to_toml()
    assert tables.time.end == BLOCK["time"]["end"]
    assert made.source == (str(path) if kind in ("path", "text") else "scene")


def test_shipped_scenes_go_by_name():
    scenes = gl.scenes()
    assert list(scenes) == list(shipped_scenes())
    for name, scene in scenes.items():
        assert gl.Scene(name).to_toml() == scene.to_toml()
        assert name in repr(scenes)
    assert gl.Scene("collapse_mu_i_lc", {"grid.cell_size": 0.025}).grid.cell_size == 0.025


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("colapse_mu_i_lc", "did you mean 'collapse_mu_i_lc'"),
        (Path("absent/two_discs.toml"), r"absent/two_discs\.toml: No such file.*did you mean 'two_discs'"),
        ({**BLOCK, "grid": {**BLOCK["grid"], "cellsize": 1.0}}, "scene: unknown key 'grid.cellsize'; did you mean"),
    ],
)
def test_a_wrong_scene_is_one_line(source, message):
    with pytest.raises(gl.InputError, match=message) as raised:
        gl.Scene(source)
    assert "\n" not in str(raised.value)


def test_a_run_gives_what_reading_its_folder_gives(finished):
    read = gl.read_run(str(finished.path))
    assert read.summary == finished.summary
    assert read.history.keys() == finished.history.keys() == set(finished.units)
    assert read.history["t"][-1] == 0.02
    assert list(read.to_frame()["t"]) == list(read.history["t"])
    assert set(read.pictures) >= {"final", "history"}
    last = read.frame(-1)
    assert last.time == read.frame_times[-1] == 0.02
    cloud = read.to_pyvista()
    assert cloud.n_points == read.summary.points
    assert np.array_equal(cloud.point_data["pressure"], last.field("pressure").values)
    assert "data:image/png;base64," in read._repr_html_()
    assert f"points {read.summary.points}" in repr(read)


def test_a_run_is_plotted(finished, tmp_path):
    figure = finished.plot("kinetic_energy", path=tmp_path / "energy.png")
    assert np.array_equal(figure.axes[0].lines[0].get_ydata(), finished.history["kinetic_energy"])
    assert (tmp_path / "energy.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(gl.InputError, match="did you mean 'runout'"):
        finished.plot("runnout")


def test_a_run_is_not_overwritten_unless_asked_to(finished, tmp_path):
    with pytest.raises(gl.InputError, match="already holds a run"):
        gl.run(gl.Scene(BLOCK, QUICK), finished.path, threads=1)
    shutil.copy(finished.path / "history.csv", tmp_path)
    assert "not finished" in repr(gl.read_run(tmp_path))
    with pytest.raises(gl.InputError, match="does not exist"):
        gl.read_run(finished.path / "absent")


def test_a_run_says_nothing_where_nobody_looks(capfd, tmp_path):
    gl.run(gl.Scene(BLOCK, {**QUICK, "output.pictures": False}), tmp_path / "quiet", threads=1)
    assert capfd.readouterr() == ("", "")


def test_a_simulation_is_led_to_a_time_and_shown():
    simulation = gl.Simulation(gl.Scene(BLOCK, {**QUICK, "gravity": [0.0, -9.81]}))
    before = simulation.to_pyvista()
    simulation.advance_to(0.01)
    after = simulation.to_pyvista()
    assert simulation.time == after.field_data["time"][0] == 0.01
    assert after.n_points == before.n_points > 0
    assert set(after.point_data.keys()) == {"velocity", "pressure"}
    assert np.array_equal(after.points, simulation.frame().positions.astype(after.points.dtype))
    assert after.points[:, 1].mean() < before.points[:, 1].mean()


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(gl.InputError, match="holds no run"):
        gl.read_run(tmp_path)


@pytest.mark.parametrize("time", [-1.0, math.nan, math.inf])
def test_a_simulation_goes_to_no_time_that_is_past_or_not_finite(time):
    with pytest.raises(gl.InputError, match="allowed are times from the present one, 0 s, on"):
        gl.Simulation(BLOCK).advance_to(time)
