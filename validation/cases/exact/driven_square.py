"""A Neo-Hookean square, or cube, between smooth walls, driven by the body force that makes its motion exact.

u = A sin(pi X) sin(c pi t), v = A sin(pi Y) sin(c pi t + pi), A = 0.05 m, c = sqrt(E/rho) (Wallstedt & Guilkey 2008, J.
Comput. Phys. 227); in three dimensions w = A sin(pi Z) sin(c pi t) besides.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.rheology import shear_modulus
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.space import PLANE_STRAIN, Space
from grainlaw.validation.scenes import advance, block, simulation_of

Array = NDArray[np.float64]

YOUNGS_MODULUS, POISSON_RATIO, DENSITY = 1e4, 0.3, 1.0
BULK_MODULUS = YOUNGS_MODULUS / (3.0 * (1.0 - 2.0 * POISSON_RATIO))
SHEAR_MODULUS = shear_modulus(BULK_MODULUS, POISSON_RATIO)
LAME = BULK_MODULUS - 2.0 / 3.0 * SHEAR_MODULUS
SPEED = math.sqrt(YOUNGS_MODULUS / DENSITY)
AMPLITUDE = 0.05
PERIOD = 2.0 / SPEED
# The displacement along y runs half a period behind the others.
PHASES = np.array([[0.0], [math.pi], [0.0]])
# Without decay of velocities, which would damp the motion.
UNDAMPED = 1e6
# Of the period, after which the place and the stress are compared with the exact ones.
COMPARISONS = 20


def displacement(places: Array, time: float) -> Array:
    """U = A sin(pi X) sin(c pi t + phase) of the places at the start, along each axis; shape (axes, n) [m]."""
    return AMPLITUDE * np.sin(math.pi * places) * np.sin(SPEED * math.pi * time + PHASES[: len(places)])


def velocity(places: Array, time: float) -> Array:
    """Of the same places, shape (axes, n) [m/s]."""
    rate = SPEED * math.pi
    return AMPLITUDE * rate * np.sin(math.pi * places) * np.cos(rate * time + PHASES[: len(places)])


def velocity_gradient_at_start(places: Array) -> Array:
    """The diagonal components, shape (axes, n) [1/s]."""
    return AMPLITUDE * math.pi * SPEED * math.pi * np.cos(math.pi * places) * np.cos(PHASES[: len(places)])


def stretch(places: Array, time: float) -> Array:
    """The diagonal components of F, shape (axes, n)."""
    return 1.0 + AMPLITUDE * math.pi * np.cos(math.pi * places) * np.sin(SPEED * math.pi * time + PHASES[: len(places)])


def body_force(places: Array, time: float) -> Array:
    """Acceleration b = d2u/dt2 - (1/rho_0) dP/dX with the first Piola-Kirchhoff stress P; shape (axes, n) [m/s2].

    P_11 = G (F_1 - 1/F_1) + Lambda ln(J)/F_1 and dF_1/dX = -pi^2 u, so that
    dP_11/dX = -pi^2 u [G + (G + Lambda (1 - ln J))/F_1^2]; the same along the others.
    """
    u, f = displacement(places, time), stretch(places, time)
    log_volume = np.log(f.prod(axis=0))
    stiffness = SHEAR_MODULUS + (SHEAR_MODULUS + LAME * (1.0 - log_volume)) / f**2
    return math.pi**2 * u * (stiffness / DENSITY - SPEED**2)


def stress(places: Array, time: float) -> Array:
    """Cauchy stresses along the axes, shape (axes, n) [Pa]."""
    f = stretch(places, time)
    volume_ratio = f.prod(axis=0)
    return (SHEAR_MODULUS * (f**2 - 1.0) + LAME * np.log(volume_ratio)) / volume_ratio


class Errors(NamedTuple):
    """Largest root mean square errors over one period: of the place over the amplitude, of the stress over E."""

    displacement: float
    stress: float


class DrivenSquare:
    """The unit square, or cube, at the start of its motion; a control multiplies the body force.

    `settings` are tables of the scene, `grid`, `time` and `transfer`, with what a case chooses in them.
    """

    def __init__(
        self,
        cells: int,
        points_per_cell: int,
        settings: dict[str, dict[str, Any]],
        force_factor: float = 1.0,
        precision: str = "double",
        space: Space = PLANE_STRAIN,
    ) -> None:
        self.simulation = simulation_of({**_scene(cells, points_per_cell, settings, space), "precision": precision})
        self.body = self.simulation.bodies[0]
        self.places = self.body.positions.copy()
        self.force_factor = force_factor
        self.body.velocity = velocity(self.places, 0.0)
        for axis, rate in enumerate(velocity_gradient_at_start(self.places)):
            self.body.velocity_gradient[axis, axis] = self.body.affine[axis, axis] = rate
        self.simulation.body_force = self.force

    def force(self, body: Body, time: float) -> Array:
        """Acceleration of the points in their present order, shape (axes, n) [m/s2]."""
        return self.force_factor * body_force(self.places[:, body.ids], time)

    def errors_of_a_period(self) -> Errors:
        """Lead the square through one period."""
        found: list[Errors] = []
        advance(self.simulation, PERIOD, lambda present: found.append(self._errors(present)), intervals=COMPARISONS)
        return Errors(*(max(values) for values in zip(*found, strict=True)))

    def _errors(self, present: Simulation) -> Errors:
        places = self.places[:, self.body.ids]
        off = self.body.positions - places - displacement(places, present.time)
        off_stress = self.body.stress[: len(places)] - stress(places, present.time)
        return Errors(
            float(np.sqrt((off**2).sum(axis=0).mean())) / AMPLITUDE,
            float(np.sqrt((off_stress**2).sum(axis=0).mean())) / YOUNGS_MODULUS,
        )


def _scene(cells: int, points_per_cell: int, settings: dict[str, dict[str, Any]], space: Space) -> dict[str, Any]:
    lower, upper = [0.0] * space.axes, [1.0] * space.axes
    tables: dict[str, dict[str, Any]] = {
        "grid": {"cell_size": 1.0 / cells, "upper": upper},
        "time": {"end": PERIOD},
        "transfer": {"time_constant": UNDAMPED},
    }
    square = {
        "material": "neo_hookean",
        "shape": block(lower, upper),
        "density": DENSITY,
        "points_per_cell": points_per_cell,
    }
    return {
        "space": space.name,
        "gravity": lower,
        "material": {"neo_hookean": {"bulk_modulus": BULK_MODULUS, "poisson_ratio": POISSON_RATIO}},
        "body": [square],
        **{name: {**table, **settings.get(name, {})} for name, table in tables.items()},
    }
