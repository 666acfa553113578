"""Where the time of a step goes, pass by pass, and how far from the roofline each pass is.

The passes are timed from outside: for the time of the measurement, the functions that a step calls are replaced by ones
that keep a clock of processor time. What is left of the step belongs to no pass: reports, reductions, Python.

The floor of a pass is the larger of two times: its bytes at the bandwidth that a triad reaches on a working set as
large as the points, and its operations at the arithmetic rate. Bytes are what the pass has to read and write of a
point's rows; what it moves to and from the grid stays in the first caches and is not counted.
"""

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from benchmarks.columns import make_steps
from benchmarks.roofline import Roofline
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.simulation import Simulation

STATE_PASSES = ("stress update",)


def rows_moved(axes: int) -> dict[str, int]:
    """Rows of a point that a pass reads and writes in two or three axes; of the stress pass without the law's state."""
    of_matrix, of_tensor, of_plane = axes * axes, 2 * axes, axes * (axes + 1) // 2
    return {
        # x, v, affine velocity, stress of the grid's axes, density
        "P2G": 2 * axes + of_matrix + of_plane + 1,
        # reads x, v, affine velocity; writes x, v, L, affine velocity
        "G2P": (2 * axes + of_matrix) + (2 * axes + 2 * of_matrix),
        # reads v, L, stress, density; writes stress, density
        "stress update": (axes + of_matrix + of_tensor + 1) + (of_tensor + 1),
    }


def remainders_moved(axes: int) -> dict[str, int]:
    """What single precision adds: the remainders of places and density, read and written."""
    return {"P2G": axes, "G2P": 2 * axes, "stress update": 2}


# Operations per point by axes, for quadratic splines: stencil and weights, what a point contributes or interpolates,
# then the nodes. In the plane a node has eight components, of which most steps gather four. In three axes what a point
# brings grows from node to node, row to row, plane to plane; velocities before and after are summed with their first
# moments row by row, plane by plane, in 93 multiply-adds of each component.
OPERATIONS = {
    2: {"P2G": 45 + 40 + 9 * (8 * 2 + 4), "G2P": 45 + 80 + 9 * 4 * 4},
    3: {"P2G": 70 + 70 + 27 * (8 * 2 + 8 + 1) + 9 * (8 + 1) + 3 * 8, "G2P": 70 + 130 + 6 * 93 * 2},
}


@dataclass(frozen=True)
class PassTime:
    """One pass: time per point and step [ns], its share of the step, floor [ns] and fraction of the roofline."""

    name: str
    nanoseconds: float
    share: float
    floor: float | None

    @property
    def fraction(self) -> float | None:
        """The share of its time that the pass could not do without."""
        return None if self.floor is None else self.floor / self.nanoseconds


def pass_times(simulation: Simulation, steps: int, roofline: Roofline) -> list[PassTime]:
    """Time the passes over some steps of a simulation of one body."""
    make_steps(simulation, 3)
    with _clocks(simulation) as seconds:
        started = time.process_time()
        make_steps(simulation, steps)
        whole = time.process_time() - started
    seconds["rest"] = whole - sum(seconds.values())
    body = simulation.bodies[0]
    per_point = 1e9 / (steps * body.count)
    return [
        PassTime(name, taken * per_point, taken / whole, _floor(name, body, roofline))
        for name, taken in seconds.items()
    ]


def _floor(name: str, body: Body, roofline: Roofline) -> float | None:
    axes = body.space.axes
    moved = rows_moved(axes)
    if name not in moved:
        return None
    rows = moved[name] + (2 * len(body.law.state._fields) if name in STATE_PASSES else 0)
    remainders = remainders_moved(axes)[name] if body.precision == "single" else 0
    bytes_moved = (rows + remainders) * body.points.itemsize
    moving = bytes_moved / roofline.bandwidth(body.points.nbytes)
    return 1e9 * max(moving, OPERATIONS[axes].get(name, 0) / roofline.arithmetic_rates[body.precision])


@contextmanager
def _clocks(simulation: Simulation) -> "Iterator[dict[str, float]]":
    """Clocks around the functions that a step calls; yields the seconds of each pass, which grow while it runs."""
    timed: list[tuple[Any, str, str]] = [
        (simulation, "_clear_nodes", "grid update"),
        (simulation, "_p2g", "P2G"),
        (simulation, "_update_grid", "grid update"),
        (simulation, "_g2p", "G2P"),
        (simulation, "_update_stress", "stress update"),
        *((body, "sort", "sorting") for body in simulation.bodies),
    ]
    seconds: dict[str, float] = defaultdict(float)
    originals = [getattr(owner, attribute) for owner, attribute, _ in timed]
    for (owner, attribute, name), original in zip(timed, originals, strict=True):
        setattr(owner, attribute, _with_clock(original, name, seconds))
    try:
        yield seconds
    finally:
        for (owner, attribute, _), original in zip(timed, originals, strict=True):
            setattr(owner, attribute, original)


def _with_clock(function: Callable[..., Any], name: str, seconds: dict[str, float]) -> Callable[..., Any]:
    def call(*arguments: Any, **keywords: Any) -> Any:
        started = time.process_time()
        result = function(*arguments, **keywords)
        seconds[name] += time.process_time() - started
        return result

    return call
