"""`grainlaw element`: results, files, error lines and exit codes."""

import re

import pytest
from scenes_for_tests import grainlaw

from grainlaw.cli.element_command import TESTS
from grainlaw.materials.element.catalogue import TEST_NAMES

FAST = ("--set", "time_step=0.1")


def test_output_says_which_parameters_were_used_and_how_it_ended(tmp_path):
    table, picture = tmp_path / "history.csv", tmp_path / "history.png"
    done = grainlaw(
        "element", "triaxial-drained", "--material", "modified_cam_clay", "--set", "final_strain=0.5", *FAST,
        "--out", str(table), "--plot", str(picture),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "set 'paper' (Table 1, OCR = 1)" in done.stdout
    assert float(done.stdout.split("q/p = ")[1].split()[0]) == pytest.approx(1.2, rel=1e-3)
    assert table.read_text().startswith("time [s],stress_xx [Pa]")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_several_materials_share_a_picture(tmp_path):
    picture = tmp_path / "figure_1.png"
    done = grainlaw(
        "element", "constant-pressure-shear", "--material", "mu_i_lc", "--material", "modified_cam_clay",
        "--material", "modified_cam_clay:paper_ocr4", "--set", "time_step=1e-4", "--plot", str(picture),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "set 'paper_ocr4'" in done.stdout
    assert picture.stat().st_size > 20_000


def test_mixed_control_from_a_file(tmp_path):
    control = tmp_path / "control.toml"
    control.write_text("time_step = 0.1\n[[stage]]\nduration = 1.0\nstrain_rate = { yy = -0.01 }\n")
    done = grainlaw("element", "mixed", "--material", "mu_i_lc", "--control", str(control))
    assert done.returncode == 0, done.stderr
    assert "after 10 steps" in done.stdout


@pytest.mark.parametrize(
    ("law", "setting", "warning"),
    [
        (
            "mu_i_lc",
            ("--set", "initial_pressure=5e4"),
            r"the initial density 3638\.21 .* above the density of the grains, 2450 kg/m3: .* nominal",
        ),
        ("mu_i_lc", ("--set", "density=2500"), r"density = 2500 kg/m3 is above .* no packing is as dense$"),
        ("mu_i_lc", ("--set", "density=1500"), ""),
        ("mu_i_phi_i", (), ""),
        ("newtonian", (), ""),
    ],
)
def test_density_above_that_of_the_grains_is_explained(law, setting, warning):
    done = grainlaw("element", "isotropic", "--material", law, *setting, "--set", "final_strain=1e-3", *FAST)
    assert done.returncode == 0, done.stderr
    if warning:
        assert re.fullmatch(f"warning: {law}: {warning}.*\n", done.stderr), done.stderr
    else:
        assert done.stderr == ""


def test_viscosity_of_what_does_not_flow_is_said_to_be_none(tmp_path):
    control = tmp_path / "rest.toml"
    control.write_text("time_step = 0.5\n[[stage]]\nduration = 1.0\n")
    done = grainlaw("element", "mixed", "--material", "linear_elastic", "--control", str(control))
    assert done.returncode == 0, done.stderr
    assert "viscosity = not defined, nothing flows" in done.stdout
    assert "nan" not in done.stdout


def test_help_names_every_test():
    assert TESTS.split(", ") == list(TEST_NAMES)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["isotropc", "--material", "mu_i_lc"], "unknown element test 'isotropc'; did you mean 'isotropic'?"),
        (["isotropic", "--material", "mu_lc"], "unknown law 'mu_lc'; did you mean 'mu_i_lc'?"),
        (["isotropic", "--material", "mu_i_lc", "--set", "static_frction=1"], "did you mean 'static_friction'?"),
        (["isotropic", "--material", "mu_i_lc", "--set", "poisson_ratio=0.5"], "allowed: (-1, 0.5)"),
        (["isotropic", "--material", "mu_i_lc", "--set", "poisson_ratio=half"], "'half' is not a number"),
        (["isotropic", "--material", "mu_i_lc", "--set", "poisson_ratio"], "expected name=value"),
        (["isotropic", "--material", "mu_i_lc", "--set", "density=1", "--set", "density=2"], "is given twice"),
        (["isotropic", "--material", "mu_i_lc:papr"], "no parameter set 'papr'; did you mean 'paper'?"),
        (["isotropic", "--material", "mu_i_lc", "--out", "absent/history.csv"], "there is no folder absent"),
        (["isotropic", "--material", "mu_i_lc", "--plot", "history.pdf"], "does not end in .png"),
        (["isotropic", "--material", "mu_i_lc", "--material", "linear_elastic", "--out", "x.csv"], "one material"),
        (["mixed", "--material", "mu_i_lc"], r"needs a control file (--control FILE.toml)"),
        (["isotropic", "--material", "mu_i_lc", "--control", "c.toml"], "(--control) belongs to"),
    ],
)
def test_wrong_request_is_one_line_and_exit_2(arguments, message):
    done = grainlaw("element", *arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""


def test_missing_material_is_exit_2():
    assert grainlaw("element", "isotropic").returncode == 2


def test_failed_computation_is_one_line_and_exit_1(tmp_path):
    """And nothing besides, as about the density: its pressure is one of this test alone."""
    control = tmp_path / "control.toml"
    control.write_text(
        "time_step = 0.01\n[[stage]]\nduration = 10.0\nstress_rate = { xx = 0.0, yy = -5e5, zz = 0.0 }\n"
    )
    done = grainlaw(
        "element", "mixed", "--material", "modified_cam_clay", "--control", str(control),
        "--set", "initial_pressure=98765",
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.startswith("error: modified_cam_clay: stress xx, yy, zz cannot")
    assert done.stderr.count("\n") == 1
