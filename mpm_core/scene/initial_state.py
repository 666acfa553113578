"""Building the bodies of a scene: points, mass, stress and the law's state in equilibrium with it."""

import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, SymmetricTensor
from grainlaw.materials.errors import InputWarning, numbers_of
from grainlaw.materials.law import Law
from grainlaw.mpm_core.body import POINTS_AT_ONCE, Body
from grainlaw.mpm_core.kernels.positions import put_density, put_positions
from grainlaw.mpm_core.layout import Layout, allocate, layout_of
from grainlaw.mpm_core.scene.body_section import BodySection, InitialStressSection
from grainlaw.mpm_core.scene.geostatic import vertical_stresses
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shapes import points_along_edge
from grainlaw.mpm_core.space import Space
from grainlaw.mpm_core.stepping.peak_memory import physical_memory

# Bulk density of grains [kg/m3]: expanded perlite and foam beads are about as light.
LIGHTEST_PACKING = 100.0
# At least, while a shape is filled: two copies of a coordinate.
BYTES_PER_COORDINATE = 16
# Sizes of the domain along an axis beyond which a shape is refused before its points are counted.
FARTHEST = 4.0
# Of stresses that may be stored in single precision.
STRESS_ROUND_OFF = 1e-6


def build_bodies(scene: Scene, keeps_shear_strain: bool = False) -> list[Body]:
    """The bodies of a scene, with or without a row for the shear strain.

    Raises InputError for empty, overlapping, misplaced or too dense ones.
    """
    bodies: list[Body] = []
    if not scene.body:
        return bodies
    positions = [_positions(scene, number, section) for number, section in enumerate(scene.body)]
    _refuse_overlap(scene, positions)
    vertical = vertical_stresses(scene, positions)
    first_id = 0
    for number, section in enumerate(scene.body):
        body = _build(
            scene, section, positions[number], vertical[number], f"body.{number}", first_id, keeps_shear_strain
        )
        first_id += body.count
        bodies.append(body)
    return bodies


def _positions(scene: Scene, number: int, section: BodySection) -> NDArray[np.float64]:
    _refuse_absurd_size(scene, number, section)
    positions = scene.lattice(section)
    if len(positions) == 0:
        raise InputError(f"body.{number}: the shape holds no point; it is smaller than a cell of the grid")
    outside = ((positions < scene.grid.lower) | (positions > scene.grid.upper)).any(axis=1)
    if outside.any():
        raise InputError(
            f"body.{number}: {outside.sum()} of {len(positions)} points lie outside the domain "
            f"{list(scene.grid.lower)} to {list(scene.grid.upper)}, the first at {place_in_text(positions[outside][0])}"
        )
    return positions


def place_in_text(point: NDArray[np.float64]) -> str:
    """The coordinates of a point for a message."""
    return f"({', '.join(f'{coordinate:g}' for coordinate in point)})"


def _refuse_absurd_size(scene: Scene, number: int, section: BodySection) -> None:
    """Shapes in millimetres, for instance, or with a typing error in an exponent."""
    lower, upper = (np.array(corner) for corner in section.shape.bounds())
    if (upper < scene.grid.lower).any() or (lower > scene.grid.upper).any():
        domain = f"{list(scene.grid.lower)} to {list(scene.grid.upper)}"
        raise InputError(f"body.{number}: the shape lies outside the domain {domain}")
    axes = scene.in_space.axes
    spacing = scene.grid.cell_size / points_along_edge(section.points_per_cell, axes)
    with np.errstate(over="ignore"):
        points = (upper - lower) / spacing
        memory = BYTES_PER_COORDINATE * axes * np.prod(points)
    if not memory < physical_memory():
        raise InputError(
            f"body.{number}: the shape is {_size(points, 3)} points of {spacing:g} m large, more than fit into "
            "memory; lengths are in metres"
        )
    domain = np.array(scene.grid.upper) - np.array(scene.grid.lower)
    if ((upper - lower) > FARTHEST * domain).any():
        raise InputError(
            f"body.{number}: the shape is {_size(points * spacing, 3)} m large, the domain {_size(domain, 6)} m; "
            "lengths are in metres"
        )


def _size(lengths: NDArray[np.float64], digits: int) -> str:
    return " x ".join(f"{length:.{digits}g}" for length in lengths)


def _refuse_overlap(scene: Scene, positions: list[NDArray[np.float64]]) -> None:
    for second, section in enumerate(scene.body):
        for first in range(second):
            # Both ways: a small body may lie between the points of a large one.
            in_second = positions[first][section.shape.contains(positions[first])]
            in_first = positions[second][scene.body[first].shape.contains(positions[second])]
            if len(in_second) or len(in_first):
                place = place_in_text((*in_second, *in_first)[0])
                raise InputError(f"body.{first} and body.{second} overlap, for instance at {place}")


def _build(
    scene: Scene,
    section: BodySection,
    positions: NDArray[np.float64],
    vertical: NDArray[np.float64],
    name: str,
    first_id: int,
    keeps_shear_strain: bool,
) -> Body:
    mass = section.density * volume_per_point(scene, section)
    body = body_of_points(scene, section, positions, vertical, name, mass, first_id, keeps_shear_strain)
    _warn_without_stiffness(body.law, body.parameters, body.stress[:3], f"{scene.source}: {name}")
    if scene.in_space.hoop:
        body.points[body.layout.mass] = point_masses(scene, section, positions)
    return body


def body_of_points(
    scene: Scene,
    section: BodySection,
    positions: NDArray[np.float64],
    vertical: NDArray[np.float64],
    name: str,
    mass: float,
    first_id: int,
    keeps_shear_strain: bool,
    id_stride: int = 1,
) -> Body:
    """A body with points at `positions`, shape (n, axes) [m], of one mass [kg]; in axisymmetry that is yet to be set.

    `vertical` is the vertical stress at each point [Pa], as `initial_stress` of the section needs it.
    Raises InputError for one that is too dense.
    """
    law = scene.law(section.material)
    parameters = scene.parameters(section.material)
    _check_density(law, parameters, section, name, scene.source)
    space, layout = scene.in_space, layout_of(scene.in_space)
    remainders = len(layout.remainders) if scene.precision == "single" else 0
    rows = layout.first_state + len(law.state._fields) + keeps_shear_strain + remainders
    storage = allocate(rows, len(positions), scene.precision)
    points = storage[:, : len(positions)]
    put_positions(points, positions.T, space)
    points[layout.velocities] = np.reshape(section.velocity, (-1, 1))
    put_density(points, section.density, space)
    points[layout.stress : layout.stress + 3] = normal_stresses(space, section.initial_stress, vertical)
    with numbers_of(law.name):
        _initialise_state(law, parameters, points, layout)
    return Body(name, law, parameters, space, storage, len(positions), 1.0 if space.hoop else mass, first_id, id_stride)


def volume_per_point(scene: Scene, section: BodySection) -> float:
    """The part of a cell that a point stands for [m3], in plane strain and axisymmetry its area [m2]."""
    return float(spacing_of_points(scene, section.points_per_cell) ** scene.in_space.axes)


def spacing_of_points(scene: Scene, points_per_cell: int) -> float:
    """The distance of neighbouring points at the start, so many in a cell [m]."""
    return scene.grid.cell_size / points_along_edge(points_per_cell, scene.in_space.axes)


def point_masses(scene: Scene, section: BodySection, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """The masses of a body's points, shape (n,), at `positions`, shape (n, axes) [m].

    In 3D those of their cubes [kg], in plane strain per width [kg/m]; in axisymmetry per radian [kg/rad], the density
    times the area times the radius of its centre, which is exact for a square.
    """
    mass = section.density * volume_per_point(scene, section)
    return mass * positions[:, 0] if scene.in_space.hoop else np.full(len(positions), mass)


def normal_stresses(
    space: Space, section: InitialStressSection, vertical: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Normal stresses [Pa] along x, y and z, in axisymmetry z around the axis; shear stresses are zero.

    `vertical` is the one along the vertical axis over depth, shape (n,).
    """
    if section.kind == "uniform":
        pressure = np.full(len(vertical), section.pressure)
        return -pressure, -pressure, -pressure
    if section.kind not in ("geostatic", "table"):
        nothing = np.zeros(len(vertical))
        return nothing, nothing, nothing
    horizontal = section.horizontal_ratio * vertical
    if space.axes == 3:
        return horizontal, horizontal, vertical
    if section.out_of_plane_ratio is None:
        return horizontal, vertical, horizontal
    return horizontal, vertical, section.out_of_plane_ratio * (horizontal + vertical)


def _check_density(law: Law, parameters: Any, section: BodySection, name: str, source: str) -> None:
    """Raises InputError for a body denser than its grains, and warns about grains packed lighter than any are."""
    grain_density = getattr(parameters, "grain_density", math.inf)
    if section.density > grain_density:
        raise InputError(
            f"{name}.density = {section.density:g} kg/m3 is above the density of the grains, "
            f"material.{section.material}.grain_density = {grain_density:g} kg/m3; allowed: up to that"
        )
    if section.density < LIGHTEST_PACKING and not law.carries_tension:
        warnings.warn(
            f"{source}: {name}.density = {section.density:g} kg/m3 is lighter than loose grains are; a density in "
            f"g/cm3 is 1000 times that, {1000.0 * section.density:g}",
            InputWarning,
            stacklevel=2,
        )


def _warn_without_stiffness(law: Law, parameters: tuple[float, ...], normal: NDArray[np.float64], where: str) -> None:
    """Warn, as InputWarning, about a body of which points start below the pressure that the law asks for.

    `normal` are the normal stresses of its points, shape (3, n) [Pa].
    """
    if law.least_initial_pressure is None:
        return
    least = law.least_initial_pressure(parameters)
    lowest = -float((normal[0] + normal[1] + normal[2]).max()) / 3.0
    if lowest < least * (1.0 - STRESS_ROUND_OFF):
        # Without numbers that depend on the grid: Python then says it once for the grids of a rehearsal.
        warnings.warn(
            f"{where}.initial_stress: the body starts below a pressure of {least:g} Pa, where {law.name} has next to "
            'no stiffness, and will sink; write initial_stress = { kind = "geostatic" }, or { kind = "uniform", '
            f"pressure = ... }} with at least {least:g}",
            InputWarning,
            stacklevel=2,
        )


def _initialise_state(law: Law, parameters: tuple[float, ...], points: NDArray[np.float64], layout: Layout) -> None:
    """Fill the rows of the law's state, one call for each distinct initial stress of some points."""
    states = points[layout.first_state : layout.first_state + len(law.state._fields)]
    for start in range(0, points.shape[1], POINTS_AT_ONCE):
        block = slice(start, start + POINTS_AT_ONCE)
        stresses = points[[*range(layout.stress, layout.stress + 3), layout.density], block].T
        distinct, which = np.unique(stresses, axis=0, return_inverse=True)
        found = [
            law.initial_state(SymmetricTensor(xx, yy, zz, 0.0, 0.0, 0.0), density, parameters)
            for xx, yy, zz, density in distinct.tolist()
        ]
        states[:, block] = np.array(found)[which].T.reshape(states[:, block].shape)
