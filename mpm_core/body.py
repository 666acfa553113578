"""A body: the points of one material, their law, and the kernels that were chosen for them."""

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, SymmetricTensor
from grainlaw.materials.compilation import explained, pointwise_law
from grainlaw.materials.law import Law
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.g2p import REPORTS as TRANSFER_REPORTS
from grainlaw.mpm_core.kernels.g2p import make_g2p
from grainlaw.mpm_core.kernels.p2g import make_p2g
from grainlaw.mpm_core.kernels.positions import (
    coordinate_of,
    density_of_first,
    positions_of,
    put_coordinate,
    put_positions,
)
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.registers import MOST_AT_ONCE
from grainlaw.mpm_core.kernels.stress_update import MAX_SIGNAL_SPEED, make_stress_pass
from grainlaw.mpm_core.kernels.stress_update import REPORTS as STRESS_REPORTS
from grainlaw.mpm_core.layout import (
    AFFINE,
    AXX,
    DENSITY,
    FIRST_STATE,
    GRADIENT,
    LXX,
    NAMES,
    NEIGHBOUR_DENSITY,
    NEIGHBOUR_PRESSURE,
    REMAINDERS,
    SXX,
    SXY,
    SYY,
    SZZ,
    VX,
    VY,
)
from grainlaw.mpm_core.parallel.blocks import blocks_of
from grainlaw.mpm_core.parallel.sorting import reorder, sort_by_stencil

# Points whose distinct states are found together at the start; flip_fraction would peak with all of them.
POINTS_AT_ONCE = 2**18


class RowsView:
    """A quantity of the points as a view of its rows, of some shape before the points; assigning writes there."""

    def __init__(self, first: int, shape: tuple[int, ...], doc: str) -> None:
        self.rows = slice(first, first + math.prod(shape))
        self.shape = shape
        self.__doc__ = doc

    def __get__(self, body: "Body", owner: type["Body"] | None = None) -> NDArray[np.float64]:
        return body.points[self.rows].reshape(*self.shape, body.count)

    def __set__(self, body: "Body", values: Any) -> None:
        self.__get__(body)[...] = values


class Body:
    """The material points of one body, their law and its parameters, in an order that changes as they move.

    `positions`, `velocity`, `stress`, `density` and the other arrays of one quantity are views of `points`, shape
    (rows, n): writing to them changes the body, unless they are said to be copies. `ids` gives each point's number in
    the order of generation, of all bodies.

    Compiled code takes the `storage` of the points, whose rows are a little longer. The first `awake` points take part
    in steps; the rest sleeps (`sleeping`). While any sleeps, `signal_speed_asleep` [m/s] is no less than that of each
    of them.
    """

    def __init__(
        self,
        name: str,
        law: Law,
        parameters: Any,
        storage: NDArray[np.float64],
        count: int,
        point_mass: float,
        first_id: int,
    ) -> None:
        self.name = name
        self.law = law
        self.parameters = parameters
        self.storage = storage
        self.points = storage[:, :count]
        self.point_mass = point_mass
        self.initial_density = density_of_first(storage)
        self.first_id = first_id
        self.ids = np.arange(first_id, first_id + count, dtype=np.int32)
        self.stripe_starts = np.zeros(1, np.int64)
        self.signal_speed_asleep = 0.0
        self.set_awake(count)
        self._p2g: Callable[..., Any]
        self._g2p: Callable[..., Any]
        self._coupling_g2p: Callable[..., Any]
        self._stress_pass: Callable[..., Any]

    @property
    def count(self) -> int:
        """Number of points."""
        return self.points.shape[1]

    def set_awake(self, awake: int) -> None:
        """Let the first `awake` points take part in steps."""
        self.awake = awake
        blocks = blocks_of(awake)
        self.transfer_reports = np.zeros((blocks, TRANSFER_REPORTS))
        self.stress_reports = np.zeros((blocks, STRESS_REPORTS))

    @property
    def points_awake(self) -> NDArray[np.float64]:
        """Those of `points` that take part in steps."""
        return self.points[:, : self.awake]

    @property
    def points_asleep(self) -> NDArray[np.float64]:
        """Those of `points` that sleep."""
        return self.points[:, self.awake :]

    @property
    def is_loose(self) -> bool:
        """Whether the material is loose grains, whose volumes are coupled."""
        return not self.law.carries_tension

    @property
    def row_names(self) -> tuple[str, ...]:
        """What the rows of `points` hold."""
        shear_strain = ("shear_strain",) if self._keeps_shear_strain else ()
        return (*NAMES, *self.law.state._fields, *shear_strain, *self._remainders)

    @property
    def states(self) -> NDArray[np.float64]:
        """The law's state variables of all points, shape (variables, n)."""
        return self.points[FIRST_STATE : FIRST_STATE + len(self.law.state._fields)]

    @property
    def shear_strain(self) -> NDArray[np.float64]:
        """The accumulated shear strain of all points, for a scene that writes it [1]."""
        return self.points[FIRST_STATE + len(self.law.state._fields)]

    @property
    def _keeps_shear_strain(self) -> bool:
        return len(self.points) > FIRST_STATE + len(self.law.state._fields) + len(self._remainders)

    @property
    def _remainders(self) -> tuple[str, ...]:
        return REMAINDERS if self.precision == "single" else ()

    @property
    def precision(self) -> str:
        """In what precision the points are stored."""
        return "single" if self.storage.dtype == np.float32 else "double"

    @property
    def _of_law(self) -> str:
        """In what precision the law is computed."""
        return self.precision if self.law.holds_in_single else "double"

    def choose_kernels(self, basis: Basis) -> None:
        """Choose transfers and generate the stress pass. Raises InputError if the law does not compile."""
        self._p2g = make_p2g(basis, self.precision)
        self._g2p = make_g2p(basis, False, self.precision)
        self._coupling_g2p = make_g2p(basis, self.is_loose, self.precision)
        law = pointwise_law(self.law, self._of_law)
        self._stress_pass = make_stress_pass(law, self._keeps_shear_strain, self.precision)
        no_points = self.storage, 0, 1.0, self._law_parameters
        explained(self.law, self._stress_pass, *no_points, 0.0, 0.0, 1, self.stress_reports[:0])

    @cached_property
    def _law_parameters(self) -> tuple[Any, ...]:
        """The law's parameters as its compiled functions take them."""
        plain = tuple(self.parameters)
        return tuple(map(np.float32, plain)) if self._of_law == "single" else plain

    @property
    def positions(self) -> NDArray[np.float64]:
        """Coordinates x, y [m], shape (2, n); of points in single precision a copy in double precision."""
        return positions_of(self.points)

    @positions.setter
    def positions(self, positions: NDArray[np.float64]) -> None:
        put_positions(self.points, positions)

    velocity = RowsView(VX, (2,), "Velocity components [m/s], shape (2, n).")
    velocity_gradient = RowsView(LXX, (2, 2), "L_ij = dv_i/dx_j on the grid in the last step [1/s], shape (2, 2, n).")
    affine = RowsView(AXX, (2, 2), "The velocity gradient A_ij that a point brings to the grid [1/s], shape (2, 2, n).")
    stress = RowsView(SXX, (4,), "Stress xx, yy, zz, xy [Pa], tension-positive, shape (4, n).")
    density = RowsView(DENSITY, (), "Bulk density [kg/m3], shape (n,).")
    neighbour_pressure = RowsView(NEIGHBOUR_PRESSURE, (), "Mean pressure around [Pa], shape (n,).")
    neighbour_density = RowsView(NEIGHBOUR_DENSITY, (), "Bulk density around [kg/m3], shape (n,).")

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Mean pressure p = -tr(sigma)/3 [Pa], a copy, shape (n,)."""
        return np.asarray(self.points[SXX : SZZ + 1].sum(axis=0) / -3.0)

    @property
    def volume(self) -> NDArray[np.float64]:
        """Volume per width [m2], a copy, shape (n,)."""
        return np.asarray(self.point_mass / self.points[DENSITY])

    def largest_signal_speed(self) -> float:
        """The largest sum of sound speed and point speed [m/s], in plain Python over the distinct states."""
        rows = [*(self.points[row] for row in (SXX, SYY, SZZ, SXY, DENSITY)), *self.states]
        fastest = 0.0
        for start in range(0, self.count, POINTS_AT_ONCE):
            block = np.stack([row[start : start + POINTS_AT_ONCE] for row in rows], axis=1)
            for xx, yy, zz, xy, density, *state in np.unique(block, axis=0).tolist():
                stress = SymmetricTensor(xx, yy, zz, xy, 0.0, 0.0)
                fastest = max(fastest, self.law.sound_speed(stress, density, self.law.state(*state), self.parameters))
        return fastest + float(np.sqrt((self.velocity**2).sum(axis=0).max()))

    def sort(self, grid: Grid, basis: Basis) -> None:
        """Bring the points that are awake into the order of their stencils and cut them into stripes."""
        order, self.stripe_starts = sort_by_stencil(self.points_awake, grid.origin, grid.cell_size, basis)
        reorder(self.storage, self.ids, 0, order)

    def divide(self, asleep: NDArray[np.bool_]) -> None:
        """Put the points that are to sleep, of all, behind the others; the speed of those that fall asleep is zero.

        Passes take `MOST_AT_ONCE` points at a time, so that a few more may have to stay awake.
        """
        fastest = float(self.stress_reports[:, MAX_SIGNAL_SPEED].max(initial=self.signal_speed_asleep))
        self.signal_speed_asleep = fastest if asleep.any() else 0.0
        for rows in (slice(VX, VY + 1), GRADIENT, AFFINE):
            self.points[rows, asleep] = 0.0
        first = int(np.argmax(asleep))
        order = np.argsort(asleep[first:], kind="stable").astype(np.int32)
        reorder(self.storage, self.ids, first, order)
        awake = len(asleep) - int(np.count_nonzero(asleep))
        self.set_awake(min(len(asleep), -(-awake // MOST_AT_ONCE) * MOST_AT_ONCE))

    def p2g(self, grid: Grid, threads: int) -> None:
        """Scatter mass, momentum and internal force of the points that are awake."""
        self._scatter(self.stripe_starts, threads, grid.nodes, grid)

    def p2g_of_sleepers(self, nodes: NDArray[np.float64], grid: Grid) -> None:
        """Scatter what the sleeping points bring to nodes of their own, in the order in which they lie."""
        # A single stripe, to one thread: nobody waits for it.
        self._scatter(np.array([self.awake, self.count]), 1, nodes, grid)

    def _scatter(self, stripe_starts: NDArray[np.int64], threads: int, nodes: NDArray[np.float64], grid: Grid) -> None:
        self._p2g(
            self.storage,
            self.point_mass,
            stripe_starts,
            threads,
            nodes,
            grid.shape[1],
            grid.ghosts,
            grid.origin,
            grid.cell_size,
        )

    def g2p(self, grid: Grid, dt: float, flip_fraction: float, threads: int, couples: bool = False) -> None:
        """Gather velocity and its gradient, and to couple volumes what that needs; move the points."""
        transfer = self._coupling_g2p if couples else self._g2p
        transfer(
            self.storage,
            self.awake,
            self.point_mass,
            grid.nodes,
            grid.shape[1],
            grid.ghosts,
            grid.origin,
            grid.cell_size,
            dt,
            flip_fraction,
            threads,
            self.transfer_reports,
        )

    def wrap(self, axis: int, lower: float, period: float) -> None:
        """Bring points that left through a periodic side back in through the other."""
        put_coordinate(self.points, axis, lower + np.mod(coordinate_of(self.points, axis) - lower, period))

    def update_stress(self, dt: float, coupled_time: float = 0.0, threads: int = 1) -> None:
        """Rotate the stress, bring the density forward, call the law.

        `coupled_time` is the time [s] for which the volumes of loose grains are coupled in this step.
        """
        coupled_time, points = coupled_time if self.is_loose else 0.0, (self.storage, self.awake, self.point_mass)
        self._stress_pass(*points, self._law_parameters, dt, coupled_time, threads, self.stress_reports)

    def state(self, name: str) -> NDArray[np.float64]:
        """A state variable of all points, in their present order. Raises InputError for an unknown name."""
        fields = self.law.state._fields
        if name not in fields:
            raise InputError(f"law {self.law.name} has no state variable '{name}'")
        column: NDArray[np.float64] = self.states[fields.index(name)]
        return column
