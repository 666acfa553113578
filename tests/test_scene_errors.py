"""Bad scenes: one line on stderr that names file, key, value and what is allowed; exit code 2; nothing written."""

import re

import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, COLUMN, MU_I_LC, call_command_line, write_scene

BOX = {"kind": "rectangle", "lower": [0.3, 0.2], "upper": [0.7, 0.6]}
SECOND = {
    "material": "linear_elastic",
    "density": 1000.0,
    "shape": {"kind": "disc", "center": [0.3, 0.2], "radius": 0.1},
}
OVERLAPPING = [BLOCK["body"][0], SECOND]

FAULTS = {
    "unknown law": ({"material": {"linear_elastik": {}}, "body.0.material": "linear_elastik"},
                    r"material\.linear_elastik: unknown law 'linear_elastik'; did you mean 'linear_elastic'\?"),
    "unknown law of a named material": ({"material.linear_elastic.law": "mu_i_lk"},
                                        r"material\.linear_elastic: unknown law 'mu_i_lk'; did you mean 'mu_i_lc'\?"),
    "body of no material": ({"body.0.material": "linear_elastc"},
                            r"body\.0\.material = 'linear_elastc': did you mean 'linear_elastic'\?"),
    "unknown parameter": ({"material.linear_elastic.poison_ratio": 0.1},
                          r"material\.linear_elastic has no parameter 'poison_ratio'; did you mean 'poisson_ratio'\?"),
    "parameter out of bounds": ({"material.linear_elastic.poisson_ratio": 0.5},
                                r"material\.linear_elastic\.poisson_ratio = 0\.5 is out of bounds; allowed: \(-1, 0"),
    "parameter that is no number": ({"material.linear_elastic.poisson_ratio": "soft"},
                                    r"material\.linear_elastic\.poisson_ratio = 'soft' is not a number"),
    "missing parameter": ({"material.linear_elastic.bulk_modulus": None},
                          r"material\.linear_elastic needs a value for: bulk_modulus \[Pa\]"),
    "missing table": ({"grid": None}, r"'grid' is missing"),
    "missing key": ({"time.end": None}, r"'time\.end' is missing"),
    "negative cell size": ({"grid.cell_size": -0.1}, r"grid\.cell_size = -0\.1: allowed: > 0\n"),
    "part of a cell": ({"grid.cell_size": 0.07},
                       r"grid: the domain is 1 m along x, not a whole number of cells of 0\.07 m; nearest: 0\.98 m"),
    "domain inside out": ({"grid.upper": [-1.0, 0.8]}, r"grid: the domain is -1 m along x"),
    "more cells than memory": ({"grid.cell_size": 1e-8}, r"grid: 100000000 x 80000000 cells do not fit into memory"),
    "overlap": ({"body": OVERLAPPING}, r"body\.0 and body\.1 overlap, for instance at \(0\.\d+, 0\.\d+\)"),
    "points outside": ({"body.0.shape.upper": [1.1, 0.6]},
                       r"body\.0: 16 of 128 points lie outside the domain \[0\.0, 0\.0\] to \[1\.0, 0\.8\], "
                       r"the first at \(1\.025, 0\.225\)"),
    "body too small": ({"body.0.shape.upper": [0.31, 0.21]}, r"body\.0: the shape holds no point"),
    "shape without area": ({"body.0.shape.upper": [0.3, 0.6]}, r"body\.0\.shape: upper = \[0\.3, 0\.6\] must lie"),
    "unknown shape": ({"body.0.shape.kind": "rectangel"},
                      r"body\.0\.shape\.kind = 'rectangel': allowed: .*'disc'.*; did you mean 'rectangle'\?"),
    "shape like no other": ({"body.0.shape.kind": "cube"},
                            r"body\.0\.shape\.kind = 'cube': allowed: .*'rectangle'[^;]*$"),
    "unknown boundary": ({"boundary.left": "sticky"}, r"boundary\.left\.kind = 'sticky': .*'free_slip', 'no_slip'"),
    "misspelt boundary": ({"boundary.left": "free_slop"},
                          r"boundary\.left\.kind = 'free_slop': allowed: .*; did you mean 'free_slip'\?"),
    "unknown side": ({"boundary.botom": "no_slip"}, r"unknown key 'boundary\.botom'; did you mean 'bottom'\?"),
    "half periodic": ({"boundary.left": "periodic"}, r"boundary: periodic sides come in pairs: set both left and"),
    "narrow periodic": ({"grid.upper": [1.0, 0.1], "body.0.shape": BOX | {"upper": [0.7, 0.3]},
                         "boundary": {"bottom": "periodic", "top": "periodic"}},
                        r"boundary\.bottom is periodic over 1 cells of the grid; allowed: 2 or more"),
    "coefficient without friction": ({"boundary.bottom": {"kind": "no_slip", "coefficient": 0.3}},
                                     r"boundary\.bottom: a coefficient belongs to kind = 'friction'"),
    "friction without coefficient": ({"boundary.bottom": "friction"},
                                     r"boundary\.bottom: kind = 'friction' needs a coefficient"),
    "unstable step": ({"time.step": 0.1}, r"time\.step = 0\.1 s is above the stable step at the start, 0\.02 s"),
    "endless run": ({"time.end": float("inf")}, r"time\.end = inf: allowed: a finite number"),
    "unknown key": ({"time.sfety": 0.3}, r"unknown key 'time\.sfety'; did you mean 'safety'\?"),
    "unknown key of a shape": ({"body.0.shape.lowr": [0.0, 0.0]},
                               r"unknown key 'body\.0\.shape\.lowr'; (did you mean 'lower'\?|valid names: .*lower)"),
    "unknown table": ({"bodies": []}, r"unknown key 'bodies'; did you mean 'body'\?"),
    "unknown field": ({"output.fields": ["presure"]},
                      r"output\.fields: unknown field 'presure'; did you mean 'pressure'\?"),
    "field that no law gives": ({"output.fields": ["solid_fraction"]},
                                r"output\.fields: 'solid_fraction' needs a law with the parameter 'grain_density'"),
    "unknown field of pictures": ({"output.picture_field": "presure"},
                                  r"output\.picture_field: unknown field 'presure'; did you mean 'pressure'\? "
                                  r"allowed: velocity, pressure, .*shear_strain.*, body\n"),
    "field like no other": ({"output.picture_field": "temperature"},
                            r"output\.picture_field: unknown field 'temperature'; .*velocity, .*body"),
    "endless frames": ({"output.interval": 1e-9}, r"output\.interval = 1e-09 s is 1e\+08 times .* 100000 times or"),
    "fast body": ({"body.0.velocity": [0.0, -1e200]},
                  r"body\.0\.velocity: -1e\+200 m/s is out of bounds; allowed: -1e\+06 to 1e\+06 m/s\n"),
    "fast wall": ({"boundary.left": {"kind": "no_slip", "velocity": 1e200}},
                  r"boundary\.left\.velocity: 1e\+200 m/s is out of bounds; allowed: -1e\+06 to 1e\+06 m/s\n"),
    "endless weight": ({"gravity": [1e300, 0.0]}, r"gravity: 1e\+300 m/s2 is out of bounds; allowed: -1e\+06 to 1e"),
    "endless density": ({"body.0.density": 1e200}, r"body\.0\.density = 1e\+200: allowed: <= 1e\+06\n"),
    "endless pressure": ({"body.0.initial_stress": {"kind": "uniform", "pressure": 1e200}},
                         r"body\.0\.initial_stress\.pressure = 1e\+200: allowed: <= 1e\+12\n"),
    "no body": ({"body": []}, r"body = \[\]: allowed: 1 or more entries"),
    "body is a number": ({"body": 3}, r"body = 3: allowed: a list"),
    "points per cell": ({"body.0.points_per_cell": 5}, r"body\.0\.points_per_cell = 5: allowed: 1, 4, 9, 16, 25 or 36"),
    "truth for a number": ({"body.0.density": True}, r"body\.0\.density = True: allowed: a number"),
    "text for a number": ({"time.end": "1"}, r"time\.end = '1': allowed: a number"),
    "shape without a kind": ({"body.0.shape.kind": None}, r"'body\.0\.shape\.kind' is missing"),
    "one coordinate": ({"gravity": [1.0]}, r"gravity = \[1\.0\]: space = 'plane_strain' takes 2 components, x, y"),
    "three coordinates": ({"gravity": [1.0, 2.0, 3.0]},
                          r"gravity = \[1\.0, 2\.0, 3\.0\]: space = 'plane_strain' takes 2 components"),
    "list for a text": ({"output.fields": [1]}, r"output\.fields\.0 = 1: allowed: a text"),
    "text for a truth": ({"output.vtu": "yes"}, r"output\.vtu = 'yes': allowed: true or false"),
    "misspelt section": ({"grid": None, "gird": {"cell_size": 0.1}},
                         r"unknown key 'gird'; did you mean 'grid'\?; also 'grid' is missing\n"),
    "misspelt key that is needed": ({"time": {"edn": 1.0}},
                                    r"unknown key 'time\.edn'; did you mean 'end'\?; also 'time\.end' is missing\n"),
    "unknown accuracy and no cell size": ({"accuracy": "5%", "grid.cell_size": None},
                                          r"accuracy = '5%': allowed: .*; also 'grid\.cell_size' is missing\n"),
    "accuracy with an unknown law": ({"accuracy": "10%", "grid.cell_size": None, "material": {"mu_i_lk": {}},
                                      "body.0.material": "mu_i_lk"},
                                     r"material\.mu_i_lk: unknown law .*'mu_i_lc'.*--plugin FILE\.py"),
    "accuracy with an unknown parameter": ({"accuracy": "10%", "grid.cell_size": None,
                                            "material": {"mu_i_lc": {"E": 1.0}}, "body.0.material": "mu_i_lc"},
                                           r"material\.mu_i_lc has no parameter 'E'"),
    "endless domain": ({"grid.lower": [-1e308, 0.0], "grid.upper": [1e308, 0.8]}, r"grid: the domain is inf m along x"),
    "endless shape": ({"body.0.shape.upper": [1e300, 1e300]},
                      r"body\.0: the shape is 2e\+301 x 2e\+301 points .*memory"),
    "shape without bounds": ({"body.0.shape": {"kind": "disc", "center": [1e200, 0.0], "radius": 1e308}},
                             r"body\.0: the shape is inf x inf points .*memory"),
    "more points than memory": ({"body.0.shape.upper": [1e5, 1e5]}, r"body\.0: the shape is 2e\+06 x 2e\+06 points"),
    "shape beyond the domain": ({"body.0.shape.upper": [5.0, 0.6]},
                                r"body\.0: the shape is 4\.7 x 0\.4 m large, the domain 1 x 0\.8 m"),
    "more steps than a run can take": ({"material.linear_elastic.bulk_modulus": 1e35},
                                       r"time\.end = 0\.1 s takes more than 1e\+12 steps of 2\.\d+e-18 s"),
    "law without numbers": ({"material": {"modified_cam_clay": CAM_CLAY | {"swelling_index": 8e-9}},
                             "body.0.material": "modified_cam_clay",
                             "body.0.initial_stress": {"kind": "uniform", "pressure": 1e3}},
                            r"modified_cam_clay has no stress or sound speed with these parameters at the start"),
    "shape elsewhere": ({"body.0.shape": {"kind": "disc", "center": [1e300, 0.0], "radius": 1.0}},
                        r"body\.0: the shape lies outside the domain \[0\.0, 0\.0\] to \[1\.0, 0\.8\]"),
    "mesh file": ({"body.0.shape": {"kind": "mesh", "file": "none.vtk"}},
                  r"body\.0\.shape: there is no mesh file .*none\.vtk"),
}  # fmt: skip


def refused(monkeypatch, capsys, out, *arguments):
    """The one line on stderr of a command that is refused and writes nothing."""
    assert call_command_line(monkeypatch, "run", *arguments, "--out", out) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    assert not out.exists()
    return printed.err


@pytest.mark.parametrize("fault", FAULTS)
def test_a_bad_scene_is_refused_in_one_line(tmp_path, monkeypatch, capsys, fault):
    changes, message = FAULTS[fault]
    path = write_scene(tmp_path / "bad.toml", BLOCK, changes)
    line = refused(monkeypatch, capsys, tmp_path / "out", path)
    assert re.search(message, line)
    assert str(path) in line
    # no word of the library that checks
    assert not re.search(r"Input should|should have at|valid (number|list|dictionary)|required|extract", line)


def test_the_stable_step_in_the_message_is_accepted(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "scene.toml", COLUMN, {"time.step": 0.1})
    stable = float(re.search(r"at the start, (\S+) s", refused(monkeypatch, capsys, tmp_path / "out", path))[1])
    arguments = ["--set", f"time.step={0.5 * stable}", "--set", f"time.end={stable}", "--out", tmp_path / "out"]
    assert call_command_line(monkeypatch, "run", path, *arguments) == 0
    assert (tmp_path / "out" / "summary.json").exists()


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (lambda path: None, "No such file"),
        (lambda path: path.mkdir(), "Is a directory"),
        (lambda path: path.write_text("[grid\ncell_size = 1"), r"not valid TOML: .*line 1"),
        (lambda path: path.write_text("grid = 1\ngrid = 2"), "not valid TOML"),
        (lambda path: path.write_bytes(b"title = '\xff\xfe'"), "not valid TOML"),
        (lambda path: path.write_text(""), "is missing"),
    ],
)
def test_a_file_that_is_no_scene_is_refused_in_one_line(tmp_path, monkeypatch, capsys, write, message):
    path = tmp_path / "bad.toml"
    write(path)
    line = refused(monkeypatch, capsys, tmp_path / "out", path)
    assert re.search(message, line)
    assert str(path) in line


@pytest.mark.parametrize(
    ("assignment", "message"),
    [
        ("grid.cell_size", "expected name=value"),
        ("=3", "expected name=value"),
        ("grid.cel_size=0.1", r"unknown key 'grid\.cel_size'; did you mean 'cell_size'\?"),
        ("nonsense.key=1", "unknown key 'nonsense'; valid names: accuracy, body, boundary"),
        ("grid.cell_size=big", r"grid\.cell_size = 'big'"),
        ("title.short=1", r"--set title\.short: 'title' is a value, not a table"),
        ("grid=3", "grid = 3: allowed: a table"),
        ("body=3", "body = 3: allowed: a list"),
        ("body.3.density=1", r"--set body\.3\.density: '3' is no entry of the list; allowed: 0 to 0"),
        ("body.first.density=1", r"--set body\.first\.density: 'first' is no entry of the list"),
        ("gravity.2=1", r"--set gravity\.2: '2' is no entry of the list; allowed: 0 to 1"),
        ("material.linear_elastic.poisson=0.1", r"no parameter 'poisson'; did you mean 'poisson_ratio'\?"),
    ],
)
def test_nonsense_set_on_top_of_a_scene_is_refused_in_one_line(tmp_path, monkeypatch, capsys, assignment, message):
    path = write_scene(tmp_path / "scene.toml", BLOCK)
    assert re.search(message, refused(monkeypatch, capsys, tmp_path / "out", path, "--set", assignment))


def test_the_same_value_set_twice_is_refused(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "scene.toml", BLOCK)
    twice = ["--set", "time.end=1", "--set", "time.end=2"]
    assert "time.end is given twice: 1 and 2" in refused(monkeypatch, capsys, tmp_path / "out", path, *twice)


def test_several_faults_stand_in_the_line_and_very_many_are_counted(tmp_path, monkeypatch, capsys):
    faults = {"grid.cell_size": -1.0, "time.end": -1.0, "gravty": [0, 0]}
    path = write_scene(tmp_path / "scene.toml", BLOCK, faults)
    line = refused(monkeypatch, capsys, tmp_path / "out", path)
    assert re.search(r"'gravty'.*; also grid\.cell_size = -1\.0: .*; also time\.end = -1\.0: allowed: > 0\n", line)
    path = write_scene(tmp_path / "scene.toml", BLOCK, faults | {f"key_{number}": 1 for number in range(5)})
    assert "(and 3 more)" in refused(monkeypatch, capsys, tmp_path / "out", path)


@pytest.mark.parametrize("command", ["run", "plan"])
def test_a_faulty_law_parameter_is_refused_by_every_command_that_takes_a_scene(tmp_path, monkeypatch, capsys, command):
    parameters = {"material": {"mu_i_lc": MU_I_LC | {"grain_diamter": 1.0}}}
    path = write_scene(tmp_path / "scene.toml", COLUMN, parameters)
    assert call_command_line(monkeypatch, command, path) == 2
    assert "did you mean 'grain_diameter'?" in capsys.readouterr().err
