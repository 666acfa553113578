"""A column of grains in plane strain, and as a slab of it in three dimensions that repeats along the third axis."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import get_material
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.space import PLANE_STRAIN, THREE_D, Space
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.spaces.pile import differences_of_piles, pile
from grainlaw.validation.scenes import block, simulation_of

Array = NDArray[np.float64]

SAME_BAND, PILE_BAND = 1e-9, 1e-2
WIDTH, HEIGHT = 0.1, 0.2
DOMAIN_WIDTH, DOMAIN_HEIGHT = 0.6, 0.25
CELL_SIZE = {Effort.QUICK: 0.025, Effort.FULL: 0.0125}
LAWS = ("mu_i_lc", "modified_cam_clay")
# Of the slab, in cells.
THICKNESS = 2
# Of the stable step at the start: the column is never stiffer than that.
SHARE = 0.25
FLOOR_FRICTION = 0.7
SAME_UNTIL, REST = 0.1, 1.0


def scene(space: Space, law: str, cell_size: float, floor_friction: float = FLOOR_FRICTION) -> dict[str, Any]:
    """Half of a column beside its plane of symmetry, in which volumes are not projected, as that is iterated."""
    across = [THICKNESS * cell_size] * (space.axes - 2)
    # both horizontal stresses are half of the vertical one
    stress = {"kind": "geostatic", "horizontal_ratio": 0.5}
    if space is PLANE_STRAIN:
        stress["out_of_plane_ratio"] = 1.0 / 3.0
    scene: dict[str, Any] = {
        "space": space.name,
        "gravity": [*[0.0] * (space.axes - 1), -9.81],
        "grid": {"cell_size": cell_size, "upper": [DOMAIN_WIDTH, *across, DOMAIN_HEIGHT]},
        "boundary": {"bottom": {"kind": "friction", "coefficient": floor_friction}},
        "time": {"end": REST},
        "transfer": {"volume_projection": False},
        "material": {law: get_material(law).parameter_sets["paper"].parameters._asdict()},
        "body": [
            {
                "material": law,
                "shape": block([0.0] * space.axes, [WIDTH, *across, HEIGHT]),
                "density": 1500.0,
                "initial_stress": stress,
            }
        ],
    }
    if space is THREE_D:
        scene["boundary"] |= {"front": "periodic", "back": "periodic"}
    return scene


def started(space: Space, law: str, cell_size: float, **changes: float) -> Simulation:
    """The column in a space, at rest."""
    return simulation_of(scene(space, law, cell_size, **changes))


def lead(simulations: list[Simulation], end: float) -> None:
    """Lead simulations to a time [s] in the same steps, short enough for each."""
    while simulations[0].time < end:
        step = min(SHARE * simulation.critical_time_step() for simulation in simulations)
        for simulation in simulations:
            simulation.step(min(step, end - simulation.time))


def differences(plane: Simulation, slab: Simulation) -> tuple[float, float, float]:
    """Largest difference of places over the width, of velocities over sqrt(g H), of the move across over the width.

    Each point of the slab is compared with that of plane strain which started at the same place in the section.
    """
    section, body = _sorted_section(plane), slab.bodies[0]
    places, velocities = _of_layers(slab, body.positions), _of_layers(slab, body.velocity)
    scale = float(np.sqrt(9.81 * HEIGHT))
    place = max(float(np.abs(layer - section[0]).max()) for layer in places) / WIDTH
    velocity = max(float(np.abs(layer - section[1]).max()) for layer in velocities) / scale
    return place, velocity, float(np.abs(body.velocity[1]).max()) / scale


def _sorted_section(plane: Simulation) -> tuple[Array, Array]:
    body = plane.bodies[0]
    order = np.argsort(body.ids)
    return body.positions[:, order], body.velocity[:, order]


def _of_layers(slab: Simulation, values: Array) -> Array:
    """The components along x and z of each layer of points across the slab, shape (layers, 2, n).

    Points are generated along z first, then along y, then along x.
    """
    ordered = values[:, np.argsort(slab.bodies[0].ids)]
    layers, up = 2 * THICKNESS, round(2 * HEIGHT / slab.grid.cell_size)
    by_axis = ordered.reshape(3, -1, layers, up)
    return np.asarray(by_axis[[0, 2]].transpose(2, 0, 1, 3).reshape(layers, 2, -1))


def differences_of_rest(slab: Simulation, plane: Simulation, law: str) -> tuple[Measurement, ...]:
    """The pile of the slab against that in plane strain."""
    return differences_of_piles(pile(slab), pile(plane), f"{law} at {slab.time:g} s", PILE_BAND)


def measured(law: str, cell_size: float) -> tuple[Measurement, ...]:
    """Both columns of a law from their start to their piles."""
    plane, slab = started(PLANE_STRAIN, law, cell_size), started(THREE_D, law, cell_size)
    lead([plane, slab], SAME_UNTIL)
    place, velocity, across = differences(plane, slab)
    lead([plane, slab], REST)
    return (
        upper_bound(f"{law}: places at {SAME_UNTIL:g} s, over the width", "1", place, SAME_BAND),
        upper_bound(f"{law}: velocities at {SAME_UNTIL:g} s, over sqrt(g H)", "1", velocity, SAME_BAND),
        upper_bound(f"{law}: velocity across at {SAME_UNTIL:g} s, over sqrt(g H)", "1", across, SAME_BAND),
        *differences_of_rest(slab, plane, law),
    )


def measure(effort: Effort) -> Evidence:
    """Both laws on one grid."""
    return Evidence(tuple(found for law in LAWS for found in measured(law, CELL_SIZE[effort])))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A slab on a floor of a third of the friction."""
    law, size = LAWS[0], CELL_SIZE[Effort.QUICK]
    plane, slab = started(PLANE_STRAIN, law, size), started(THREE_D, law, size, floor_friction=FLOOR_FRICTION / 3.0)
    lead([plane, slab], SAME_UNTIL)
    place, velocity, _ = differences(plane, slab)
    lead([plane, slab], REST)
    return (
        upper_bound("places", "1", place, SAME_BAND),
        upper_bound("velocities", "1", velocity, SAME_BAND),
        *differences_of_rest(slab, plane, law),
    )


CASE = Case(
    name="slab",
    title="column in plane strain, and as a periodic slab in 3D",
    proves="the kernels of three dimensions and of plane strain compute the same thing",
    reference="the same column in plane strain, point by point and as a pile",
    norm="largest difference over the points, over the width and sqrt(g H); relative differences of the piles",
    mistake="a third of the floor friction in one of them",
    measure=measure,
    control=control,
)
