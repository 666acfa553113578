"""Grains in a turning drum beside the material points of a law.

`python -m grainlaw.validation.report.drum_picture RUN PNG` draws it; RUN is the folder of a run that
`grainlaw dem run drum-r0.3` left.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure as Canvas

from grainlaw.validation.cases.obstacles.drum_grains import scene
from grainlaw.validation.cases.obstacles.hopper_grains import laws_fitted
from grainlaw.validation.dem.description import RoughDrum
from grainlaw.validation.dem.drum import last_snapshot
from grainlaw.validation.dem.runs import RECORD
from grainlaw.validation.grains.material_points import DEPTH, snapshot_of_bodies
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, sphere_diameters
from grainlaw.validation.reference.reference_set import read_reference_set
from grainlaw.validation.scenes import advance, simulation_of

LAW, CELLS = "mu_i_state", 24
FASTEST, RESOLUTION = 0.8, 110  # speed at the end of the colours [m/s]


@dataclass(frozen=True)
class Panel:
    """What is drawn: grains or points, and the diameter of each (n,) [m]."""

    title: str
    snapshot: GrainSnapshot
    diameters: Array


def panels(run: Path) -> tuple[RoughDrum, list[Panel]]:
    """The last look at the grains of a run, and at the law when its drum has turned as far."""
    record = json.loads((run / RECORD).read_text(encoding="utf-8"))
    case = RoughDrum.model_validate(record["description"])
    grains = last_snapshot(case, run)
    mass = case.grains.density * float(grains.solid_volumes.sum()) / case.depth
    (law,) = laws_fitted(read_reference_set(), (LAW,))
    simulation = simulation_of(scene(case, law, mass, CELLS))
    advance(simulation, grains.time)
    points = snapshot_of_bodies(simulation.time, simulation.bodies, case.grains.density)
    sides = np.sqrt(np.concatenate([body.volume for body in simulation.bodies]) / DEPTH)
    return case, [
        Panel("grains", grains, sphere_diameters(grains.solid_volumes)),
        Panel(law.judged.title, points, sides),
    ]


def draw(drum: RoughDrum, shown: list[Panel], path: Path) -> None:
    """Side by side, coloured by speed, what lies nearer over what lies behind."""
    canvas = Canvas(figsize=(4.0 * len(shown) + 0.9, 4.0), layout="constrained")
    for panel, axes in zip(shown, canvas.subplots(1, len(shown), squeeze=False)[0], strict=True):
        colours = _draw(axes, panel, drum.radius)
    canvas.colorbar(colours, ax=canvas.axes, label="speed [m/s]", shrink=0.8)
    canvas.savefig(path, dpi=RESOLUTION)


def _draw(axes: Axes, panel: Panel, radius: float) -> EllipseCollection:
    snapshot, reach = panel.snapshot, 1.05 * radius
    order = np.argsort(-snapshot.positions[:, 1])
    sizes = panel.diameters[order]
    colours = EllipseCollection(
        sizes,
        sizes,
        np.zeros_like(sizes),
        units="xy",
        offsets=snapshot.positions[order][:, [0, 2]],
        offset_transform=axes.transData,
        array=np.hypot(*snapshot.velocities[order][:, [0, 2]].T),
        cmap="viridis",
        clim=(0.0, FASTEST),
    )
    axes.add_collection(colours)
    angles = np.linspace(0.0, 2.0 * np.pi, 200)
    axes.plot(radius * np.cos(angles), radius * np.sin(angles), color="#333333", lw=1.0)
    axes.set(title=panel.title, xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    axes.axis("off")
    return colours


if __name__ == "__main__":
    draw(*panels(Path(sys.argv[1])), Path(sys.argv[2]))
