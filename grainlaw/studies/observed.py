"""How the runs of a study are looked at: as grains are, with one kernel, so that all profiles mean the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, Space
from grainlaw.validation.grains.distance import refuse_other_size
from grainlaw.validation.grains.material_points import grain_diameter, snapshot_of_bodies
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import observe
from grainlaw.validation.grains.reference_file import load_reference
from grainlaw.validation.grains.run_observation import as_grains, observe_run

# Without grains a surface is smoothed over as many cells.
WIDTH_IN_CELLS = 2.0


@dataclass(frozen=True)
class Observing:
    """A kernel's width [m], a density of grains for laws that declare none [kg/m3], the space, and the grains given."""

    width: float
    density: float
    space: Space
    grains: tuple[Observation, ...]

    def observe(self, folder: Path) -> Observation:
        """What a finished run shows. Raises InputError for a folder without frames."""
        return observe_run(folder, self.width, self.density, self.space)


def observing(scene: Scene, paths: Sequence[Path]) -> Observing:
    """With the kernel of the grains, else as wide as a grain of the law, else two cells.

    Raises InputError in one line for what cannot be read of the grains, and for grains of another column.
    """
    bodies = build_bodies(scene)
    diameter = grain_diameter(bodies)
    grains = tuple(load_reference(path, diameter) for path in paths)
    widths = [float(found.description["kernel_width"]) for found in grains]
    width = float(np.mean(widths)) if widths else diameter or WIDTH_IN_CELLS * scene.grid.cell_size
    densities = {float(found.description.get("grain_density") or 0.0) for found in grains} - {0.0}
    # A surface lies where the solid fraction is half of that inside: the grains' density is a common factor.
    density = densities.pop() if len(densities) == 1 else float(max(section.density for section in scene.body))
    space = scene.in_space if scene.in_space.axes == 2 else PLANE_STRAIN
    if grains:
        space = grains[0].space
    elif scene.in_space.hoop:
        space = AXISYMMETRIC
    for found in grains:
        refuse_other_size(_start(scene, bodies, width, density, space), found)
    return Observing(width, density, space, grains)


def _start(scene: Scene, bodies: Sequence[Body], width: float, density: float, space: Space) -> Observation:
    """The scene before anything moves."""
    snapshot = snapshot_of_bodies(0.0, bodies, density)
    setting, whole = as_grains(scene, bodies, [snapshot], width, density, space)
    return observe(whole, setting, {"label": scene.source})
