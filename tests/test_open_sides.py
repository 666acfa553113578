"""Open sides: what goes through them is gone, and counted; nothing holds what comes near."""

import math

import numpy as np
import pytest
from scenes_for_tests import MU_I_LC, changed, simulation

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.grid.grid import COMPONENTS, NODE_OF
from grainlaw.mpm_core.output.frame_series import read_collection
from grainlaw.mpm_core.output.history import read_history
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME

G = 9.8
# A layer of 20 x 8 cells half of which lies over nothing: 0.5 m x 0.2 m over an open side.
FALLING = {
    "gravity": [0.0, -G],
    "grid": {"cell_size": 0.025, "upper": [0.5, 0.5]},
    "time": {"end": 0.4},
    "boundary": {"bottom": "open"},
    "material": {"mu_i_lc": MU_I_LC},
    "body": [
        {
            "material": "mu_i_lc",
            "density": 1500.0,
            "shape": {"kind": "rectangle", "lower": [0.0, 0.1], "upper": [0.5, 0.3]},
        }
    ],
    "output": {"interval": 0.02, "history_interval": 0.01, "fields": ["velocity"], "vtkhdf": True},
}
MASS = 1500.0 * 0.5 * 0.2
# It slides over the floor, to the right through an open side.
SLIDING = changed(
    FALLING,
    {
        "boundary": {"right": "open", "bottom": {"kind": "friction", "coefficient": 0.2}},
        "body.0.shape.lower": [0.1, 0.0],
        "body.0.shape.upper": [0.4, 0.1],
        "body.0.velocity": [1.0, 0.0],
    },
)


def balance(case):
    """What is missing of the energy at the start, over what fell."""
    ledger = case.ledger
    return ledger.numerical_dissipation / (ledger.outflow - ledger.potential)


def test_what_falls_through_an_open_floor_leaves_when_it_gets_there():
    case = simulation(FALLING)
    (body,) = case.bodies
    mass, slow = body.masses.sum(), 0.9 * 0.025
    for time in (0.12, 0.16, 0.2, 0.24):
        case.advance_to(time)
        # Nothing but gravity acts; points are taken out at the latest when they are 0.9 cells beyond.
        fallen = 0.5 * G * time**2
        most, least = (min(max(0.0, (way - 0.1) / 0.2), 1.0) for way in (fallen + 0.01, fallen - slow - 0.01))
        assert least <= case.ledger.mass_left / mass <= most
        assert body.count * body.point_mass == pytest.approx(mass - case.ledger.mass_left)
    case.advance_to(0.4)
    assert body.count == 0
    assert case.ledger.mass_left == pytest.approx(MASS)
    # over the floor of the domain nothing is left of the energy of height but in what left
    assert case.ledger.outflow == pytest.approx(MASS * G * 0.2, rel=1e-3)
    assert case.ledger.kinetic == 0.0
    assert abs(balance(case)) < 2e-3


def test_an_open_side_does_not_hold_what_comes_near():
    """The stress of a falling layer stays zero right at the side: no node is tied to others."""
    case = simulation(FALLING)
    (body,) = case.bodies
    while case.time < 0.2:
        case.step(case.next_step(0.2)[0])
        np.testing.assert_allclose(body.velocity[1], -G * (case.time - 0.5 * case.last_step), atol=1e-6)
        assert abs(body.stress).max(initial=0.0) < 1e-6
    assert 0 < body.count < 640


def test_material_that_slides_out_takes_its_energy_along():
    case = simulation(SLIDING)
    (body,) = case.bodies
    start = case.ledger.initial_kinetic
    case.advance_to(0.3)
    ledger = case.ledger
    assert 0.2 < ledger.mass_left / (1500.0 * 0.3 * 0.1) < 0.9
    assert (body.positions[0] < 0.5 + 0.9 * 0.025).all()
    spent = ledger.internal_work + ledger.wall_work + ledger.outflow + ledger.kinetic + ledger.potential
    assert spent + ledger.numerical_dissipation == pytest.approx(start + ledger.volume_projection)
    assert 0.0 <= ledger.numerical_dissipation < 0.25 * start


@pytest.mark.parametrize("space", ["axisymmetric", "3d"])
def test_sides_are_open_in_every_space(space):
    in_3d = {
        "grid": {"cell_size": 0.05, "lower": [0.0, 0.0, 0.0], "upper": [0.3, 0.2, 0.3]},
        "gravity": [0.0, 0.0, -G],
        "boundary": {"bottom": "open", "back": "open"},
        "body.0.shape": {"kind": "box", "lower": [0.05, 0.05, 0.1], "upper": [0.2, 0.2, 0.2]},
        "body.0.velocity": [0.0, 0.3, 0.0],
    }
    around = {"body.0.shape.lower": [0.0, 0.1], "body.0.shape.upper": [0.2, 0.2]}
    case = simulation(FALLING, {"space": space, **(in_3d if space == "3d" else around)})
    mass = sum(body.masses.sum() for body in case.bodies)
    case.advance_to(0.16)
    assert 0.0 < case.ledger.mass_left < mass
    case.advance_to(0.3)
    assert case.ledger.mass_left == pytest.approx(mass)
    assert abs(balance(case)) < 5e-3


def test_a_run_that_loses_everything_ends_well_and_resumes_to_the_same_bits(tmp_path):
    whole, half = tmp_path / "whole", tmp_path / "half"
    summary = run(Scene.from_dict(FALLING), whole)
    assert (summary.points_left, summary.mass_left) == (640, pytest.approx(MASS))
    assert summary.final.center_of_mass_height is None
    assert {path.name for path in whole.glob("*.png")} >= {"final.png", "history.png"}
    history = read_history(whole)
    assert history["mass_left"][-1] == pytest.approx(MASS)
    assert (np.diff(history["mass_left"]) >= 0.0).all()
    assert history["height"][-1] == 0.0
    assert math.isnan(history["center_of_mass_height"][-1])
    counts = [len(RunFolder(whole).load_frame(index).positions) for index in range(len(read_collection(whole)))]
    assert (counts[0], counts[-1]) == (640, 0)
    assert len(set(counts)) > 3

    run(Scene.from_dict(changed(FALLING, {"time.end": 0.18})), half)
    run(Scene.from_dict(FALLING), half, resume=True)
    again = read_history(half)
    for name in set(history.dtype.names) - {"wall_time"}:
        np.testing.assert_array_equal(history[name], again[name])
    for path in whole.glob("*.vtu"):
        assert path.read_bytes() == (half / path.name).read_bytes()

    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(whole / VTKHDF_NAME))
    reader.UpdateInformation()
    for number, count in enumerate(counts):
        reader.SetStep(number)
        reader.Update()
        shown, written = reader.GetOutputDataObject(0), RunFolder(whole).load_frame(number)
        assert shown.GetNumberOfPoints() == shown.GetNumberOfVerts() == count
        if count:
            assert shown.GetPoint(count - 1) == pytest.approx(written.positions[-1])


def test_height_that_is_carried_out_sideways_was_not_released():
    """A layer flies out through a side at the height that it has, but for the little that it falls until then."""
    flying = {"boundary": {"left": "open", "right": "open"}, "body.0.velocity": [10.0, 0.0]}
    case = simulation(FALLING, flying)
    case.advance_to(0.075)
    ledger = case.ledger
    assert ledger.mass_left == pytest.approx(MASS)
    assert ledger.released - ledger.initial_kinetic < MASS * G * 0.5 * G * 0.075**2
    assert -ledger.potential > 10.0 * (ledger.released - ledger.initial_kinetic)


def test_what_leaves_wakes_nobody_and_loses_no_sleeper():
    """A heap sleeps at the left side while a block slides out through the right one."""
    heap = {"kind": "polygon", "vertices": [[0.0, 0.0], [0.1, 0.0], [0.0, 0.04]]}
    bodies = [SLIDING["body"][0], {**SLIDING["body"][0], "velocity": [0.0, 0.0], "shape": heap}]
    case = simulation(
        SLIDING,
        {
            "body": bodies,
            "body.0.shape.lower": [0.3, 0.0],
            "body.0.velocity": [2.0, 0.0],
            "sleep": {"speed": 0.05, "window": 0.01},
        },
    )
    block, rests = case.bodies
    before = 0
    while case.time < 0.3:
        case.step(case.next_step(0.3)[0])
        if rests.awake < rests.count and before == 0:
            before = block.count
    assert before > 0
    assert block.count < before
    nodes = case.sleep.nodes.reshape(-1, COMPONENTS)[:, NODE_OF[2].mass]
    assert nodes.sum() == pytest.approx((rests.count - rests.awake) * rests.point_mass, rel=1e-12)
    assert rests.awake < rests.count
    assert sorted(rests.numbers) == list(range(rests.generated))


def test_an_open_side_is_no_axis_and_no_half_of_a_periodic_pair():
    with pytest.raises(InputError, match="periodic sides come in pairs"):
        simulation(FALLING, {"boundary": {"left": "periodic", "right": "open"}})
    with pytest.raises(InputError, match="the left side is the axis"):
        simulation(FALLING, {"space": "axisymmetric", "boundary": {"left": "open"}})
