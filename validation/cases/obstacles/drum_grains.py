"""A half-full rough drum of grains turns; laws fitted to shear of the same grains turn with it, nothing refitted."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, scaled_error
from grainlaw.validation.cases.obstacles.hopper_grains import FRICTIONS, JUDGED, TOLD, laws_fitted
from grainlaw.validation.dem.catalogue import drum
from grainlaw.validation.dem.description import RoughDrum
from grainlaw.validation.dem.drum import MEAN, MEAN_COLUMNS, PLACES, WINDOW
from grainlaw.validation.dem.judging.column import ROUGH_FRICTION
from grainlaw.validation.dem.judging.data_table import by_seed
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.reduction import table_name
from grainlaw.validation.grains.drum import LEVEL, Drum, Flow, mean_flow, mean_of_flows
from grainlaw.validation.grains.material_points import DEPTH, snapshot_of_bodies
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot
from grainlaw.validation.reference.reference_set import ReferenceSet, read_reference_set
from grainlaw.validation.scenes import advance, simulation_of

Floats = NDArray[np.float64]

ANGLE_BAND, TORQUE_BAND = 2.0, 0.02  # degrees; share of weight times arm
RADII = (0.3, 0.45)
CELLS = {Effort.QUICK: (12,), Effort.FULL: (12, 24)}  # in a radius; the finest is judged
ARC = 96  # sides of the half disc that the law fills at the start
SHOWN = 0.7  # of the radius, in pictures of the surface
LESS_FRICTION = 0.7


@dataclass(frozen=True)
class Turning:
    """A drum while it turns steadily, window by window.

    angles    of the surface [degrees]
    torques   that turn the drum, per width [N m/m]
    weights   moments of the weight about the axis, per width [N m/m]
    surface   its mean: x, z [m]
    across    place along the normal of the surface from the axis [m], and velocity down the slope [m/s]
    """

    angles: Floats
    torques: Floats
    weights: Floats
    surface: tuple[Array, Array]
    across: tuple[Array, Array]

    @property
    def angle(self) -> float:
        """The mean over the windows [degrees]."""
        return float(self.angles.mean())

    @property
    def told(self) -> str:
        """The angle with its standard error, and the torque over the moment of the weight."""
        error = self.angles.std(ddof=1) / math.sqrt(len(self.angles))
        return f"{self.angle:.1f} +- {error:.1f} degrees, {self.torque.measured:.1f} N m/m"

    @property
    def torque(self) -> Measurement:
        """Against the moment of the weight, which it carries in the mean."""
        torque, weight = float(self.torques.mean()), float(self.weights.mean())
        return relative_error("torque against weight times arm", "N m/m", torque, weight, TORQUE_BAND)


def turning_grains(reference: ReferenceSet, case: RoughDrum) -> list[tuple[Turning, float]]:
    """Each packing of the reference set, and its mass per width [kg/m]."""
    name = Path(table_name(case.name)).stem
    found = []
    for rows, mean in zip(by_seed(reference.test(name)), by_seed(reference.test(f"{name}_{MEAN}")), strict=True):
        steady = [row for row in rows if row["t"] > case.steady_from]
        angles, torques, arms, masses = (
            np.array([row[of] for row in steady]) for of in ("angle", "torque", "center_x", "mass")
        )
        places, surface, speeds, fractions = (np.array([row[of] for row in mean]) for of in MEAN_COLUMNS)
        run = Turning(
            angles,
            torques,
            masses * case.gravity * arms,
            _middle(places, surface, case.radius),
            _filled(places, speeds, fractions),
        )
        found.append((run, float(masses.mean())))
    return found


def scene(case: RoughDrum, law: FittedLaw, mass: float, cells: int) -> dict[str, Any]:
    """The drum with half a disc of a law, of the mass per width [kg/m], on `cells` in its radius."""
    radius, name = case.radius, law.judged.law
    cell = radius / cells
    reach = (cells + 3) * cell
    angles = np.pi * (1.0 + np.arange(ARC + 1) / ARC)
    return {
        "gravity": [0.0, -case.gravity],
        "grid": {"cell_size": cell, "lower": [-reach, -reach], "upper": [reach, reach]},
        "time": {"end": case.end},
        "material": {name: law.parameters},
        "body": [
            {
                "material": name,
                "density": mass / (0.5 * math.pi * radius**2),
                "shape": {
                    "kind": "polygon",
                    "vertices": (radius * np.stack([np.cos(angles), np.sin(angles)], 1)).tolist(),
                },
                "initial_stress": {"kind": "geostatic"},
            }
        ],
        "obstacle": [
            {
                "name": "drum",
                "friction": ROUGH_FRICTION,
                "hollow": True,
                "shape": {"kind": "disc", "center": [0.0, 0.0], "radius": radius},
                "angular_velocity": case.angular_velocity,
            }
        ],
    }


def turning_law(case: RoughDrum, law: FittedLaw, mass: float, cells: int) -> tuple[Turning, Flow]:
    """A law in the drum of a case, seen as its grains are, and its mean flow."""
    simulation = simulation_of(scene(case, law, mass, cells))
    advance(simulation, case.steady_from)
    windows = [_window(simulation, case) for _ in range(round((case.end - case.steady_from) / WINDOW))]
    flows = [flow for flow, _ in windows]
    mean = mean_of_flows(flows)
    places = np.linspace(-case.radius, case.radius, PLACES)
    fractions, speeds = mean.across(places)
    return Turning(
        angles=np.array([flow.angle for flow in flows]),
        torques=np.array([torque for _, torque in windows]),
        weights=np.array([mass * case.gravity * flow.center[0] for flow in flows]),
        surface=_middle(mean.drum.lattice.x, mean.surface, case.radius),
        across=_filled(places, speeds, fractions),
    ), mean


def _middle(x: Array, z: Array, radius: float) -> tuple[Array, Array]:
    """The surface away from the wall of the drum."""
    inner = np.abs(x) < SHOWN * radius
    return x[inner], z[inner]


def _filled(places: Array, speeds: Array, fractions: Array) -> tuple[Array, Array]:
    """The velocity where there is material."""
    inside = fractions > LEVEL
    return places[inside], speeds[inside]


def _window(simulation: Simulation, case: RoughDrum) -> tuple[Flow, float]:
    """The mean flow over the next window, and the mean torque that turned the drum, per width [N m/m]."""
    (wall,) = simulation.obstacles.all
    snapshots: list[GrainSnapshot] = []

    def look(present: Simulation) -> None:
        snapshots.append(snapshot_of_bodies(present.time, present.bodies, case.grains.density))

    wall.forces.reset()
    advance(simulation, simulation.time + WINDOW, look, round(WINDOW / case.output_interval))
    seen = Drum(case.radius, case.grains.mean_diameter, DEPTH)
    return mean_flow(snapshots, seen), -float(wall.forces.means()[1][2])


def mean_angle(packings: Sequence[Turning]) -> float:
    """The mean angle over packings [degrees]."""
    return float(np.mean([one.angle for one in packings]))


def angle_error(label: str, angle: float, of_grains: float) -> Measurement:
    """How far an angle lies from that of the grains [degrees]."""
    return scaled_error(f"angle, {label}", "degrees", angle, of_grains, 1.0, ANGLE_BAND)


def measure(effort: Effort) -> Evidence:
    """mu(I), phi(I) in the small drum on coarse cells; in full three laws in two drums, on two sizes of cells."""
    is_quick, reference = effort is Effort.QUICK, read_reference_set()
    laws = laws_fitted(reference, JUDGED[:1] if is_quick else JUDGED + TOLD)
    found, notes, shown = [], [], []
    for radius in RADII[:1] if is_quick else RADII:
        case, where = drum(radius), f"R = {radius:g} m"
        packings, masses = zip(*turning_grains(reference, case), strict=True)
        angle = mean_angle(packings)
        for grains in packings:
            notes.append(f"grains, {where}: {grains.told}")
            shown.append((f"grains, {where}", grains, "reference"))
            found.append(replace(grains.torque, name=f"grains, {where}: {grains.torque.name}"))
        for law in laws:
            for cells in CELLS[effort]:
                run, flow = turning_law(case, law, float(np.mean(masses)), cells)
                label = f"{law.judged.title}, {where}"
                thickness, speed = flow.layer
                notes.append(f"{label}, {cells} cells: {run.told}; {thickness:.3f} m runs down, at {speed:.2f} m/s")
                if cells == CELLS[effort][-1]:
                    shown.append((label, run, "measured"))
                    found += judged(label, run, angle) if law.judged.law in JUDGED else []
    return Evidence(tuple(found), figures=pictures(shown), notes=tuple(notes))


def judged(label: str, run: Turning, angle: float) -> list[Measurement]:
    """A law's angle against that of the grains [degrees], and its torque."""
    return [angle_error(label, run.angle, angle), replace(run.torque, name=f"{label}: {run.torque.name}")]


def pictures(shown: Sequence[tuple[str, Turning, str]]) -> tuple[Figure, ...]:
    """The mean surfaces, and the velocities below them; each with its label and its role."""
    surfaces = tuple(curve(label, *run.surface, role) for label, run, role in shown)
    speeds = tuple(curve(label, *run.across, role) for label, run, role in shown)
    return (
        Figure("Mean surface", "x [m]", "z [m]", surfaces),
        Figure("Velocity down the slope", "place along the normal from the axis [m]", "velocity [m/s]", speeds),
    )


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The law with too little friction, in the small drum: its angle, its torque against the weight of grains."""
    reference, case = read_reference_set(), drum(RADII[0])
    (law,) = laws_fitted(reference, JUDGED[:1])
    less = {name: LESS_FRICTION * law.parameters[name] for name in FRICTIONS}
    packings, masses = zip(*turning_grains(reference, case), strict=True)
    slippery = replace(law, parameters=law.parameters | less)
    run, _ = turning_law(case, slippery, float(np.mean(masses)), CELLS[Effort.QUICK][-1])
    return (
        angle_error(f"R = {case.radius:g} m", run.angle, mean_angle(packings)),
        replace(run, weights=packings[0].weights).torque,
    )


CASE = Case(
    name="drum_grains",
    title="angle of the surface in a turning rough drum, against grains",
    proves="laws fitted to shear of grains, and nothing else, stand in a turning drum as steeply as these grains",
    reference="our LIGGGHTS runs of a drum of two radii (validation/reference/drum_r*.csv)",
    norm="difference of the mean angle from the mean over the packings; torque against the moment of the weight",
    mistake="friction of the law 30 % too low",
    measure=measure,
    control=control,
)
