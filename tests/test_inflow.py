"""Inflows: material enters at its rate and its speed, where there is room, and is counted."""

import warnings

import numpy as np
import pytest
from scenes_for_tests import MU_I_LC, changed, simulation, write_scene
from typer.testing import CliRunner

from grainlaw.cli.main import app
from grainlaw.materials import InputError
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.output.history import read_history
from grainlaw.mpm_core.output.run_folder import RunFolder

G, DENSITY, SPEED = 9.8, 1500.0, 1.0
# Material that slides through a channel, in at the left and out at the right, 20 x 8 cells.
CHANNEL = {
    "gravity": [0.0, 0.0],
    "grid": {"cell_size": 0.025, "upper": [0.5, 0.2]},
    "time": {"end": 0.75},
    "boundary": {"left": "open", "right": "open"},
    "material": {"mu_i_lc": MU_I_LC},
    "body": [
        {
            "material": "mu_i_lc",
            "density": DENSITY,
            "velocity": [SPEED, 0.0],
            "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.5, 0.2]},
        }
    ],
    "inflow": [
        {
            "name": "feed",
            "material": "mu_i_lc",
            "density": DENSITY,
            "velocity": [SPEED, 0.0],
            "shape": {"kind": "strip", "ends": [[0.0, 0.0], [0.0, 0.2]]},
        }
    ],
    "output": {"interval": 0.05, "history_interval": 0.025, "fields": ["velocity"], "pictures": False},
}
# A stream that falls out of the domain again, through an open floor.
STREAM = changed(
    CHANNEL,
    {
        "gravity": [0.0, -G],
        "grid.upper": [0.2, 1.0],
        "time.end": 0.5,
        "boundary": {"bottom": "open"},
        "body": [],
        "inflow.0.velocity": [0.0, -SPEED],
        "inflow.0.shape.ends": [[0.05, 0.95], [0.15, 0.95]],
    },
)
# A stream into a box that is full soon.
FILLED = changed(
    STREAM,
    {
        "grid.upper": [0.2, 0.3],
        "time.end": 0.6,
        "boundary.bottom": {"kind": "friction", "coefficient": 0.5},
        "inflow.0.shape.ends": [[0.05, 0.25], [0.15, 0.25]],
    },
)
# A stream onto a layer that sleeps, until it reaches the mouth.
FED_PILE = changed(
    FILLED,
    {
        "grid.upper": [1.0, 0.3],
        "time.end": 0.8,
        "sleep": {"speed": 0.02, "window": 0.03},
        "body": [
            {
                "material": "mu_i_lc",
                "density": DENSITY,
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 0.1]},
                "initial_stress": {"kind": "geostatic"},
            }
        ],
        "inflow.0.shape.ends": [[0.05, 0.2], [0.15, 0.2]],
        "inflow.0.start": 0.2,
        "output.vtkhdf": True,
    },
)


@pytest.fixture(scope="module")
def channel():
    """The channel after its content has been exchanged once and a half."""
    case = simulation(CHANNEL)
    case.advance_to(0.75)
    return case


def test_a_plug_goes_through_a_channel_as_it_is(channel):
    old, new = channel.bodies
    assert (old.count, new.count) == (0, 640)
    np.testing.assert_allclose(new.velocity, [[SPEED], [0.0]] * np.ones(640), atol=1e-12)
    np.testing.assert_allclose(new.density, DENSITY, rtol=1e-12)
    assert np.abs(new.stress).max() < 1e-6
    # on the lattice that the cells ask for
    off = (np.sort(np.unique(new.positions[0].round(9))) - new.positions[0].min()) / 0.0125
    np.testing.assert_allclose(off, np.arange(40), atol=1e-6)
    np.testing.assert_allclose(np.unique(new.positions[1].round(9)), 0.0125 * (np.arange(16) + 0.5), atol=1e-9)


def test_mass_enters_at_its_rate_and_the_balance_closes(channel):
    ledger = channel.ledger
    assert ledger.mass_in == pytest.approx(DENSITY * SPEED * 0.2 * 0.75, rel=1e-12)
    assert ledger.mass_left == pytest.approx(ledger.mass_in, rel=1e-12)
    assert ledger.inflow == pytest.approx(0.5 * ledger.mass_in * SPEED**2, rel=1e-12)
    assert abs(ledger.numerical_dissipation) < 1e-12 * ledger.released
    assert ledger.released == pytest.approx(ledger.initial_kinetic + ledger.inflow)


def test_a_stream_falls_freely():
    case = simulation(STREAM)
    case.advance_to(0.5)
    (body,) = case.bodies
    fallen = 0.95 - body.positions[1]
    off = -body.velocity[1] / np.sqrt(SPEED**2 + 2.0 * G * fallen) - 1.0
    assert np.abs(off).max() < 0.05  # in the first cell, where the stream ends
    assert np.abs(off[fallen > 0.1]).max() < 1e-2
    assert fallen.max() > 0.9
    ledger = case.ledger
    assert ledger.mass_in == pytest.approx(DENSITY * SPEED * 0.1 * 0.5, rel=1e-12)
    assert abs(ledger.numerical_dissipation) < 2e-3 * ledger.released


def test_a_stream_that_stops_tells_where_its_energy_went(tmp_path):
    scene = changed(FILLED, {"output.pictures": False})
    told = []
    for end in (0.1, 0.4):  # the stream still falls; it has met the floor
        file = write_scene(tmp_path / "stream.toml", changed(scene, {"time.end": end}))
        answer = CliRunner().invoke(app, ["run", str(file), "--out", str(tmp_path / f"{end:g}"), "--threads", "1"])
        assert answer.exit_code == 0
        told.append(
            "of the energy released; transfers take it, most where loose material comes together" in answer.output
        )
    assert told == [False, True]


def test_what_enters_finds_room_or_waits_and_says_so():
    case = simulation(FILLED)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", InputWarning)
        case.advance_to(0.6)
    blocked = [str(one.message) for one in said if "blocked" in str(one.message)]
    assert len(blocked) == 1
    assert blocked[0].startswith("t = 0.")
    assert "inflow 'feed'" in blocked[0]
    assert case.ledger.mass_in < 0.9 * DENSITY * SPEED * 0.1 * 0.6
    (body,) = case.bodies
    assert body.count * body.point_mass == pytest.approx(case.ledger.mass_in)
    # the box never holds more than it can: what comes packs no denser than it comes in
    from grainlaw.mpm_core.output.observables import interior_overfill

    assert abs(interior_overfill(case).mean) < 0.03


@pytest.mark.parametrize("space", ["axisymmetric", "3d"])
def test_mass_enters_at_its_rate_in_every_space(space):
    at = {"space": space, "inflow.0.shape.ends": [[0.0, 0.95], [0.1, 0.95]]}
    area = 0.5 * 0.1**2
    if space == "3d":
        disc = {"kind": "disc", "center": [0.1, 0.1, 0.95], "radius": 0.06}
        at = {
            "space": "3d",
            "gravity": [0.0, 0.0, -G],
            "grid": {"cell_size": 0.025, "upper": [0.2, 0.2, 1.0]},
            "inflow": [{**STREAM["inflow"][0], "velocity": [0.0, 0.0, -SPEED], "shape": disc}],
        }
        area = np.pi * 0.06**2
    case = simulation(STREAM, at)
    for time in (0.1, 0.2):
        case.advance_to(time)
        assert case.ledger.mass_in == pytest.approx(DENSITY * SPEED * area * time, rel=1e-12)
    (body,) = case.bodies
    assert body.masses.sum() == pytest.approx(case.ledger.mass_in)
    fallen = 0.95 - body.positions[-1]
    off = -body.velocity[-1] / np.sqrt(SPEED**2 + 2.0 * G * fallen) - 1.0
    assert np.abs(off[fallen > 0.1]).max() < 1e-2
    assert abs(case.ledger.numerical_dissipation) < 5e-3 * case.ledger.released


def test_an_oblique_mouth_feeds_by_what_goes_through_it():
    case = simulation(
        CHANNEL,
        {
            "space": "3d",
            "gravity": [0.0, 0.0, 0.0],
            "grid": {"cell_size": 0.05, "upper": [0.4, 0.4, 0.4]},
            "body": [],
            "inflow.0.shape": {"kind": "rectangle", "lower": [0.0, 0.1, 0.1], "upper": [0.0, 0.3, 0.25]},
            "inflow.0.velocity": [0.6, 0.0, 0.1],
            "inflow.0.start": 0.1,
            "inflow.0.until": 0.3,
        },
    )
    case.advance_to(0.35)
    entered = DENSITY * 0.6 * 0.03 * 0.2
    assert abs(case.ledger.mass_in - entered) <= 0.5 * DENSITY * 0.025 * 0.03
    (body,) = case.bodies
    np.testing.assert_allclose(body.velocity, [[0.6], [0.0], [0.1]] * np.ones(body.count), atol=1e-9)


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_run_that_is_fed_is_the_same_on_two_threads_and_resumed(tmp_path, precision):
    content = changed(FED_PILE, {"precision": precision})
    whole, half = tmp_path / "whole", tmp_path / "half"
    with pytest.warns(InputWarning, match="blocked"):
        summary = run(Scene.from_dict(content), whole)
    assert summary.points_in > 80
    assert summary.points_left == 0
    assert summary.mass_in == pytest.approx(summary.points_in * DENSITY * 0.0125**2)
    history = read_history(whole)
    asleep = history["points_asleep"]
    assert asleep[(history["t"] > 0.3) & (history["mass_in"] > 0.0)].min() > 0
    assert asleep[-1] < asleep.max()
    assert (np.diff(history["mass_in"]) >= 0.0).all()
    counts = [len(RunFolder(whole).load_frame(index).positions) for index in (0, -1)]
    assert counts == [summary.points, summary.points + summary.points_in]
    with pytest.warns(InputWarning, match="blocked"):
        run(Scene.from_dict(changed(content, {"time.end": 0.55})), half, threads=2)
    run(Scene.from_dict(content), half, threads=2, resume=True)
    again = read_history(half)
    for name in set(history.dtype.names) - {"wall_time"}:
        np.testing.assert_array_equal(history[name], again[name])
    for path in whole.glob("*.vtu"):
        assert path.read_bytes() == (half / path.name).read_bytes()


def test_pictures_of_a_run_that_begins_with_nothing(tmp_path):
    run(Scene.from_dict(changed(STREAM, {"time.end": 0.1, "output.pictures": True})), tmp_path / "fed")
    assert {path.name for path in (tmp_path / "fed").glob("*.png")} == {"final.png", "history.png", "snapshots.png"}
    late = {"time.end": 0.1, "output.pictures": True, "inflow.0.start": 0.2}
    run(Scene.from_dict(changed(STREAM, late)), tmp_path / "late")
    assert {path.name for path in (tmp_path / "late").glob("*.png")} == {"history.png"}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"body": [], "inflow": []}, r"body = \[\]: allowed: 1 or more entries, or an \[\[inflow\]\]"),
        ({"inflow.0.material": "mu_i_lk"}, r"inflow\.0\.material = 'mu_i_lk': did you mean 'mu_i_lc'\?"),
        ({"inflow.0.velocity": [0.0, 1.0]}, r"inflow\.0\.velocity = \[0\.0, 1\.0\] goes along the mouth"),
        ({"inflow.0.velocity": [0.0, 0.0]}, "velocity is zero"),
        ({"inflow.0.velocity": [0.0, 0.0, 1.0]}, r"inflow\.0\.velocity = .*takes 2 components, x, y"),
        ({"inflow.0.shape": {"kind": "disc", "center": [0.0, 0.0, 0.0], "radius": 0.1}}, "allowed in space .*: strip"),
        ({"inflow.0.shape.ends": [[0.0, 0.0], [0.0, 0.3]]}, r"8 of its 24 points would enter outside the domain"),
        ({"inflow.0.shape.ends": [[0.0, 0.0], [0.0, 0.005]]}, "narrower than a point, whose spacing is 0.0125 m"),
        ({"boundary.left": "free_slip"}, 'begins 0 m from the left side, a free_slip wall.*boundary.left = "open"'),
        ({"inflow.0.until": 0.5, "inflow.0.start": 0.5}, "until = 0.5 s is not after start"),
        ({"inflow.0.points_per_cell": 8}, r"inflow\.0\.points_per_cell = 8: allowed: 1, 4"),
        ({"inflow": [CHANNEL["inflow"][0]] * 2}, r"inflow\.1\.name = 'feed': there is another of that name"),
        ({"space": "axisymmetric", "boundary.left": "free_slip"}, "material enters along the axis"),
        (
            {
                "obstacle": [
                    {
                        "name": "block",
                        "friction": 0.3,
                        "shape": {"kind": "rectangle", "lower": [-0.1, -0.1], "upper": [0.1, 0.3]},
                    }
                ],
                "body.0.shape.lower": [0.2, 0.0],
            },
            "would enter inside obstacle 'block'",
        ),
    ],
)
def test_an_inflow_that_cannot_be_is_refused_in_a_line(changes, message):
    with pytest.raises(InputError, match=message) as refused:
        simulation(CHANNEL, changes)
    assert "\n" not in str(refused.value)
