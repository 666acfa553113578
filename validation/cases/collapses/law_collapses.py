"""Collapses of the column with a law, kept in a folder, so that a run over all laws that was stopped goes on."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from grainlaw.materials import atomic
from grainlaw.materials.compilation import pointwise_law
from grainlaw.materials.registry import get_material
from grainlaw.mpm_core.kernels.sources import CORE_MARK

FOLDER = Path("runs/collapse_of_every_law")


@dataclass(frozen=True)
class Collapse:
    """A collapse led to rest.

    kinetic                     largest kinetic energy at rest over the energy released
    missing, not_finite, created, steps, message   as in `survival.Trial`
    runout, height, center_of_mass_height          of the pile [m]
    volume                      over the initial one
    share_without_stress        of the points
    cost                        processor time [ns] of a point and step in flow, transfers included
    processor_time              of the whole run [s]
    """

    kinetic: float
    missing: float
    not_finite: int
    created: float
    runout: float
    height: float
    center_of_mass_height: float
    volume: float
    share_without_stress: float
    points: int
    steps: int
    cost: float
    processor_time: float
    message: str


def kept(law: str, cell_size: float, run: Callable[[], Collapse]) -> Collapse:
    """The collapse on cells of a size [m], from its file or from a run.

    The file's name holds the marks of the law's and the core's sources: after an edit the law runs again.
    """
    path = FOLDER / f"{pointwise_law(get_material(law)).mark}-{CORE_MARK}-{cell_size:g}.json"
    if path.is_file():
        return Collapse(**json.loads(path.read_text(encoding="utf-8")))
    found = run()
    FOLDER.mkdir(parents=True, exist_ok=True)
    atomic.write_text(path, json.dumps(asdict(found), indent=2) + "\n")
    return found
