"""Building the inflows of a scene, and what is wrong with where they are."""

import math
import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.materials.errors import InputWarning, numbers_of
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.inflow import Inflow
from grainlaw.mpm_core.kernels.shape_functions import BASES
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.obstacle import Obstacle
from grainlaw.mpm_core.scene.body_section import BodySection, InitialStressSection
from grainlaw.mpm_core.scene.inflow import InflowSection, Layer
from grainlaw.mpm_core.scene.initial_state import body_of_points, place_in_text, spacing_of_points
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.stepping.time_step import signal_bounds

# Sides that hold material which moves away from them.
HOLDING = ("free_slip", "no_slip")


def build_inflows(scene: Scene, first_id: int, keeps_shear_strain: bool = False) -> list[Inflow]:
    """The inflows of a scene, whose points' ids begin at `first_id`, with or without a row for the shear strain.

    Raises InputError for a mouth outside the domain, at a side that holds what enters, or narrower than a point.
    """
    return [
        _build(scene, number, section, first_id + number, keeps_shear_strain)
        for number, section in enumerate(scene.inflow)
    ]


def _build(scene: Scene, number: int, section: InflowSection, first_id: int, keeps_shear_strain: bool) -> Inflow:
    key, velocity = f"inflow.{number}", np.array(section.velocity)
    spacing = spacing_of_points(scene, section.points_per_cell)
    layer = section.shape.layer(spacing, velocity)
    if len(layer.areas) == 0:
        raise InputError(f"{key} ('{section.name}') is narrower than a point, whose spacing is {spacing:g} m")
    _refuse_place(scene, f"{key} ('{section.name}')", layer, velocity)
    body = _body_of_one_point(scene, key, section, layer, spacing, (first_id, keeps_shear_strain))
    _warn_without_stiffness(body, section.pressure, f"{scene.source}: {key}")
    template = body.points[:, 0].copy()
    with numbers_of(body.law.name):
        fastest = body.largest_signal_speed()
        signal_speed = signal_bounds(body).speed(fastest, float(body.speed[0]), 0.0)
    body.remove(np.ones(1, np.bool_))
    body.generated = 0
    masses = section.density * spacing * layer.areas * layer.centers[:, 0] if scene.in_space.hoop else None
    until = math.inf if section.until is None else section.until
    return Inflow(section.name, body, layer, velocity, spacing, template, masses, section.start, until, signal_speed)


def _body_of_one_point(
    scene: Scene, key: str, section: InflowSection, layer: Layer, spacing: float, ids: tuple[int, bool]
) -> Body:
    stress = InitialStressSection(kind="uniform", pressure=section.pressure)
    like = BodySection.model_construct(
        material=section.material, density=section.density, velocity=section.velocity, initial_stress=stress
    )
    mass = section.density * spacing * float(layer.areas[0])
    first_id, keeps_shear_strain = ids
    stride = len(scene.inflow)
    return body_of_points(scene, like, layer.centers[:1], np.zeros(1), key, mass, first_id, keeps_shear_strain, stride)


def _warn_without_stiffness(body: Body, pressure: float, where: str) -> None:
    least = body.law.least_initial_pressure
    if least is not None and pressure < least(body.parameters):
        warnings.warn(
            f"{where}.pressure = {pressure:g} Pa: {body.law.name} has next to no stiffness below "
            f"{least(body.parameters):g} Pa; write at least that",
            InputWarning,
            stacklevel=2,
        )


def _refuse_place(scene: Scene, what: str, layer: Layer, velocity: NDArray[np.float64]) -> None:
    lower, upper, places = np.array(scene.grid.lower), np.array(scene.grid.upper), layer.centers
    outside = ((places < lower) | (places > upper)).any(axis=1)
    if outside.any():
        raise InputError(
            f"{what}: {outside.sum()} of its {len(places)} points would enter outside the domain {lower.tolist()} to "
            f"{upper.tolist()}, the first at {place_in_text(places[outside][0])}"
        )
    reach = 0.5 * BASES[scene.transfer.basis].width * scene.grid.cell_size
    for axis, sides in enumerate(scene.in_space.sides):
        away = float((places[:, axis] - lower[axis]).min()), float((upper[axis] - places[:, axis]).min())
        for side, distance, leaves in zip(sides, away, (velocity[axis] > 0.0, velocity[axis] < 0.0), strict=True):
            kind = scene.boundary.kind_of(side)
            if leaves and distance < reach and kind in HOLDING:
                raise InputError(
                    f"{what} begins {distance:g} m from the {side} side, a {kind} wall that holds what leaves it; "
                    f'allowed: boundary.{side} = "open", or {reach:g} m or more'
                )


def check_mouths(inflows: Sequence[Inflow], obstacles: Sequence[Obstacle]) -> None:
    """Raises InputError for a mouth in an obstacle that is there when it begins."""
    for number, inflow in enumerate(inflows):
        places = np.ascontiguousarray(inflow.layer.centers.T)
        for obstacle in obstacles:
            inside = distances(obstacle, places) < 0.0
            if inside.any() and obstacle.is_there(inflow.start):
                raise InputError(
                    f"inflow.{number} ('{inflow.name}'): {inside.sum()} of its {places.shape[1]} points would enter "
                    f"inside obstacle '{obstacle.name}'"
                )
