"""What the laws are fitted to: data files from the reference set, the start of shear as an element test."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from grainlaw.cli.main import app
from grainlaw.materials import get_material
from grainlaw.materials.calibration.data import read_data
from grainlaw.materials.calibration.fit import calibrate
from grainlaw.materials.calibration.model import ForwardModel, answer
from grainlaw.materials.calibration.shipped import data_file
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.plugins import mu_i_phi_i
from grainlaw.plugins.mu_i.consistent_flow import PARTED
from grainlaw.validation.dem.batch import case_named
from grainlaw.validation.dem.coverage import missing_runs, present_runs, seeds_told
from grainlaw.validation.dem.judging.column import ROUGH_FRICTION, column_of, column_scene, flat_friction
from grainlaw.validation.dem.judging.fitting_data import (
    CYCLE_FILE,
    FLOW_FILE,
    PEAK_FILE,
    START_FILE,
    START_STRAINS,
    write_data,
)
from grainlaw.validation.dem.judging.history_data import (
    LOOSE_FILE,
    MEDIUM_FILE,
    PRESSURE_FILE,
    RATE_DROP_FILE,
    RATE_JUMP_FILE,
    REVERSAL_FILE,
    SLOWING_FILE,
    TRIAXIAL_FILE,
)
from grainlaw.validation.dem.judging.judged_laws import JUDGED_LAWS
from grainlaw.validation.dem.judging.variants import CONTROLS, LIMITS, varied
from grainlaw.validation.dem.runs import Run, runs_of
from grainlaw.validation.reference.reference_set import REFERENCE, read_reference_set

LAW = "mu_i_phi_i"
# Tests of grains to which no law is fitted.
JUDGED_ONLY = (
    MEDIUM_FILE,
    LOOSE_FILE,
    RATE_DROP_FILE,
    RATE_JUMP_FILE,
    SLOWING_FILE,
    REVERSAL_FILE,
    PRESSURE_FILE,
    TRIAXIAL_FILE,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("data")
    write_data(read_reference_set(), found, 2450.0, 0.015)
    return found


def test_every_judged_law_finds_its_data(folder):
    for judged in JUDGED_LAWS:
        law = get_material(judged.law)
        assert all(read_data(folder / name, law) for name in judged.data)
        assert set(judged.given) <= set(law.parameter_declarations)


def test_no_granular_law_is_left_unjudged():
    assert {judged.law for judged in JUDGED_LAWS} >= {
        "mu_i_lc",
        "mu_i_phi_i",
        "mu_i_elastoplastic",
        "drucker_prager",
        "modified_cam_clay",
        "mu_i_mcc",
        "mu_i_state",
    }


def test_shipped_data_of_grains_are_those_of_the_comparison(folder):
    shipped = {"grains_steady_shear": FLOW_FILE, "grains_shear_start": PEAK_FILE, "grains_compression": CYCLE_FILE}
    shipped |= {f"grains_{name.removesuffix('.csv')}": name for name in JUDGED_ONLY}
    for name, file in shipped.items():
        assert data_file(Path(name)).read_text() == (folder / file).read_text()


def test_the_set_dem_of_the_unified_law_is_what_the_element_tests_give(folder):
    (judged,) = (found for found in JUDGED_LAWS if found.law == "mu_i_state")
    values = get_material("mu_i_state").parameter_sets["dem"].parameters._asdict()
    assert judged.given == {name: values[name] for name in judged.given}
    fit = calibrate("mu_i_state", [folder / name for name in judged.data], fixed=judged.given, parameters="dem")
    assert fit.values == pytest.approx(values, rel=3e-3)


def test_variants_are_scenes_of_grains_that_are_there_and_change_what_their_law_has():
    reference = read_reference_set()
    columns = {found.aspect_ratio: found for found in reference.columns("glued")}
    for variant in (*CONTROLS, *LIMITS):
        parameters = get_material(variant.law).parameter_sets
        values = next(iter(parameters.values())).parameters._asdict()
        plain = columns[variant.aspect_ratio].case
        column = column_of(reference.ensemble(plain.replace("glued", variant.grains)))
        as_judged = column_scene(column, variant.law, values, 0.025)
        changed = varied(as_judged, variant.law, variant)
        Scene.from_dict(changed, variant.name)
        is_changed = changed != as_judged or variant.cell_factor != 1.0 or variant.grains != "glued"
        assert is_changed or "as judged" in variant.name


def test_the_start_of_shear_determines_the_dilatancy(folder, tmp_path):
    """The law's own answer with a = 3 and a little noise, fitted from another start."""
    (data,) = read_data(folder / START_FILE, get_material(LAW))
    values = mu_i_phi_i.DEM_SHEAR._replace(dilatancy_coefficient=3.0)._asdict()
    model = ForwardModel(get_material(LAW), (data,))
    result = model.history(data, values, START_STRAINS)
    noise = 0.002 * np.random.default_rng(1).standard_normal((2, len(START_STRAINS)))
    columns = [answer(result, measured) * (1.0 + own) for measured, own in zip(data.measured, noise, strict=True)]
    lines = (folder / START_FILE).read_text().splitlines()
    head = [line for line in lines if line.startswith("#")]
    names = "engineering_shear_strain [1],friction_of_mean_pressure [1],solid_fraction [1]"
    rows = [f"{strain:.6g},{mu:.6g},{phi:.6g}" for strain, mu, phi in zip(START_STRAINS, *columns, strict=True)]
    path = tmp_path / "start.csv"
    path.write_text("\n".join([*head, names, *rows]) + "\n")
    fit = calibrate(
        LAW, [path], ["dilatancy_coefficient"], {k: v for k, v in values.items() if k != "dilatancy_coefficient"}
    )
    assert fit.values["dilatancy_coefficient"] == pytest.approx(3.0, rel=0.02)


def test_a_dense_packing_is_stronger_at_first_and_dilates(folder):
    data = read_data(folder / START_FILE, get_material(LAW))[0]
    friction, fraction = (measured.values for measured in data.measured)
    steady = read_data(folder / FLOW_FILE, get_material(LAW))[0]
    assert friction[0] > 1.3 * steady.measured[0].values[0]
    assert np.all(np.diff(fraction) < 0.0)


def test_grains_part_where_no_inertial_number_takes_up_the_shear():
    """Looser than phi_min: the search used to run to I = 1e306."""
    parameters = mu_i_phi_i.DEM_SHEAR
    fraction = parameters.loosest_solid_fraction - 8e-4
    increment = mu_i_phi_i.Increment(1e-5, fraction, 5000.0, 120.0, 8e-5)
    assert mu_i_phi_i.flow_of_step(increment, 1.0, parameters) == PARTED


def test_missing_runs_are_told():
    case = case_named("shear")
    assert missing_runs(case, REFERENCE) == []
    assert seeds_told(runs_of(case)) == "liggghts 1 2 3"
    assert Run(case, "liggghts", 1).name in present_runs(REFERENCE)
    answer = CliRunner().invoke(app, ["dem", "list"])
    assert "not in the reference set" in answer.output.replace("\n", " ") or "reference" in answer.output


def test_a_flat_floor_has_the_friction_that_shear_over_a_plane_shows():
    """Below that of the contacts, since grains roll; glued floors keep the contacts' own."""
    reference = read_reference_set()
    friction = flat_friction(reference)
    told = [row["tau_over_p3"] for row in reference.test("wall_shear")]
    assert min(told) * 0.8 < friction < max(told) < ROUGH_FRICTION
    (flat, *_), (glued, *_) = reference.columns("flat"), reference.columns("glued")
    columns = column_of(flat, friction), column_of(glued)
    floors = [column_scene(one, LAW, {}, 0.0125)["boundary"]["bottom"]["coefficient"] for one in columns]
    assert floors == [friction, ROUGH_FRICTION]
