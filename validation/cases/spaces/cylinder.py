"""A cylinder of grains that falls apart, in axisymmetry and in three dimensions."""

from functools import cache
from typing import Any

from grainlaw.materials import get_material
from grainlaw.mpm_core.space import AXISYMMETRIC, THREE_D, Space
from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.cases.spaces.pile import differences_of_piles, pile
from grainlaw.validation.scenes import advance, block, simulation_of

BAND = 2e-2
RADIUS, HEIGHT = 0.2, 0.2
REACH, TOP = 0.5, 0.25
# Over a radius.
CELLS = {Effort.QUICK: (8,), Effort.FULL: (8, 16)}
END = 0.6
FLOOR_FRICTION = 0.7
LAW = "mu_i_lc"


def scene(space: Space, cells: int, floor_friction: float = FLOOR_FRICTION) -> dict[str, Any]:
    """The cylinder around its axis; in three dimensions a quarter of it between planes of symmetry."""
    shape, across = block([0.0, 0.0], [RADIUS, HEIGHT]), [REACH]
    if space is THREE_D:
        shape, across = {"kind": "cylinder", "center": [0.0] * 3, "radius": RADIUS, "height": HEIGHT}, [REACH, REACH]
    return {
        "space": space.name,
        "grid": {"cell_size": RADIUS / cells, "upper": [*across, TOP]},
        "boundary": {"bottom": {"kind": "friction", "coefficient": floor_friction}},
        "time": {"end": END},
        "material": {LAW: get_material(LAW).parameter_sets["paper"].parameters._asdict()},
        "body": [
            {
                "material": LAW,
                "shape": shape,
                "clip": space is THREE_D,
                "density": 1500.0,
                "initial_stress": {"kind": "geostatic"},
            },
        ],
    }


@cache
def collapsed(space: Space, cells: int, floor_friction: float = FLOOR_FRICTION) -> dict[str, float]:
    """The pile in a space."""
    simulation = simulation_of(scene(space, cells, floor_friction))
    advance(simulation, END)
    return pile(simulation)


def differences(found: dict[str, float], reference: dict[str, float], cells: int) -> tuple[Measurement, ...]:
    """Of two piles on a grid."""
    return differences_of_piles(found, reference, f"{cells} cells in the radius", BAND)


def measure(effort: Effort) -> Evidence:
    """The piles in both spaces on each grid."""
    found: list[Measurement] = []
    for cells in CELLS[effort]:
        found += differences(collapsed(AXISYMMETRIC, cells), collapsed(THREE_D, cells), cells)
    return Evidence(tuple(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A floor of a third of the friction in one of them."""
    cells = CELLS[Effort.QUICK][0]
    return differences(collapsed(AXISYMMETRIC, cells, FLOOR_FRICTION / 3.0), collapsed(THREE_D, cells), cells)


CASE = Case(
    name="cylinder",
    title="collapse of a cylinder in axisymmetry and in 3D",
    proves="the stretch, the stress and the masses around the axis are those of three dimensions",
    reference="the quarter of the same cylinder in three dimensions",
    norm="relative differences of radius, height and centre of mass 0.6 s after the start",
    mistake="a third of the floor friction in one of them",
    measure=measure,
    control=control,
)
