"""What rests sleeps: it costs nothing, stays where it would be, and wakes when something moves it."""

import math

import numpy as np
import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, COLUMN, changed, simulation

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.grid.grid import COMPONENTS, NODE_OF
from grainlaw.mpm_core.output.checkpoint import Clock, read_checkpoint, write_checkpoint
from grainlaw.mpm_core.output.history import read_history
from grainlaw.mpm_core.output.observables import shape_of
from grainlaw.mpm_core.stepping import sleeping
from grainlaw.validation.scenes import advance

SPEED = 2e-3
PILE = changed(COLUMN, {"material": {"modified_cam_clay": CAM_CLAY}, "body.0.material": "modified_cam_clay"})
ASLEEP = {"sleep": {"speed": SPEED, "start": 0.6}}
END = 1.2
# A layer that rests on the floor, and a block above it that falls.
FALLING = changed(
    COLUMN,
    {
        "grid.upper": [1.0, 1.0],
        "body": [
            {
                "material": "mu_i_lc",
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 0.2]},
                "density": 1500.0,
                "initial_stress": {"kind": "geostatic"},
            },
            {
                "material": "mu_i_lc",
                "shape": {"kind": "rectangle", "lower": [0.4, 0.6], "upper": [0.6, 0.8]},
                "density": 1500.0,
            },
        ],
    },
)


def led_to(content, end, changes=None, threads=1):
    case = simulation(content, changes, threads)
    advance(case, end)
    return case


def shape(case):
    found = shape_of(case)
    return np.array([found.runout, found.height, found.center_of_mass_height])


def way_of_layer(case):
    """How far the points of the first body have come in the mean [m]."""
    start, body = simulation(FALLING).bodies[0].positions, case.bodies[0]
    now = np.empty_like(start)
    now[:, body.ids - body.first_id] = body.positions
    return np.hypot(*(now - start)).mean()


def awake(case):
    return sum(body.awake for body in case.bodies) / sum(body.count for body in case.bodies)


@pytest.fixture(scope="module")
def piles():
    """The pile of the column, without and with sleep."""
    return led_to(PILE, END), led_to(PILE, END, ASLEEP)


def test_the_pile_sleeps_and_is_where_it_would_be(piles):
    without, asleep = piles
    assert awake(without) == 1.0
    assert awake(asleep) < 0.6
    assert np.abs(shape(asleep) / shape(without) - 1.0).max() < 1e-3


def test_what_slides_may_not_sleep(piles):
    """The negative control of the test above."""
    without, _ = piles
    asleep = led_to(PILE, END, {"sleep": {"speed": 0.5, "start": 0.3}})
    assert np.abs(shape(asleep) / shape(without) - 1.0).max() > 1e-2


def test_sleeping_points_keep_their_state(piles):
    _, asleep = piles
    (body,) = asleep.bodies
    before = body.points[:, body.awake :].copy(), body.ids[body.awake :].copy()
    advance(asleep, END + 0.02)
    kept = np.isin(before[1], body.ids[body.awake :])
    order = np.argsort(body.ids)
    after = body.points[:, order[before[1] - body.first_id]]
    assert kept.mean() > 0.5
    assert (after[:, kept] == before[0][:, kept]).all()
    assert not body.velocity[:, body.awake :].any()


def test_no_point_is_lost_and_the_mass_of_sleepers_is_on_their_nodes(piles):
    _, asleep = piles
    (body,) = asleep.bodies
    assert sorted(body.ids) == list(range(body.count))
    nodes = asleep.sleep.nodes.reshape(-1, COMPONENTS)
    assert nodes[:, NODE_OF[2].mass].sum() == pytest.approx((body.count - body.awake) * body.point_mass, rel=1e-12)
    assert not nodes[:, NODE_OF[2].momentum : NODE_OF[2].momentum + 2].any()


def test_what_something_falls_on_wakes():
    settings = {"time.end": 0.9, "sleep": {"speed": SPEED, "window": 0.02}}
    case = simulation(FALLING, settings)
    advance(case, 0.15)
    layer = case.bodies[0]
    assert layer.awake == 0
    advance(case, 0.35)
    assert layer.awake > 0
    advance(case, 0.9)
    without = led_to(FALLING, 0.9)
    assert np.abs(shape(case) / shape(without) - 1.0).max() < 0.02
    assert way_of_layer(case) == pytest.approx(way_of_layer(without), rel=0.2)


def test_a_layer_that_nothing_wakes_does_not_give_way(monkeypatch):
    """The negative control of the test above: it would see a layer that sleeps through the impact."""
    monkeypatch.setattr(sleeping, "WAKING", math.inf)
    case = led_to(FALLING, 0.9, {"time.end": 0.9, "sleep": {"speed": SPEED, "window": 0.02}})
    assert case.bodies[0].awake == 0
    assert way_of_layer(case) < 0.5 * way_of_layer(led_to(FALLING, 0.9))


def across(shift):
    """How a block that another runs into across a gap came to lie, in a frame that is shifted around periodic sides."""

    def block(lower, velocity):
        corner = (lower + shift) % 1.0
        shape = {"kind": "rectangle", "lower": [corner, 0.2], "upper": [corner + 0.3, 0.6]}
        return {"material": "linear_elastic", "density": 1000.0, "velocity": [velocity, 0.0], "shape": shape}

    case = simulation(
        BLOCK,
        {
            "boundary": {"left": "periodic", "right": "periodic"},
            "grid.cell_size": 0.025,
            "body": [block(0.0, 0.0), block(0.5, 0.5)],
            "sleep": {"speed": 1e-3, "window": 0.01},
        },
    )
    rests = case.bodies[0]
    asleep = []
    for time in (0.3, 0.36, 0.5):
        advance(case, time)
        asleep.append(rests.count - rests.awake)
    x, y = rests.positions[:, np.argsort(rests.ids)]
    return asleep, np.stack([(x - shift + 0.25) % 1.0, y])


def test_sleep_does_not_see_where_periodic_sides_are():
    """The one runs into the other across the seam, or in the middle of the domain."""
    asleep, positions = across(0.5)
    assert asleep[0] == 768 > asleep[1] > 0 == asleep[2]
    asleep_at_seam, positions_at_seam = across(0.0)
    assert asleep_at_seam == asleep
    np.testing.assert_allclose(positions_at_seam, positions, atol=1e-12)


def test_nothing_sleeps_that_moves_steadily():
    moving = {"body.0.velocity": [0.5, 0.0], "sleep": {"speed": SPEED, "window": 0.01}}
    case = led_to(BLOCK, 0.1, moving)
    assert awake(case) == 1.0
    still = led_to(BLOCK, 0.1, {**moving, "body.0.velocity": [0.0, 0.0]})
    assert awake(still) == 0.0


def test_threads_leave_no_trace():
    one, two = (led_to(PILE, 1.0, ASLEEP, threads) for threads in (1, 2))
    assert 0.0 < awake(one) < 1.0
    assert (one.bodies[0].points == two.bodies[0].points).all()
    assert one.bodies[0].awake == two.bodies[0].awake


def test_a_run_asleep_goes_on_to_the_same_bits(tmp_path):
    whole = led_to(PILE, 1.0, ASLEEP)
    assert 0.0 < awake(whole) < 1.0
    write_checkpoint(tmp_path, whole, Clock())
    resumed = simulation(PILE, ASLEEP)
    read_checkpoint(tmp_path, resumed)
    for case in (whole, resumed):
        advance(case, END)
    assert whole.steps == resumed.steps
    assert whole.bodies[0].awake == resumed.bodies[0].awake
    assert (whole.bodies[0].points == resumed.bodies[0].points).all()
    assert whole.ledger == resumed.ledger


def test_what_is_withheld_goes_on_to_the_same_bits_while_points_drift(tmp_path):
    """Between two sorts points have drifted: the nodes that they reach now are not those that were held so far."""
    settings = {"time.end": 0.9, "sleep": {"speed": SPEED, "window": 0.02}}
    whole = led_to(FALLING, 0.265, settings)
    assert 0.0 < awake(whole) < 1.0
    assert whole.drift > 0.0
    write_checkpoint(tmp_path, whole, Clock())
    resumed = simulation(FALLING, settings)
    read_checkpoint(tmp_path, resumed)
    for case in (whole, resumed):
        advance(case, 0.267)
    assert whole.sleep.withheld.any()
    assert (whole.sleep.withheld == resumed.sleep.withheld).all()


def test_the_history_tells_what_sleeps(tmp_path):
    run(Scene.from_dict(changed(PILE, {**ASLEEP, "time.end": END, "output": {"pictures": False}})), tmp_path)
    history = read_history(tmp_path)
    assert not history["points_asleep"][history["t"] < 0.65].any()
    assert history["points_asleep"][-1] > 0


def test_where_everything_sleeps_nothing_happens():
    case = led_to(BLOCK, 0.1, {"sleep": {"speed": SPEED, "window": 0.01}})
    assert awake(case) == 0.0
    assert np.isfinite(case.bodies[0].points).all()
    assert case.ledger.kinetic == 0.0


def test_settings_of_sleep_are_checked():
    with pytest.raises(InputError, match=r"sleep\.speed"):
        simulation(COLUMN, {"sleep": {"speed": -1.0}})
