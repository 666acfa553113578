"""Generalised vortex: a Neo-Hookean ring sheared in itself, forth and back, at large rotation and strain."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import SimulationError
from grainlaw.materials.rheology import shear_modulus
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.held_nodes import nodes_where
from grainlaw.mpm_core.layout import allocate
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.scenes import advance, simulation_of

Array = NDArray[np.float64]

BAND = 2e-2
LEAST_ORDER = 1.9
INNER, OUTER = 0.75, 1.25
YOUNGS_MODULUS, POISSON_RATIO, DENSITY = 1e6, 0.3, 1000.0
BULK_MODULUS = YOUNGS_MODULUS / (3.0 * (1.0 - 2.0 * POISSON_RATIO))
SHEAR_MODULUS = shear_modulus(BULK_MODULUS, POISSON_RATIO)
DURATION = 1.0
# Largest angle [rad]: the shear strain reaches 6.2 times as much.
ANGLE, LARGE_ANGLE, PUBLISHED_ANGLE = 0.5, 1.0, math.pi
UNDAMPED = 1e6
# Cells per metre; the ring is half a metre wide. The band holds for 20.
CELLS = {Effort.QUICK: (10, 20), Effort.FULL: (10, 20, 40)}
BAND_CELLS = 20


def profile(radius: Array) -> tuple[Array, Array, Array]:
    """The profile h = (1 - 16 (R - 1)^2)^2, which vanishes at the rims, and its first two derivatives."""
    s = 16.0 * (radius - 1.0) ** 2
    return (1.0 - s) ** 2, -64.0 * (radius - 1.0) * (1.0 - s), -64.0 * (1.0 - s) + 128.0 * s


def swing(angle: float, time: float) -> tuple[float, float, float]:
    """The factor g = A sin(pi t/T) and its first two derivatives."""
    rate = math.pi / DURATION
    g = angle * math.sin(rate * time)
    return g, angle * rate * math.cos(rate * time), -rate * rate * g


def polar(places: Array) -> tuple[Array, Array]:
    """Radius [m] and angle [rad] of points, shape (2, n)."""
    return np.hypot(*places), np.arctan2(places[1], places[0])


def position(places: Array, angle: float, time: float) -> Array:
    """Where points that start at `places` are, shape (2, n) [m]: R is kept, the angle grows by g(t) h(R)."""
    radius, start = polar(places)
    turned = start + swing(angle, time)[0] * profile(radius)[0]
    return radius * np.array([np.cos(turned), np.sin(turned)])


def velocity_gradient_at_start(places: Array, angle: float) -> Array:
    """Grad v for v = w(r) e_z x x with w = g' h: w e_z x 1 + (e_z x x) w' x/r, shape (2, 2, n)."""
    radius, _ = polar(places)
    h, slope, _ = profile(radius)
    rate = swing(angle, 0.0)[1]
    x, y = places
    shear = rate * slope / radius
    return np.array([[-y * x * shear, -rate * h - y * y * shear], [rate * h + x * x * shear, x * y * shear]])


def body_force(places: Array, angle: float, time: float, shear_sign: float = 1.0) -> Array:
    """Acceleration that makes the motion exact, at the present place of points that started at `places` [m/s2].

    In polar components F = 1 + kappa e_theta (x) e_r with kappa = R g h', so that J = 1, b - 1 has the components
    b_r theta = kappa and b_theta theta - 1 = kappa^2, and sigma = G (b - 1). Its divergence is
    -G kappa^2/R along r and G (d kappa/dR + 2 kappa/R) along theta; the acceleration is -R (g' h)^2 and R g'' h.
    """
    radius, start = polar(places)
    h, slope, bend = profile(radius)
    g, rate, acceleration = swing(angle, time)
    per_mass = SHEAR_MODULUS / DENSITY
    along_r = -radius * (rate * h) ** 2 + per_mass * radius * (g * slope) ** 2
    along_theta = radius * acceleration * h - shear_sign * per_mass * g * (3.0 * slope + radius * bend)
    turned = start + g * h
    cosine, sine = np.cos(turned), np.sin(turned)
    return np.array([along_r * cosine - along_theta * sine, along_r * sine + along_theta * cosine])


def circles(cells: int, points_across_cell: int) -> Array:
    """Points on circles, each the middle of the same area, about as many as a lattice would have; shape (2, n) [m].

    A lattice would cut the rims into steps, where the body force is largest.
    """
    across = round((OUTER - INNER) * cells * points_across_cell)
    around = round(math.pi * (OUTER + INNER) * cells * points_across_cell)
    squares = np.linspace(INNER**2, OUTER**2, 2 * across + 1)[1::2]
    angles = 2.0 * math.pi * np.arange(around) / around
    radii = np.sqrt(squares)
    return np.array([np.outer(radii, np.cos(angles)).ravel(), np.outer(radii, np.sin(angles)).ravel()])


def ring(cells: int, points_across_cell: int, angle: float) -> Simulation:
    """The ring at the start of its motion, between nodes that are held."""
    simulation = simulation_of(_scene(cells))
    like = simulation.bodies[0]
    places = circles(cells, points_across_cell)
    count = places.shape[1]
    storage = allocate(like.points.shape[0], count)
    storage[:, :count] = like.points[:, :1]
    mass = DENSITY * math.pi * (OUTER**2 - INNER**2) / count
    body = Body("ring", like.law, like.parameters, like.space, storage, count, mass, first_id=0)
    body.positions = places
    body.velocity_gradient = body.affine = velocity_gradient_at_start(places, angle)
    radius, _ = polar(places)
    turn = swing(angle, 0.0)[1] * profile(radius)[0]
    body.velocity = turn * np.array([-places[1], places[0]])
    body.choose_kernels(simulation.basis)
    simulation.bodies = [body]
    simulation.measure_signals()
    simulation.held_nodes = nodes_where(simulation.grid, _is_outside)
    return simulation


def _is_outside(x: Array, y: Array) -> NDArray[np.bool_]:
    radius = np.hypot(x, y)
    return np.asarray((radius <= INNER + 1e-9) | (radius >= OUTER - 1e-9))


def _scene(cells: int) -> dict[str, Any]:
    return {
        "gravity": [0.0, 0.0],
        "grid": {"cell_size": 1.0 / cells, "lower": [-1.5, -1.5], "upper": [1.5, 1.5]},
        "time": {"end": DURATION},
        "transfer": {"time_constant": UNDAMPED},
        "material": {"neo_hookean": {"bulk_modulus": BULK_MODULUS, "poisson_ratio": POISSON_RATIO}},
        "body": [
            {
                "material": "neo_hookean",
                "shape": {"kind": "disc", "center": [0.0, 0.0], "radius": OUTER},
                "density": DENSITY,
            }
        ],
    }


def history(
    cells: int, angle: float = ANGLE, points_across_cell: int = 2, shear_sign: float = 1.0
) -> list[tuple[float, float]]:
    """Times [s] and root mean square distances from the exact place [m]."""
    simulation = ring(cells, points_across_cell, angle)
    body = simulation.bodies[0]
    places = body.positions.copy()
    simulation.body_force = lambda moved, time: body_force(places[:, moved.ids], angle, time, shear_sign)
    found = [(0.0, 0.0)]

    def observe(present: Simulation) -> None:
        off = body.positions - position(places[:, body.ids], angle, present.time)
        found.append((present.time, float(np.sqrt((off**2).sum(axis=0).mean()))))

    advance(simulation, DURATION, observe, intervals=20)
    return found


def largest(found: list[tuple[float, float]], angle: float = ANGLE) -> float:
    """The largest error over the length of the longest path."""
    return max(error for _, error in found) / angle


def measurement(cells: int, found: list[tuple[float, float]]) -> Measurement:
    """On one grid."""
    return upper_bound(f"displacement, {cells} cells per metre", "1", largest(found), BAND)


def limit(angle: float, points_across_cell: int) -> str:
    """What a larger angle gives on the grid of the band, in one line."""
    label = f"A = {angle:.3g} (shear strain {6.16 * angle:.3g}), {points_across_cell**2} points per cell: "
    try:
        return label + f"error {largest(history(BAND_CELLS, angle, points_across_cell), angle):.2e}"
    except SimulationError as error:
        return label + f"breaks: {error}"


def measure(effort: Effort) -> Evidence:
    """Grids of several sizes; in full also larger angles, up to the published one."""
    counts = CELLS[effort]
    found = {cells: history(cells) for cells in counts}
    sizes = tuple(1.0 / cells for cells in counts)
    order = Convergence(
        "displacement", "cell size [m]", sizes, tuple(largest(found[cells]) for cells in counts), LEAST_ORDER
    )
    curves = [curve(f"{cells} cells per metre", *np.transpose(found[cells])) for cells in counts]
    figure = Figure("Root mean square distance from the exact place", "time [s]", "error [m]", tuple(curves))
    notes: tuple[str, ...] = ()
    if effort is Effort.FULL:
        notes = tuple(limit(angle, across) for angle in (LARGE_ANGLE, PUBLISHED_ANGLE) for across in (2, 4))
    return Evidence((measurement(BAND_CELLS, found[BAND_CELLS]),), (order,), (figure,), notes)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The other sign of the part of the body force that balances the shear stress."""
    coarse = CELLS[effort][0]
    return (measurement(coarse, history(coarse, angle=0.1, shear_sign=-1.0)),)


CASE = Case(
    name="generalised_vortex",
    title="generalised vortex: a sheared Neo-Hookean ring",
    proves="objectivity: stress turns with the material while that is sheared by three times its thickness",
    reference="R kept, angle Theta + A sin(pi t/T) (1 - 16 (R - 1)^2)^2 for 0.75 < R < 1.25 m, T = 1 s, E = 1 MPa, "
    "nu = 0.3, rho = 1000 kg/m3 (Kamojjala et al. 2015; de Vaucorbeil et al. 2020), here with A = 0.5",
    norm="largest root mean square distance from the exact place, over the longest path",
    mistake="the other sign of the shear stress in the body force along theta",
    measure=measure,
    control=control,
)
