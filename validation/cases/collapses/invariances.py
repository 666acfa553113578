"""What must not matter to a collapse: sides, places on the grid, moving frames, axes, the time step.

Each invariance is a row: the same collapse twice, once changed in what must not matter. Its negative control changes
something that matters on top.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import (
    Case,
    Curve,
    Effort,
    Evidence,
    Figure,
    Measurement,
    curve,
    relative_error,
    upper_bound,
)
from grainlaw.validation.cases.collapses.column import CELL_SIZE, SCENES, collapse, pile, shape_errors
from grainlaw.validation.scenes import advance, in_order_of_generation

Changes = dict[str, Any]
# What one material shows: errors, and a curve of them.
Found = tuple[tuple[Measurement, ...], Curve | None]

REST = 1.5
AXIS, WIDTH, HEIGHT = 1.6, 0.3, 0.9
FIRST = "mu(I)-LC"


@dataclass(frozen=True)
class Invariance:
    """A row of the table.

    compare    errors of a material, with changes of the altered collapse on top: those of the control
    mistake    what the control changes, and the changes
    materials  which are compared, by effort
    axes       title and labels of the figure of all curves, and which axes are logarithmic; None without a figure
    """

    name: str
    title: str
    proves: str
    reference: str
    norm: str
    compare: Callable[[str, Effort, Changes], Found]
    mistake: tuple[str, Changes]
    materials: dict[Effort, tuple[str, ...]]
    axes: tuple[str, str, str, str] | None = None

    def measure(self, effort: Effort) -> Evidence:
        """All materials."""
        found = [self.compare(material, effort, {}) for material in self.materials[effort]]
        measurements = tuple(one for errors, _ in found for one in errors)
        if self.axes is None:
            return Evidence(measurements)
        title, x_label, y_label, logarithmic = self.axes
        curves = tuple(one for _, one in found if one is not None)
        return Evidence(measurements, figures=(Figure(title, x_label, y_label, curves, logarithmic),))

    def control(self, effort: Effort) -> tuple[Measurement, ...]:
        """The first material with the mistake."""
        return self.compare(FIRST, Effort.QUICK, self.mistake[1])[0]

    @property
    def case(self) -> Case:
        """The row as a case."""
        return Case(
            self.name, self.title, self.proves, self.reference, self.norm, self.mistake[0], self.measure, self.control
        )


ALL = dict.fromkeys(Effort, tuple(SCENES))
FIRST_IN_QUICK = {Effort.QUICK: (FIRST,), Effort.FULL: tuple(SCENES)}

SYMMETRY_END = {Effort.QUICK: 0.4, Effort.FULL: 1.5}
POINTWISE_BAND = 1e-9


def mirrored(material: str, effort: Effort, changes: Changes) -> Found:
    """The largest distance of a point from its partner's mirror image over time."""
    cell = CELL_SIZE[effort]
    simulation = collapse(material, cell, changes)
    body = simulation.bodies[0]
    shape = [round(length / (0.5 * cell)) for length in (WIDTH, HEIGHT)]
    times: list[float] = []
    distances: list[float] = []

    def observe(present: Simulation) -> None:
        x, y = (one.reshape(shape) for one in in_order_of_generation(body, body.positions))
        x = x - AXIS
        times.append(present.time)
        distances.append(float(np.hypot(x + x[::-1], y - y[::-1]).max()) / HEIGHT)

    advance(simulation, SYMMETRY_END[effort], observe, intervals=25)
    error = upper_bound(f"{material}: largest asymmetry", "1", max(distances), POINTWISE_BAND)
    # An asymmetry of nothing has no logarithm.
    return (error,), curve(material, times, np.maximum(distances, 1e-17))


TURNED_END = {Effort.QUICK: 0.3, Effort.FULL: 0.6}
LENGTH = 3.2
TURNED: Changes = {
    "gravity": [-9.8, 0.0],
    "grid.upper": [1.0, LENGTH],
    "boundary.bottom": {"kind": "free_slip"},
    "boundary.left": {"kind": "friction", "coefficient": 0.7},
    "body.0.shape": {"kind": "rectangle", "lower": [0.0, 1.45], "upper": [0.9, 1.75]},
}


def turn(simulation: Simulation, upright: Simulation) -> None:
    """Give the points of the turned column what those of the upright one have: (x, y) -> (y, L - x)."""
    body, model = simulation.bodies[0], upright.bodies[0]
    body.points[:] = model.points
    x, y = model.positions
    body.positions = np.array([y, LENGTH - x])
    xx, yy, zz, xy = model.stress
    body.stress = np.array([yy, xx, zz, -xy])
    simulation.measure_signals()


def turned(material: str, effort: Effort, changes: Changes) -> Found:
    """The largest distance between the points of both collapses, turned back.

    Sums over a stencil run along x first; turned, they have another order and another round-off.
    """
    upright = collapse(material, CELL_SIZE[effort])
    lying = collapse(material, CELL_SIZE[effort], {**TURNED, **changes})
    turn(lying, upright)
    for simulation in (upright, lying):
        advance(simulation, TURNED_END[effort])
    x, y = in_order_of_generation(upright.bodies[0], upright.bodies[0].positions)
    lying_x, lying_y = in_order_of_generation(lying.bodies[0], lying.bodies[0].positions)
    distance = float(np.hypot(lying_x - y, LENGTH - lying_y - x).max())
    return (upper_bound(f"{material}: largest distance over height", "1", distance / HEIGHT, POINTWISE_BAND),), None


SHIFT, SHIFT_BAND = 0.37, 1e-2


def shifted(material: str, effort: Effort, changes: Changes) -> Found:
    """The pile of a column whose points start off their lattice against that of one whose points do not."""
    reference = collapse(material, CELL_SIZE[effort])
    simulation = collapse(material, CELL_SIZE[effort], changes)
    simulation.bodies[0].positions[0] += SHIFT * simulation.grid.cell_size
    for one in (reference, simulation):
        advance(one, REST)
    errors = shape_errors(pile(simulation), pile(reference), SHIFT_BAND, f"{material}: {{}}")
    return errors, curve(material, range(1, len(errors) + 1), [one.error for one in errors])


SPEED, MOVING_BAND = 1.0, 1e-2
LONGER: Changes = {"grid.upper": [4.8, 1.0]}
MOVING_FLOOR = {"kind": "friction", "coefficient": 0.7, "velocity": SPEED}
STANDING_FLOOR = {"kind": "friction", "coefficient": 0.7}


def moving(material: str, effort: Effort, changes: Changes) -> Found:
    """The pile on a floor that moves with it against the pile at rest, and the distance that it moved."""
    reference = collapse(material, CELL_SIZE[effort], LONGER)
    moves = {"body.0.velocity": [SPEED, 0.0], "boundary.bottom": MOVING_FLOOR}
    simulation = collapse(material, CELL_SIZE[effort], {**LONGER, **moves, **changes})
    body = simulation.bodies[0]
    start = float(body.positions[0].mean())
    for one in (reference, simulation):
        advance(one, REST)
    distance = float(body.positions[0].mean()) - start
    names = ("centre of mass", "half width", "height")
    shapes = shape_errors(pile(simulation), pile(reference), MOVING_BAND, f"{material}: {{}}", names)
    return (*shapes, relative_error(f"{material}: distance", "m", distance, SPEED * REST, MOVING_BAND)), None


SAFETY = {Effort.QUICK: (0.4, 0.2), Effort.FULL: (0.4, 0.1, 0.025)}
STEP_BAND = 2e-2


def stepped(material: str, effort: Effort, changes: Changes) -> Found:
    """The piles with coarser steps against that with the finest."""
    piles = {}
    for safety in SAFETY[effort]:
        simulation = collapse(material, CELL_SIZE[effort], {"time.safety": safety, **changes})
        advance(simulation, REST)
        piles[safety] = pile(simulation)
    *coarser, finest = SAFETY[effort]
    errors = [
        shape_errors(piles[safety], piles[finest], STEP_BAND, f"{material}: {{}}, safety {safety:g}")
        for safety in coarser
    ]
    heights = [one.shape.center_of_mass_height for one in piles.values()]
    return tuple(one for shape in errors for one in shape), curve(material, list(piles), heights)


AT_REST = "at t = 1.5 s; cell 0.0125 m (quick: 0.025 m)"
SHAPE_NORM = "relative difference of centre of mass, runout of 98 % of the mass and height"

INVARIANCES = (
    Invariance(
        name="mirror_symmetry",
        title="symmetry of a collapse",
        proves="nothing in transfer, walls or sorting prefers a side",
        reference="the mirror image of the other half",
        norm="largest distance of a point from the mirror image of its partner, over the height of the column",
        compare=mirrored,
        mistake=("gravity out of plumb by 1e-7", {"gravity": [1e-6, -9.8]}),
        materials=ALL,
        axes=("Asymmetry", "time [s]", "distance over height [1]", "y"),
    ),
    Invariance(
        name="shifted_column",
        title="column collapse, shifted by 0.37 cells",
        proves="the pile does not depend on where the column stands on the grid",
        reference=f"the same collapse without the shift, {AT_REST}",
        norm=SHAPE_NORM,
        compare=shifted,
        mistake=("floor friction 0.5 instead of 0.7", {"boundary.bottom.coefficient": 0.5}),
        materials=FIRST_IN_QUICK,
        axes=("Change by a shift of 0.37 cells", "measurement", "relative change [1]", ""),
    ),
    Invariance(
        name="moving_frame",
        title="column collapse in a frame that moves at 1 m/s",
        proves="Galilean invariance: neither transfer nor floor knows who moves",
        reference=f"the same collapse at rest, {AT_REST}; centre of mass at v t",
        norm=f"{SHAPE_NORM}; relative error of the distance",
        compare=moving,
        mistake=("a floor that does not move along", {"boundary.bottom": STANDING_FLOOR}),
        materials=FIRST_IN_QUICK,
    ),
    Invariance(
        name="turned_scene",
        title="column collapse, scene and gravity turned by 90 degrees",
        proves="no axis is special: transfer, stress, projection and walls are the same along x and y",
        reference="the same collapse upright, point by point; cell 0.0125 m (quick: 0.025 m)",
        norm="largest distance between corresponding points over the height of the column",
        compare=turned,
        mistake=("gravity tilted by 1e-5", {"gravity": [-9.8, -1e-4]}),
        materials=FIRST_IN_QUICK,
    ),
    Invariance(
        name="time_step_independence",
        title="column collapse, three materials, steps 1 : 4 : 16",
        proves="the pile is a property of the law and the scene, not of the step",
        reference=f"the same collapse with the smallest step, {AT_REST}",
        norm=SHAPE_NORM,
        compare=stepped,
        mistake=(
            "pure APIC, whose numerical dissipation grows with the number of steps",
            {"transfer.scheme": "apic"},
        ),
        materials={Effort.QUICK: (FIRST, "MCC OCR 1"), Effort.FULL: tuple(SCENES)},
        axes=("Final centre of mass", "fraction of the stable step", "height [m]", ""),
    ),
)
CASES = {row.name: row.case for row in INVARIANCES}
