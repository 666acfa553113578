"""The paper's column collapse for validation cases: the shipped scenes, and what is measured of a pile."""

from dataclasses import dataclass
from typing import Any

from grainlaw.materials.registry import get_material
from grainlaw.mpm_core.output.observables import PileShape, shape_of
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Effort, Measurement, relative_error
from grainlaw.validation.scenes import shipped_simulation

SCENES = {
    "mu(I)-LC": "collapse_mu_i_lc",
    "MCC OCR 1": "collapse_mcc_ocr1",
    "MCC OCR 4": "collapse_mcc_ocr4",
}
# Of a pile's shape.
OBSERVABLES = ("center_of_mass_height", "runout", "height")
CELL_SIZE = {Effort.QUICK: 0.025, Effort.FULL: 0.0125}


@dataclass(frozen=True)
class Pile:
    """A pile's shape [m] and its energies [J/m] at one time [s]."""

    time: float
    shape: PileShape
    kinetic: float
    released: float


def collapse(material: str, cell_size: float, changes: dict[str, Any] | None = None) -> Simulation:
    """The column of one of `SCENES` on cells of the given size [m], with values by dotted key on top."""
    changes = {"grid.cell_size": cell_size, "output.fields": [], **(changes or {})}
    return shipped_simulation(SCENES[material], changes)


def published_viscous() -> dict[str, Any]:
    """Changes that give the mu(I)-LC column the law as published: viscous, explicit, without elasticity in shear."""
    law = "mu_i_lc_viscous"
    parameters = get_material(law).parameter_sets["paper"].parameters
    return {"material": {law: parameters._asdict()}, "body.0.material": law}


def pile(simulation: Simulation) -> Pile:
    """The present pile."""
    shape = shape_of(simulation)
    return Pile(simulation.time, shape, simulation.ledger.kinetic, -simulation.ledger.potential)


def shape_errors(
    found: Pile, reference: Pile, band: float, label: str, names: tuple[str, ...] = ()
) -> tuple[Measurement, ...]:
    """Relative differences of the observables of two piles; `label` holds their name, `names` call them otherwise."""
    names = names or tuple(key.replace("_", " ") for key in OBSERVABLES)
    return tuple(
        relative_error(label.format(name), "m", getattr(found.shape, key), getattr(reference.shape, key), band)
        for key, name in zip(OBSERVABLES, names, strict=True)
    )
