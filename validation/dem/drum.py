"""A rough drum that turns: the deck, and how its grains lie and flow, window by window and in the mean."""

from pathlib import Path

import numpy as np

from grainlaw.materials.errors import SimulationError
from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.description import RoughDrum
from grainlaw.validation.dem.liggghts import data_file, decks, flow_values, output_steps, template_texts
from grainlaw.validation.dem.packing import (
    GLUED_DEPTH,
    Array,
    Packing,
    glued_layer,
    loose,
    mean_volume,
    random_radii,
)
from grainlaw.validation.grains.drum import Drum, Flow, mean_flow, mean_of_flows
from grainlaw.validation.grains.snapshot import GrainSnapshot, sphere_volumes

Files = dict[str, str]
# The second table holds mean profiles; what it is called beside the first one.
MEAN = "mean"
TABLE, MEAN_TABLE = "drum.csv", f"{MEAN}.csv"
COLUMNS = ("t", "angle", "torque", "center_x", "center_z", "mass", "layer", "surface_speed")
MEAN_COLUMNS = ("place", "surface", "speed", "solid_fraction")
# Dense enough for a settled packing to reach above the axis.
FILL = 0.63
# Time [s] for which the grains settle after the highest one has reached the bottom.
SETTLING_TIME = 0.5
# Length of a window [s], and places of the mean profiles from side to side.
WINDOW, PLACES = 0.5, 49
# Beyond the glued grains [m].
BESIDE = 0.03


def files(case: RoughDrum, seed: int) -> Files:
    """Deck and data of the run."""
    random = np.random.default_rng(seed)
    wall = glued_drum(case, np.random.default_rng([seed, 1]))
    number = round(FILL * 0.5 * np.pi * case.radius**2 * case.depth / mean_volume(case.grains))
    end = float(np.abs(wall.centres).max()) + BESIDE
    fall = np.sqrt(4.0 * case.radius / case.gravity)
    deck = decks().get_template("drum.in.j2")
    box = np.array([[-end, end], [0.0, case.depth], [-end, end]])
    return {
        "grains.data": data_file(_scattered(case, number, random), wall, case.grains.density, box),
        "deck.in": deck.render(
            **flow_values(case, seed, fall + SETTLING_TIME),
            shell=_glued_radius(case) + 0.5 * case.grains.largest_diameter,
            period=2.0 * np.pi / case.angular_velocity,
            outputs=_outputs(case),
        ),
    }


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "drum.in.j2")


def glued_drum(case: RoughDrum, random: np.random.Generator) -> Packing:
    """A layer of grains, bent to a drum, so far out that the packing begins at the drum's radius."""
    radius = _glued_radius(case)
    flat = glued_layer(case.grains, (0.0, 2.0 * np.pi * radius), (0.0, case.depth), True, random)
    angle = flat.centres[:, 0] / radius
    centres = np.column_stack([radius * np.cos(angle), flat.centres[:, 1], radius * np.sin(angle)])
    return Packing(centres, flat.radii)


def reduce(case: RoughDrum, folder: Path) -> Reduced:
    """Write how the grains lie and what turns them, window by window, and the mean profiles while they flow steadily.

    Torque and mass are per depth.
    """
    torques = np.loadtxt(folder / "torque.txt", comments="#", ndmin=2)
    steps = _outputs(case) * output_steps(case)
    if not len(torques) or torques[-1, 0] < steps:
        raise SimulationError(f"LIGGGHTS stopped before the end; see {folder / 'log.txt'}")
    drum = Drum(case.radius, case.grains.mean_diameter, case.depth)
    looks = round(WINDOW / case.output_interval)
    parts = [torques[start : start + looks] for start in range(0, _outputs(case), looks)]
    flows, rows = [], []
    for part in parts:
        snapshots = [_snapshot(folder, int(step), case.time_step) for step in part[:, 0]]
        flow = mean_flow(snapshots, drum)
        mass = case.grains.density * float(snapshots[-1].solid_volumes.sum()) / case.depth
        time = case.time_step * (part[-1, 0] - 0.5 * looks * output_steps(case))
        torque = float(part[:, 1].mean()) / case.depth
        values = (time, flow.angle, torque, *flow.center, mass, *flow.layer)
        rows.append([f"{value:.5g}" for value in values])
        if time > case.steady_from:
            flows.append(flow)
    write_table(folder / TABLE, COLUMNS, rows)
    write_table(folder / MEAN_TABLE, MEAN_COLUMNS, _profiles(mean_of_flows(flows)))
    return Reduced(steps, snapshots[-1].count, TABLE)


def last_snapshot(case: RoughDrum, folder: Path) -> GrainSnapshot:
    """The grains at the end of a run."""
    return _snapshot(folder, _outputs(case) * output_steps(case), case.time_step)


def _profiles(flow: Flow) -> list[list[str]]:
    """The surface over x, and speed and solid fraction along the normal of the surface, at the same places."""
    places = np.linspace(-flow.drum.radius, flow.drum.radius, PLACES)
    surface = np.interp(places, flow.drum.lattice.x, flow.surface)
    fraction, speed = flow.across(places)
    rows = zip(places, surface, np.where(fraction > 0.0, speed, 0.0), fraction, strict=True)
    return [[f"{value:.4g}" for value in row] for row in rows]


def _snapshot(folder: Path, step: int, time_step: float) -> GrainSnapshot:
    table = np.loadtxt(folder / f"grains_{step:07d}.txt", skiprows=9)
    return GrainSnapshot(step * time_step, table[:, :3], table[:, 3:6], sphere_volumes(table[:, 6]))


def _scattered(case: RoughDrum, number: int, random: np.random.Generator) -> Packing:
    """Grains apart from one another all over the drum, and from its glued grains."""
    radius = _glued_radius(case) - 0.5 * case.grains.largest_diameter
    # The packing fills a cylinder around its third axis.
    space: Array = np.array([[-radius, radius], [-radius, radius], [0.0, case.depth]])
    found = loose(random_radii(case.grains, number, random), space, (False, False, True), random, radius)
    return Packing(found.centres[:, [0, 2, 1]], found.radii)


def _glued_radius(case: RoughDrum) -> float:
    """Of the centres of the glued grains [m]."""
    return case.radius + GLUED_DEPTH * case.grains.mean_diameter


def _outputs(case: RoughDrum) -> int:
    """Of whole windows up to the end."""
    return round(WINDOW / case.output_interval) * round(case.end / WINDOW)
