"""Steady flow of a granular layer down a rough incline: Bagnold's profile."""

import math
from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, upper_bound
from grainlaw.validation.scenes import advance, shipped_simulation

BAND = 2e-2
ANGLE, GRAVITY = math.radians(24.0), 9.81
STATIC_FRICTION, DYNAMIC_FRICTION, ENGINEERING_CONSTANT = 0.3819, 0.6435, 0.279
DIAMETER, HEIGHT, SOLID_FRACTION = 0.0005, 0.02, 0.6
CONSTANT = "material.mu_i_lc.inertial_number_constant"
# The slowest mode of the layer decays within 1.2 s.
END, KEPT = 8.0, 2.0
# How often the flow is looked at, and how many of the last looks are averaged: single ones scatter by 1.4 %.
LOOKS, STEADY_LOOKS = 40, 10
QUICK_CELL = {"grid.cell_size": 0.002}


def inertial_number() -> float:
    """I in the engineering rate, constant in depth."""
    slope = math.tan(ANGLE)
    return ENGINEERING_CONSTANT * (slope - STATIC_FRICTION) / (DYNAMIC_FRICTION - slope)


def exact_velocity(z: Any) -> Any:
    """Velocity [m/s] at a height z [m] above the floor."""
    factor = 2.0 / 3.0 * inertial_number() / DIAMETER * math.sqrt(SOLID_FRACTION * GRAVITY * math.cos(ANGLE))
    return factor * (HEIGHT**1.5 - (HEIGHT - np.clip(z, 0.0, HEIGHT)) ** 1.5)


def flow(changes: dict[str, Any], end: float, steady_start: bool = False) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Heights [m] and velocities [m/s] of the points at the end, and a row for each look.

    Rows hold time, surface velocity, thickness, and the largest error of the profile over the surface velocity. From
    rest or, for a steady start, from Bagnold's profile.
    """
    simulation = shipped_simulation("incline", changes)
    body = simulation.bodies[0]
    if steady_start:
        body.velocity[0] = exact_velocity(body.positions[1])
    history = [(0.0, float(body.velocity[0].max()), HEIGHT, 0.0 if steady_start else 1.0)]
    half_spacing = 0.25 * simulation.grid.cell_size

    def observe(present: Simulation) -> None:
        y, v = body.positions[1], body.velocity[0]
        top = y > y.max() - half_spacing
        error = float(np.abs(v - exact_velocity(y)).max()) / float(exact_velocity(HEIGHT))
        history.append((present.time, float(v[top].mean()), float(y.max()) + half_spacing, error))

    advance(simulation, end, observe, intervals=LOOKS)
    return body.positions[1].copy(), body.velocity[0].copy(), np.array(history)


def measurements(label: str, history: np.ndarray) -> tuple[Measurement, ...]:
    """Surface, profile and thickness, means over the last quarter of the time."""
    surface, thickness, largest = (float(mean) for mean in history[-STEADY_LOOKS:, 1:].mean(axis=0))
    return (
        relative_error(f"{label}: velocity at the surface", "m/s", surface, float(exact_velocity(HEIGHT)), BAND),
        upper_bound(f"{label}: largest error of the profile", "1", largest, BAND),
        relative_error(f"{label}: thickness of the layer", "m", thickness, HEIGHT, BAND),
    )


def measure(effort: Effort) -> Evidence:
    """20 cells across the layer, 10 in quick."""
    changes = QUICK_CELL if effort is Effort.QUICK else {}
    y, v, history = flow(changes, END)
    found = measurements(f"from rest, {END:g} s", history)
    kept_y, kept_v, kept_history = flow(changes, KEPT, steady_start=True)
    found += measurements(f"from the profile, {KEPT:g} s", kept_history)
    z = np.linspace(0.0, HEIGHT, 60)
    order, kept_order = np.argsort(y)[:: len(y) // 80], np.argsort(kept_y)[:: len(kept_y) // 80]
    profile = Figure(
        "Velocity over height",
        "velocity [m/s]",
        "height [m]",
        (
            curve("Bagnold", exact_velocity(z), z, "reference"),
            curve(f"from the profile, {KEPT:g} s", kept_v[kept_order], kept_y[kept_order]),
            curve(f"from rest, {END:g} s", v[order], y[order]),
        ),
    )
    exact = float(exact_velocity(HEIGHT))
    development = Figure(
        "Velocity at the surface from rest",
        "time [s]",
        "velocity [m/s]",
        (curve("steady", [0.0, END], [exact, exact], "reference"), curve("measured", history[:, 0], history[:, 1])),
    )
    thinned = history[history[:, 2] < 0.99 * HEIGHT]
    note = f"the layer has lost 1 % of its thickness at t = {thinned[0, 0]:.1f} s" if len(thinned) else "no thinning"
    return Evidence(found, figures=(profile, development), notes=(note,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The literature's I_0 taken over without converting it to the law's own shear rate."""
    *_, history = flow(QUICK_CELL | {CONSTANT: ENGINEERING_CONSTANT}, KEPT, steady_start=True)
    return measurements("control", history)


CASE = Case(
    name="bagnold_incline",
    title="granular layer on an incline of 24 degrees",
    proves="steady flow of mu(I) under gravity: friction balances weight in every depth, at the right inertial number",
    reference="u(z) = 2/3 (I/d) sqrt(phi g cos theta) (H^1.5 - (H - z)^1.5), I = I_0 (tan theta - mu_0)/(mu_d - tan "
    "theta) in the engineering rate (Bagnold scaling of mu(I); GDR MiDi 2004); glass beads: 0.7793 m/s at the surface",
    norm="largest error over the points, over the exact velocity at the surface; means over the last quarter of time",
    mistake="I_0 of the engineering shear rate used for gamma_dot = sqrt(1/2 D_d:D_d)",
    measure=measure,
    control=control,
)
