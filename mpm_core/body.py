"""A body: the points of one material, their law, and the kernels that were chosen for them."""

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, SymmetricTensor
from grainlaw.materials.compilation import explained, pointwise_law
from grainlaw.materials.law import Law
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.g2p import reports_of
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
from grainlaw.mpm_core.kernels.transfers import Transfers, transfers
from grainlaw.mpm_core.layout import allocate, layout_of
from grainlaw.mpm_core.parallel.blocks import blocks_of
from grainlaw.mpm_core.parallel.sorting import reorder, sort_by_stencil
from grainlaw.mpm_core.space import Space

# Points whose distinct states are found together at the start; memory would peak with all of them.
POINTS_AT_ONCE = 2**18


def tensor_of(components: Sequence[float]) -> SymmetricTensor:
    """The symmetric tensor of the components that a space has, the others zero."""
    return SymmetricTensor(*components, *(0.0,) * (6 - len(components)))


class RowsView:
    """A quantity of the points as a view of its rows; assigning writes there.

    `first` names the first row in `Layout`; there are as many as the space has axes, to the power `rank`.
    """

    def __init__(self, first: str, rank: int, doc: str) -> None:
        self.first = first
        self.rank = rank
        self.__doc__ = doc

    def __get__(self, body: "Body", owner: type["Body"] | None = None) -> NDArray[np.float64]:
        first, shape = getattr(body.layout, self.first), (body.space.axes,) * self.rank
        return body.points[first : first + math.prod(shape)].reshape(*shape, body.count)

    def __set__(self, body: "Body", values: Any) -> None:
        self.__get__(body)[...] = values


class Body:
    """The material points of one body, their law and its parameters, in an order that changes as they move.

    `positions`, `velocity`, `stress`, `density` and the other arrays of one quantity are views of `points`, shape
    (rows, n): writing to them changes the body, unless they are said to be copies. `ids` gives each point's number in
    the order of generation, of all bodies; those of bodies that grow by and by take turns. `generated` is how many
    points of this one there have been.

    Compiled code takes the `storage` of the points, whose rows are a little longer. In axisymmetry each point has a
    mass of its own, in a row, and `point_mass` is one. The first `awake` points take part in steps; the rest sleeps
    (`sleeping`). While any sleeps, `signal_speed_asleep` [m/s] is no less than that of each of them.
    """

    def __init__(
        self,
        name: str,
        law: Law,
        parameters: Any,
        space: Space,
        storage: NDArray[np.float64],
        count: int,
        point_mass: float,
        first_id: int,
        id_stride: int = 1,
    ) -> None:
        self.name = name
        self.space = space
        self.layout = layout_of(space)
        self.law = law
        self.parameters = parameters
        self.storage = storage
        self.points = storage[:, :count]
        self.point_mass = point_mass
        self.initial_density = density_of_first(storage, space)
        self.first_id = first_id
        self.id_stride = id_stride
        self.ids = np.empty(0, np.int32)
        self.generated = 0
        self._number(count)
        self.stripe_starts = np.zeros(1, np.int64)
        self.signal_speed_asleep = 0.0
        self.set_awake(count)
        self._transfers: Transfers
        self._stress_pass: Callable[..., Any]

    @property
    def count(self) -> int:
        """Number of points."""
        return self.points.shape[1]

    def set_awake(self, awake: int) -> None:
        """Let the first `awake` points take part in steps."""
        self.awake = awake
        blocks = blocks_of(awake)
        self.transfer_reports = np.zeros((blocks, reports_of(self.space)))
        self.stress_reports = np.zeros((blocks, STRESS_REPORTS))

    @property
    def numbers(self) -> NDArray[np.int32]:
        """Of each point its number in the order of generation of this body, shape (n,)."""
        return (self.ids - np.int32(self.first_id)) // np.int32(self.id_stride)

    def _number(self, count: int) -> None:
        """Give so many new points, behind the others, their ids."""
        numbers = np.arange(self.generated, self.generated + count, dtype=np.int32)
        self.ids = np.concatenate([self.ids, np.int32(self.first_id) + np.int32(self.id_stride) * numbers])
        self.generated += count

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
        return (*self.layout.names, *self.law.state._fields, *shear_strain, *self._remainders)

    @property
    def states(self) -> NDArray[np.float64]:
        """The law's state variables of all points, shape (variables, n)."""
        first = self.layout.first_state
        return self.points[first : first + len(self.law.state._fields)]

    @property
    def shear_strain(self) -> NDArray[np.float64]:
        """The accumulated shear strain of all points, for a scene that writes it [1]."""
        return self.points[self.layout.first_state + len(self.law.state._fields)]

    @property
    def _keeps_shear_strain(self) -> bool:
        return len(self.points) > self.layout.first_state + len(self.law.state._fields) + len(self._remainders)

    @property
    def _remainders(self) -> tuple[str, ...]:
        return self.layout.remainders if self.precision == "single" else ()

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
        self._transfers = transfers(self.space, basis, self.is_loose, self.precision)
        law = pointwise_law(self.law, self._of_law)
        self._stress_pass = make_stress_pass(self.space, law, self.precision)
        no_points = self.storage, 0, 1.0, self._law_parameters
        explained(self.law, self._stress_pass, *no_points, 0.0, 0.0, False, 1, self.stress_reports[:0])

    @cached_property
    def _law_parameters(self) -> tuple[Any, ...]:
        """The law's parameters as its compiled functions take them."""
        plain = tuple(self.parameters)
        return tuple(map(np.float32, plain)) if self._of_law == "single" else plain

    @property
    def positions(self) -> NDArray[np.float64]:
        """Coordinates [m], shape (axes, n); of points in single precision a copy in double precision."""
        return positions_of(self.points, self.space)

    @positions.setter
    def positions(self, positions: NDArray[np.float64]) -> None:
        put_positions(self.points, positions, self.space)

    velocity = RowsView("velocity", 1, "Velocity components [m/s], shape (axes, n).")
    velocity_gradient = RowsView("gradient", 2, "L_ij = dv_i/dx_j on the grid in the last step [1/s], (axes, axes, n).")
    affine = RowsView("affine", 2, "The velocity gradient A_ij that a point brings to the grid [1/s], (axes, axes, n).")
    density = RowsView("density", 0, "Bulk density [kg/m3], shape (n,).")
    neighbour_pressure = RowsView("neighbour_pressure", 0, "Mean pressure around [Pa], shape (n,).")
    neighbour_density = RowsView("neighbour_density", 0, "Bulk density around [kg/m3], shape (n,).")

    @property
    def stress(self) -> NDArray[np.float64]:
        """The stress components `layout.stress_names` [Pa], tension-positive, a view, shape (4 or 6, n)."""
        return self.points[self.layout.stresses]

    @stress.setter
    def stress(self, values: Any) -> None:
        self.points[self.layout.stresses] = values

    @property
    def volumetric_rate(self) -> NDArray[np.float64]:
        """Rate of volumetric strain tr L [1/s], positive for dilation, a copy, shape (n,)."""
        rate = np.trace(self.velocity_gradient)
        return np.asarray(rate + self.points[self.layout.hoop_gradient] if self.space.hoop else rate)

    @property
    def strain_rate(self) -> NDArray[np.float64]:
        """The components of the strain rate in the order of the stress [1/s], a copy, shape (4 or 6, n)."""
        rate = 0.5 * (self.velocity_gradient + self.velocity_gradient.swapaxes(0, 1))
        if self.space.axes == 3:
            return np.stack([rate[0, 0], rate[1, 1], rate[2, 2], rate[0, 1], rate[1, 2], rate[0, 2]])
        around = self.points[self.layout.hoop_gradient] if self.space.hoop else np.zeros(self.count)
        return np.stack([rate[0, 0], rate[1, 1], around, rate[0, 1]])

    @property
    def speed(self) -> NDArray[np.float64]:
        """Length of the velocity [m/s], a copy, shape (n,)."""
        return np.asarray(np.sqrt((self.velocity**2).sum(axis=0)))

    @property
    def masses(self) -> NDArray[np.float64]:
        """Mass of each point [kg and the space's amount], shape (n,)."""
        if self.space.hoop:
            return self.points[self.layout.mass]
        return np.full(self.count, self.point_mass)

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Mean pressure p = -tr(sigma)/3 [Pa], a copy, shape (n,)."""
        return np.asarray(self.stress[:3].sum(axis=0) / -3.0)

    @property
    def volume(self) -> NDArray[np.float64]:
        """Volume of each point [m3 and the space's amount], a copy, shape (n,)."""
        return np.asarray(self.masses / self.density)

    def largest_signal_speed(self) -> float:
        """The largest sum of sound speed and point speed [m/s], in plain Python over the distinct states."""
        rows = [*self.stress, self.density, *self.states]
        components = len(self.layout.stress_names)
        fastest = 0.0
        for start in range(0, self.count, POINTS_AT_ONCE):
            block = np.stack([row[start : start + POINTS_AT_ONCE] for row in rows], axis=1)
            for point in np.unique(block, axis=0).tolist():
                stress, density, state = tensor_of(point[:components]), point[components], point[components + 1 :]
                fastest = max(fastest, self.law.sound_speed(stress, density, self.law.state(*state), self.parameters))
        return fastest + float(self.speed.max(initial=0.0))

    def sort(self, grid: Grid, basis: Basis) -> None:
        """Bring the points that are awake into the order of their stencils and cut them into stripes."""
        order, self.stripe_starts = sort_by_stencil(
            self.points_awake[: self.space.axes], grid.origin, grid.cell_size, basis
        )
        reorder(self.storage, self.ids, 0, order)

    def remove(self, gone: NDArray[np.bool_]) -> None:
        """Remove points for good, of all; the rest keep their order.

        Where others sleep, a few of them may wake (`divide`).
        """
        kept = np.flatnonzero(~gone)
        awake = int(np.searchsorted(kept, self.awake))
        values, self.ids = self.points[:, kept], self.ids[kept]
        self.points[:] = 0.0
        self.set_count(len(kept))
        self.points[:] = values
        self.set_awake(min(len(kept), -(-awake // MOST_AT_ONCE) * MOST_AT_ONCE))

    def add(self, points: NDArray[Any]) -> None:
        """Take in new points, rows as in `points`, which are awake."""
        first, new = self.count, points.shape[1]
        self.reserve(first + new)
        self.set_count(first + new)
        self.points[:, first:] = points
        self._number(new)
        asleep = np.zeros(self.count, np.bool_)
        asleep[self.awake : first] = True
        if asleep.any():
            self.divide(asleep)
        else:
            self.set_awake(self.count)

    def reserve(self, count: int) -> None:
        """Have room for so many points; for more, where there was none."""
        if count > self.storage.shape[1]:
            larger = allocate(len(self.storage), max(count, 2 * self.count), self.precision)
            larger[:, : self.count] = self.points
            self.storage = larger
            self.set_count(self.count)

    def set_count(self, count: int) -> None:
        """Keep only the first points."""
        self.points = self.storage[:, :count]

    def divide(self, asleep: NDArray[np.bool_]) -> None:
        """Put the points that are to sleep, of all, behind the others; the speed of those that fall asleep is zero.

        Passes take `MOST_AT_ONCE` points at a time, so that a few more may have to stay awake.
        """
        fastest = float(self.stress_reports[:, MAX_SIGNAL_SPEED].max(initial=self.signal_speed_asleep))
        self.signal_speed_asleep = fastest if asleep.any() else 0.0
        for rows in (self.layout.velocities, self.layout.gradients):
            self.points[rows, asleep] = 0.0
        if self.space.hoop:
            self.points[self.layout.hoop_gradient, asleep] = 0.0
        first = int(np.argmax(asleep))
        order = np.argsort(asleep[first:], kind="stable").astype(np.int32)
        reorder(self.storage, self.ids, first, order)
        awake = len(asleep) - int(np.count_nonzero(asleep))
        self.set_awake(min(len(asleep), -(-awake // MOST_AT_ONCE) * MOST_AT_ONCE))

    def p2g(self, grid: Grid, threads: int, couples: bool = False) -> None:
        """Scatter mass, momentum and internal force of the points that are awake, and to couple volumes those."""
        self._scatter(self.stripe_starts, threads, grid.nodes, grid.bulk, grid, couples)

    def p2g_of_sleepers(self, nodes: NDArray[np.float64], bulk: NDArray[np.float64], grid: Grid) -> None:
        """Scatter what the sleeping points bring to nodes of their own, in the order in which they lie."""
        # A single stripe, to one thread: nobody waits for it.
        self._scatter(np.array([self.awake, self.count]), 1, nodes, bulk, grid, True)

    def _scatter(
        self,
        stripe_starts: NDArray[np.int64],
        threads: int,
        nodes: NDArray[np.float64],
        bulk: NDArray[np.float64],
        grid: Grid,
        couples: bool,
    ) -> None:
        points = self.storage, self.point_mass, stripe_starts, threads
        place = grid.strides, grid.ghosts, grid.origin, grid.cell_size
        self._transfers.p2g(*points, nodes, *place)
        if couples and self._transfers.p2g_of_bulk is not None:
            self._transfers.p2g_of_bulk(*points, bulk, *place)

    def g2p(self, grid: Grid, dt: float, flip_fraction: float, threads: int, couples: bool = False) -> None:
        """Gather velocity and its gradient, and to couple volumes what that needs; move the points."""
        points, place = (self.storage, self.awake), (grid.strides, grid.ghosts, grid.origin, grid.cell_size)
        if couples and self._transfers.g2p_of_bulk is not None:
            self._transfers.g2p_of_bulk(*points, grid.bulk, *place, threads, self.transfer_reports)
        g2p = self._transfers.coupling_g2p if couples else self._transfers.g2p
        g2p(*points, self.point_mass, grid.nodes, *place, dt, flip_fraction, threads, self.transfer_reports)

    def wrap(self, axis: int, lower: float, period: float) -> None:
        """Bring points that left through a periodic side back in through the other."""
        coordinate = coordinate_of(self.points, axis, self.space)
        put_coordinate(self.points, axis, lower + np.mod(coordinate - lower, period), self.space)

    def update_stress(self, dt: float, coupled_time: float = 0.0, threads: int = 1) -> None:
        """Rotate the stress, bring the density forward, call the law.

        `coupled_time` is the time [s] for which the volumes of loose grains are coupled in this step.
        """
        times = dt, coupled_time if self.is_loose else 0.0
        points = self.storage, self.awake, self.point_mass, self._law_parameters
        self._stress_pass(*points, *times, self._keeps_shear_strain, threads, self.stress_reports)

    def state(self, name: str) -> NDArray[np.float64]:
        """A state variable of all points, in their present order. Raises InputError for an unknown name."""
        fields = self.law.state._fields
        if name not in fields:
            raise InputError(f"law {self.law.name} has no state variable '{name}'")
        column: NDArray[np.float64] = self.states[fields.index(name)]
        return column
