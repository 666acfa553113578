"""A flat silo of grains empties through slots; laws fitted to shear of the same grains empty it, nothing refitted."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.dem.catalogue import hopper
from grainlaw.validation.dem.description import SlotHopper
from grainlaw.validation.dem.hopper import BELOW, COLUMNS
from grainlaw.validation.dem.judging.column import flat_friction
from grainlaw.validation.dem.judging.data_table import by_seed
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw, fitted
from grainlaw.validation.dem.judging.fitting_data import write_data
from grainlaw.validation.dem.judging.judged_laws import JUDGED_LAWS
from grainlaw.validation.dem.reduction import table_name
from grainlaw.validation.reference.reference_set import ReferenceSet, read_reference_set
from grainlaw.validation.scenes import advance, simulation_of

Floats = NDArray[np.float64]

BAND = 0.10
JUDGED, OPENINGS = ("mu_i_phi_i", "mu_i_state"), (0.15, 0.2, 0.25)
# A law whose solid fraction does not change is told of, and not judged.
TOLD = ("mu_i_lc",)
CELLS_ACROSS, PLATE = 24, 4  # cells that an opening is wide, and a plate is thick
FROM, LARGEST_SHARE = 0.3, 0.45  # the rate is steady from then [s] until this share of the mass has left
BLOCKS = 5
FRICTIONS, LESS_FRICTION = ("static_friction", "dynamic_friction"), 0.5


@dataclass(frozen=True)
class Discharge:
    """The mass per width that has left a silo over time [s], [kg/m], and what was in it [kg/m].

    `fractions` and `speeds` are the solid fraction in the opening, and the mean speed [m/s] through it, over a layer of
    one grain.
    """

    times: Floats
    masses: Floats
    total: float
    fractions: Floats
    speeds: Floats

    @property
    def steady(self) -> NDArray[np.bool_]:
        """When the rate is steady."""
        return (self.times >= FROM) & (self.masses <= LARGEST_SHARE * self.total)

    @property
    def rate(self) -> float:
        """While it is steady [kg/(m s)]."""
        return float(np.polyfit(self.times[self.steady], self.masses[self.steady], 1)[0])

    @property
    def told(self) -> str:
        """The rate, and what passes the opening, while it is steady."""
        fraction, speed = (float(of[self.steady].mean()) for of in (self.fractions, self.speeds))
        return f"{self.rate:.1f} +- {self.error:.1f} kg/(m s), solid fraction {fraction:.2f} at {speed:.2f} m/s"

    @property
    def error(self) -> float:
        """Standard error of the rate, from parts of the time [kg/(m s)]."""
        parts = zip(*(np.array_split(of[self.steady], BLOCKS) for of in (self.times, self.masses)), strict=True)
        slopes = [np.polyfit(times, masses, 1)[0] for times, masses in parts]
        return float(np.std(slopes, ddof=1) / math.sqrt(BLOCKS))


def discharges_of_grains(reference: ReferenceSet, opening: float) -> list[Discharge]:
    """Of each packing of the reference set."""
    found = []
    for rows in by_seed(reference.test(Path(table_name(hopper(opening).name)).stem)):
        table = [[row[name] for name in COLUMNS] for row in rows]
        times, inside, fractions, speeds = np.array(table).T
        found.append(Discharge(times, inside[0] - inside, float(inside[0]), fractions, speeds))
    return found


def silo(case: SlotHopper, law: FittedLaw, mass: float, friction: float, cells_across: int) -> dict[str, Any]:
    """Half of the silo as a scene, with the mass of the grains per width [kg/m], resting; its slot is open.

    The friction is that of walls and plates.
    """
    half, edge = 0.5 * case.width, 0.5 * case.opening
    cell = half / round(half * cells_across / case.opening)
    below, above = (math.ceil(length / cell) for length in (BELOW, case.filling + cell))
    deep = PLATE * cell
    # Undercut, so that the edge is as sharp as that of the plates of the grains.
    plate = [[edge, 0.0], [edge + deep, -deep], [half + deep, -deep], [half + deep, 0.0]]
    name = law.judged.law
    return {
        "gravity": [0.0, -case.gravity],
        "grid": {"cell_size": cell, "lower": [0.0, -below * cell], "upper": [half, above * cell]},
        "time": {"end": case.end},
        "boundary": {"bottom": "open", "right": {"kind": "friction", "coefficient": friction}},
        "material": {name: law.parameters},
        "body": [
            {
                "material": name,
                "density": mass / (case.width * case.filling),
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [half, case.filling]},
                "initial_stress": {"kind": "geostatic"},
            }
        ],
        "obstacle": [{"name": "plate", "friction": friction, "shape": {"kind": "polygon", "vertices": plate}}],
    }


def discharge_of_law(
    case: SlotHopper, law: FittedLaw, mass: float, friction: float, cells_across: int = CELLS_ACROSS
) -> Discharge:
    """Of a law in the silo of a case."""
    rows = [(0.0, 0.0, 0.0, 0.0)]
    half_layer = 0.5 * case.grains.mean_diameter
    solid = case.opening * 2.0 * half_layer * case.grains.density

    def observe(present: Simulation) -> None:
        (body,) = present.bodies
        x, y = body.positions
        below, within = y < 0.0, (np.abs(y) < half_layer) & (x < 0.5 * case.opening)
        left = present.ledger.mass_left + float(body.masses[below].sum())
        inside = 2.0 * float(body.masses[within].sum())
        rows.append((present.time, 2.0 * left, inside / solid, -float(body.velocity[1, within].mean())))

    outputs = round(case.end / case.output_interval)
    advance(simulation_of(silo(case, law, mass, friction, cells_across)), case.end, observe, outputs)
    times, masses, fractions, speeds = np.array(rows).T
    return Discharge(times, masses, mass, fractions, speeds)


def laws_fitted(reference: ReferenceSet, names: Sequence[str]) -> list[FittedLaw]:
    """Fitted to the element tests of the grains."""
    judged = [law for law in JUDGED_LAWS if law.law in names]
    given = judged[0].given
    with TemporaryDirectory() as folder:
        write_data(reference, Path(folder), given["grain_density"], given["grain_diameter"])
        return [fitted(law, Path(folder)) for law in judged]


def mean_of_grains(grains: Sequence[Discharge]) -> tuple[float, float]:
    """The mean rate of some packings [kg/(m s)], and the mean mass in them [kg/m]."""
    return float(np.mean([one.rate for one in grains])), float(np.mean([one.total for one in grains]))


def measure(effort: Effort) -> Evidence:
    """mu(I), phi(I) through the widest slot; in full three laws through three.

    Walls and plates have the friction of shear over a flat plane: grains roll on it.
    """
    is_quick, reference = effort is Effort.QUICK, read_reference_set()
    friction = flat_friction(reference)
    laws = laws_fitted(reference, JUDGED[:1] if is_quick else JUDGED + TOLD)
    found, curves, notes = [], [], []
    for opening in OPENINGS[-1:] if is_quick else OPENINGS:
        case, where = hopper(opening), f"W = {opening:g} m"
        packings = discharges_of_grains(reference, opening)
        rate, mass = mean_of_grains(packings)
        for grains in packings:
            notes.append(f"grains, {where}: {grains.told}")
            curves.append(curve(f"grains, {where}", grains.times, grains.masses, "reference"))
        for law in laws:
            run = discharge_of_law(case, law, mass, friction)
            label = f"{law.judged.title}, {where}"
            notes.append(f"{label}: {run.told}, {run.rate / rate - 1.0:+.1%}")
            curves.append(curve(label, run.times, run.masses))
            if law.judged.law in JUDGED:
                found.append(relative_error(f"rate, {label}", "kg/(m s)", run.rate, rate, BAND))
    figure = Figure("Mass discharged", "time [s]", "mass [kg/m]", tuple(curves))
    return Evidence(tuple(found), figures=(figure,), notes=tuple(notes))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The law with too little friction, through the widest slot."""
    reference = read_reference_set()
    (law,) = laws_fitted(reference, JUDGED[:1])
    slippery = replace(
        law, parameters=law.parameters | {name: LESS_FRICTION * law.parameters[name] for name in FRICTIONS}
    )
    opening = OPENINGS[-1]
    rate, mass = mean_of_grains(discharges_of_grains(reference, opening))
    run = discharge_of_law(hopper(opening), slippery, mass, flat_friction(reference))
    return (relative_error(f"rate, W = {opening:g} m", "kg/(m s)", run.rate, rate, BAND),)


CASE = Case(
    name="hopper_grains",
    title="discharge of a flat silo through slots, against grains",
    proves="laws fitted to shear of grains, and nothing else, empty a silo at the rate of these grains",
    reference="our LIGGGHTS runs of a silo with three openings (validation/reference/hopper_w*.csv)",
    norm="relative deviation of the rate of discharge, while it is steady, from the mean over the packings",
    mistake="half of the friction of the law",
    measure=measure,
    control=control,
)
