"""The rough drum of grains: its deck, and what its reduction makes of a flow with a known surface."""

import csv
import math

import numpy as np
import pytest
from matplotlib.image import imread

from grainlaw.materials import SimulationError
from grainlaw.validation.cases.obstacles.drum_grains import scene, turning_grains
from grainlaw.validation.dem import drum
from grainlaw.validation.dem.catalogue import drum as drum_case
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.judged_laws import JUDGED_LAWS
from grainlaw.validation.dem.reduction import reduce_runs
from grainlaw.validation.dem.runs import RECORD
from grainlaw.validation.grains.drum import Drum, mean_flow
from grainlaw.validation.grains.snapshot import GrainSnapshot
from grainlaw.validation.reference.reference_set import ReferenceSet
from grainlaw.validation.report.drum_picture import FASTEST, Panel, draw
from grainlaw.validation.scenes import simulation_of

RADIUS, SPACING, FRACTION = 0.3, 0.01, 0.6
# A surface at 30 degrees, 10 mm below the axis; down it runs what is within 50 mm of it.
ANGLE, DEPTH_OF_SURFACE, LAYER, SHEAR = 30.0, 0.01, 0.05, 4.0
CASE = drum_case(RADIUS)
HALF_SECOND = CASE.model_copy(
    update={"transient_angle": 0.1 * CASE.angular_velocity, "averaged_angle": 0.4 * CASE.angular_velocity}
)


def flowing(angle: float = ANGLE) -> GrainSnapshot:
    """A square lattice of points, a square of it each, below a straight surface: shear over a layer, at rest below."""
    side = np.arange(-RADIUS, RADIUS, SPACING) + 0.5 * SPACING
    x, z = (of.ravel() for of in np.meshgrid(side, side))
    slope = math.radians(angle)
    up = np.array([math.cos(slope), math.sin(slope)])
    below = -DEPTH_OF_SURFACE - (-x * up[1] + z * up[0])
    inside = (np.hypot(x, z) < RADIUS) & (below > 0.0)
    speed = SHEAR * (LAYER - below[inside])
    places = np.column_stack([x, np.full_like(x, 0.03), z])[inside]
    velocities = np.column_stack([-speed * up[0], np.zeros_like(speed), -speed * up[1]])
    return GrainSnapshot(0.0, places, velocities, np.full(len(places), FRACTION * SPACING**2 * CASE.depth))


def write_run(folder, torque: float) -> GrainSnapshot:
    """What LIGGGHTS leaves of ten looks at such a flow, its surface rising from 26.25 to 33.75 degrees."""
    lines = ["# Time-averaged data for fix torque", "# TimeStep c_moment"]
    for look in range(10):
        snapshot = flowing(ANGLE + (look - 4.5) / 1.2)
        step = 1000 * (look + 1)
        radii = np.cbrt(snapshot.solid_volumes / (4.0 / 3.0 * np.pi))
        table = np.column_stack([snapshot.positions, snapshot.velocities, radii])
        np.savetxt(folder / f"grains_{step:07d}.txt", table, fmt="%.7g", header="\n".join(["ITEM"] * 9), comments="")
        lines.append(f"{step} {torque + look - 4.5}")
    (folder / "torque.txt").write_text("\n".join(lines) + "\n")
    return snapshot


def rows(path) -> list[dict[str, float]]:
    with path.open() as file:
        return [{name: float(text) for name, text in row.items() if name != "code"} for row in csv.DictReader(file)]


@pytest.mark.parametrize("angle", [0.0, 23.0, 37.0])
def test_angle_layer_and_speed_of_a_known_flow(angle):
    flow = mean_flow([flowing(angle)], Drum(RADIUS, 0.015, CASE.depth))
    assert flow.angle == pytest.approx(angle, abs=0.3)
    assert flow.line[1] == pytest.approx(-DEPTH_OF_SURFACE / math.cos(math.radians(angle)), abs=1e-3)
    thickness, speed = flow.layer
    # At half of its solid fraction the surface shows the mean over half a Gaussian: 0.8 widths deeper.
    assert thickness == pytest.approx(LAYER, abs=2e-3)
    assert speed == pytest.approx(SHEAR * (LAYER - 0.8 * 0.015), rel=0.03)
    fraction, speed = flow.across(np.array([-0.2, -0.1]))
    assert fraction == pytest.approx([FRACTION, FRACTION], rel=0.01)
    assert speed == pytest.approx([SHEAR * (LAYER - 0.19), SHEAR * (LAYER - 0.09)], rel=0.01)


def test_nothing_that_flows_has_no_layer():
    lying = flowing()
    at_rest = GrainSnapshot(0.0, lying.positions, 0.0 * lying.velocities, lying.solid_volumes)
    assert all(map(math.isnan, mean_flow([at_rest], Drum(RADIUS, 0.015, CASE.depth)).layer))


def test_reduction_of_a_window(tmp_path):
    run = tmp_path / "runs" / CASE.name / "liggghts-seed1"
    run.mkdir(parents=True)
    write_run(run, torque=12.0)
    found = drum.reduce(HALF_SECOND, run)
    record = f'{{"case": "{CASE.name}", "kind": "rough-drum", "code": "liggghts", "seed": 1, "table": "{found.table}"}}'
    (run / RECORD).write_text(record)
    reduce_runs(tmp_path / "runs", tmp_path / "reference")
    (window,) = rows(tmp_path / "reference" / "drum_r0.3.csv")
    assert found.steps == 10000
    assert window["t"] == pytest.approx(0.25)
    assert window["angle"] == pytest.approx(ANGLE, abs=0.3)
    assert window["torque"] == pytest.approx(12.0 / CASE.depth)
    # The part of a disc below a chord at d: its area, and the first moment 2/3 (R^2 - d^2)^(3/2).
    half = math.acos(DEPTH_OF_SURFACE / RADIUS)
    area = RADIUS**2 * half - DEPTH_OF_SURFACE * RADIUS * math.sin(half)
    arm = 2.0 / 3.0 * (RADIUS**2 - DEPTH_OF_SURFACE**2) ** 1.5 / area
    assert window["mass"] == pytest.approx(FRACTION * 2450.0 * area, rel=0.01)
    assert window["center_x"] == pytest.approx(arm * math.sin(math.radians(ANGLE)), rel=0.02)
    assert window["center_z"] == pytest.approx(-arm * math.cos(math.radians(ANGLE)), rel=0.02)
    mean = rows(tmp_path / "reference" / "drum_r0.3_mean.csv")
    places, surface = (np.array([row[name] for row in mean]) for name in ("place", "surface"))
    middle = np.abs(places) < 0.2
    line = math.tan(math.radians(ANGLE)) * places - DEPTH_OF_SURFACE / math.cos(math.radians(ANGLE))
    assert surface[middle] == pytest.approx(line[middle], abs=4e-3)


def test_a_run_that_stopped_is_refused(tmp_path):
    (tmp_path / "torque.txt").write_text("# TimeStep c_moment\n1000 1.0\n")
    with pytest.raises(SimulationError, match="stopped before the end"):
        drum.reduce(HALF_SECOND, tmp_path)


def test_deck_turns_a_closed_layer_about_the_axis_and_fills_it():
    small = CASE.model_copy(update={"radius": 0.12})
    made = drum.files(small, 1)
    body = made["grains.data"].partition("Atoms\n\n")[2]
    table = np.array([[float(text) for text in line.split()] for line in body.splitlines()])
    grain, glued = (table[table[:, 1] == kind] for kind in (1, 2))
    radius = np.hypot(glued[:, 4], glued[:, 6])
    assert radius == pytest.approx(np.full(len(glued), 0.126))
    covered = np.sum(np.pi / 4.0 * glued[:, 2] ** 2) / (2.0 * np.pi * 0.126 * small.depth)
    assert 0.50 < covered < 0.60
    assert np.all(np.hypot(grain[:, 4], grain[:, 6]) + 0.5 * grain[:, 2] < 0.126)
    solid = np.pi / 6.0 * np.sum(grain[:, 2] ** 3) / (0.5 * np.pi * 0.12**2 * small.depth)
    assert solid == pytest.approx(drum.FILL, rel=0.03)
    turned = float(made["deck.in"].partition("move rotate 0 0 0 0 -1 0 ")[2].split()[0])
    assert (2.0 * np.pi / turned) ** 2 * small.radius / small.gravity == pytest.approx(small.froude_number)


def test_a_law_gets_the_mass_of_the_grains():
    law = next(one for one in JUDGED_LAWS if one.law == "mu_i_lc")
    numbers = {"static_friction": 0.5, "dynamic_friction": 0.9, "inertial_number_constant": 0.25, "bulk_modulus": 3e5}
    parameters = {**numbers, "poisson_ratio": 0.2, "grain_density": 2450.0, "grain_diameter": 0.015}
    simulation = simulation_of(scene(CASE, FittedLaw(law, parameters, (), (), "", ((), ())), 210.0, 12))
    (body,) = simulation.bodies
    assert body.masses.sum() == pytest.approx(210.0, rel=0.02)


def test_only_steady_windows_are_read():
    windows = [
        {"seed": 1.0, "t": at, "angle": angle, "torque": 9.81 * 0.05 * 200.0, "center_x": 0.05, "mass": 200.0}
        for at, angle in ((1.0, 50.0), (CASE.steady_from + 0.5, 36.0), (CASE.steady_from + 1.0, 38.0))
    ]
    mean = [{"seed": 1.0, "place": 0.0, "surface": 0.1, "speed": 0.2, "solid_fraction": 0.5}]
    ((packing, mass),) = turning_grains(ReferenceSet({}, {"drum_r0.3": windows, "drum_r0.3_mean": mean}), CASE)
    assert (packing.angle, mass) == (37.0, 200.0)
    assert packing.torque.error == pytest.approx(0.0)
    assert (packing.surface, packing.across) == (([0.0], [0.1]), ([0.0], [0.2]))


def test_picture_shows_the_nearer_grain_in_the_colour_of_its_speed(tmp_path):
    """A fast grain in front of a slow one of the same size hides it."""
    places = np.array([[0.0, 0.01, 0.0], [0.0, 0.05, 0.0]])
    speeds = np.array([[0.0, 0.0, FASTEST], [0.0, 0.0, 0.0]])
    pair = GrainSnapshot(0.0, places, speeds, np.ones(2))
    draw(CASE, [Panel("two", pair, np.full(2, RADIUS))], tmp_path / "drum.png")
    image = imread(tmp_path / "drum.png")[..., :3]
    fast, slow = (
        (np.abs(image - np.array(of) / 255.0) < 0.02).all(axis=2).sum() for of in ((253, 231, 37), (68, 1, 84))
    )
    assert fast > 5000
    assert slow < 0.02 * fast
