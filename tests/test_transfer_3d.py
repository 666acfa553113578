"""The transfers in three dimensions beside sums over all nodes in plain NumPy, inside the domain and at its walls."""

import numpy as np
import pytest

from grainlaw.mpm_core.grid.grid import BULK_COMPONENTS, COMPONENTS, NODE_OF, Grid
from grainlaw.mpm_core.kernels.bulk_3d import make_g2p_of_bulk, make_p2g_of_bulk
from grainlaw.mpm_core.kernels.g2p import (
    HIGHEST,
    KINETIC_ENERGY,
    LOWEST,
    MAX_SPEED,
    MOMENTUM,
    OF_AXES,
    PER_AXIS,
    reports_of,
)
from grainlaw.mpm_core.kernels.g2p_3d import make_g2p_3d
from grainlaw.mpm_core.kernels.p2g_3d import make_p2g_3d
from grainlaw.mpm_core.kernels.positions import positions_of, put_positions
from grainlaw.mpm_core.kernels.shape_functions import BASES, make_stencil
from grainlaw.mpm_core.layout import allocate, layout_of
from grainlaw.mpm_core.parallel.threads import use_threads
from grainlaw.mpm_core.space import THREE_D

LAYOUT, NODE = layout_of(THREE_D), NODE_OF[3]
CELL, CELLS, LOWER = 0.1, (5, 4, 6), (0.1, -0.2, 0.3)
# More than one group, and no whole number of registers.
COUNT, POINT_MASS = 43, 0.7
CASES = [*((basis, "double") for basis in BASES), ("quadratic", "single")]
ROUND_OFF = {"double": 1e-13, "single": 1e-5}


@pytest.fixture(autouse=True)
def _one_thread():
    use_threads(1)


class Points:
    """Random points from wall to wall, some of which share a stencil, and every weight of every node."""

    def __init__(self, basis, precision):
        self.basis, self.precision = BASES[basis], precision
        self.grid = Grid(THREE_D, LOWER, CELLS, CELL, (), precision)
        self.random = np.random.default_rng(7)
        rows = len(LAYOUT.names) + (len(LAYOUT.remainders) if precision == "single" else 0)
        self.storage = allocate(rows, COUNT, precision)
        self.rows = self.storage[:, :COUNT]
        self.rows[LAYOUT.velocity : LAYOUT.density] = self.random.normal(size=(LAYOUT.density - LAYOUT.velocity, COUNT))
        self.storage[LAYOUT.density] = 1.0
        self.rows[LAYOUT.density] = self.random.uniform(1.0, 2.0, COUNT)
        shares = self.random.uniform(0.01, 0.99, (3, COUNT))
        shares[:, :9] = shares[:, :1]
        put_positions(self.rows, np.array(LOWER)[:, None] + CELL * np.array(CELLS)[:, None] * shares, THREE_D)
        self.positions = positions_of(self.rows, THREE_D).copy()
        self.place = self.grid.strides, self.grid.ghosts, self.grid.origin, CELL
        lines = [low + CELL * np.arange(n) for low, n in zip(self.grid.origin, self.grid.shape, strict=True)]
        self.nodes_at = np.array(np.meshgrid(*lines, indexing="ij"))

    def rows_of(self, first, *shape):
        return self.rows[first : first + int(np.prod(shape))].astype(float).reshape(*shape, COUNT)

    @property
    def velocity(self):
        return self.rows_of(LAYOUT.velocity, 3)

    @property
    def affine(self):
        return self.rows_of(LAYOUT.affine, 3, 3)

    @property
    def stress(self):
        xx, yy, zz, xy, yz, xz = self.rows_of(LAYOUT.stress, 6)
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def along_axes(self):
        """Weights, ways [m] and second moments [m2] of all points: per axis over its nodes, shape (n, nodes)."""
        stencil = make_stencil(self.basis)
        for axis in range(3):
            weights, ways = np.zeros((2, COUNT, self.grid.shape[axis]))
            moments = np.zeros(COUNT)
            for p, x in enumerate((self.positions[axis] - self.grid.origin[axis]) / CELL):
                i, _, w, moments[p], _ = stencil(x, *self.grid.ghosts[2 * axis : 2 * axis + 2])
                weights[p, int(i) : int(i) + len(w)] = w
                ways[p] = (np.arange(len(ways[p])) - x) * CELL
            yield weights, ways, moments * CELL**2

    def weights(self):
        """w, shape (n, *grid); x_i - x_p, shape (3, n, *grid); D, shape (3, n)."""
        (wx, dx, mx), (wy, dy, my), (wz, dz, mz) = self.along_axes()
        ways = np.broadcast_arrays(dx[:, :, None, None], dy[:, None, :, None], dz[:, None, None, :])
        return np.einsum("pi,pj,pk->pijk", wx, wy, wz), np.array(ways), np.array([mx, my, mz])

    def nodes(self):
        return self.grid.nodes.astype(float).reshape(*self.grid.shape, COMPONENTS)

    def p2g(self):
        starts = np.array([0, COUNT])
        make_p2g_3d(self.basis, self.precision)(self.storage, POINT_MASS, starts, 1, self.grid.nodes, *self.place)
        nodes = self.nodes()
        return nodes[..., NODE.mass], *(np.moveaxis(nodes[..., n : n + 3], -1, 0) for n in (NODE.momentum, NODE.force))

    def g2p(self, dt, flip_fraction):
        reports = np.zeros((1, reports_of(THREE_D)))
        arguments = COUNT, POINT_MASS, self.grid.nodes, *self.place, dt, flip_fraction, 1, reports
        make_g2p_3d(self.basis, self.precision)(self.storage, *arguments)
        return reports[0]


@pytest.mark.parametrize(("basis", "precision"), CASES)
def test_p2g_brings_what_plain_sums_bring_and_neither_force_nor_torque(basis, precision):
    points = Points(basis, precision)
    mass, momentum, force = points.p2g()
    w, ways, second = points.weights()
    volume = POINT_MASS / points.rows[LAYOUT.density].astype(float)
    velocity = points.velocity[:, :, None, None, None] + np.einsum("abp,bpijk->apijk", points.affine, ways)
    pull = np.einsum("p,abp,bp,bpijk->apijk", volume, points.stress, 1.0 / second, ways)
    exact = ROUND_OFF[precision]
    np.testing.assert_allclose(mass, POINT_MASS * w.sum(axis=0), atol=exact)
    np.testing.assert_allclose(momentum, POINT_MASS * np.einsum("pijk,apijk->aijk", w, velocity), atol=exact)
    np.testing.assert_allclose(force, -np.einsum("pijk,apijk->aijk", w, pull), atol=exact * np.abs(pull).max())
    np.testing.assert_allclose(momentum.sum(axis=(1, 2, 3)), POINT_MASS * points.velocity.sum(axis=1), atol=10 * exact)
    np.testing.assert_allclose(force.sum(axis=(1, 2, 3)), 0.0, atol=10 * exact * np.abs(pull).max())
    torque = np.cross(points.nodes_at, force, axis=0).sum(axis=(1, 2, 3))
    np.testing.assert_allclose(torque, 0.0, atol=10 * exact * np.abs(pull).max())
    about = points.affine * second
    spin = np.array([about[2, 1] - about[1, 2], about[0, 2] - about[2, 0], about[1, 0] - about[0, 1]]).sum(axis=1)
    orbit = np.cross(points.positions, points.velocity, axis=0).sum(axis=1)
    angular = np.cross(points.nodes_at, momentum, axis=0).sum(axis=(1, 2, 3))
    np.testing.assert_allclose(angular, POINT_MASS * (orbit + spin), atol=10 * exact)


@pytest.mark.parametrize(("basis", "precision"), CASES)
def test_g2p_returns_what_plain_sums_return(basis, precision):
    points = Points(basis, precision)
    points.grid.nodes[:] = points.random.normal(size=points.grid.nodes.shape)
    nodes, (w, ways, second) = points.nodes(), points.weights()
    new, old = (np.moveaxis(nodes[..., first : first + 3], -1, 0) for first in (NODE.momentum, NODE.force))
    velocities = [np.einsum("pijk,aijk->ap", w, field) for field in (new, old)]
    gradients = [np.einsum("pijk,aijk,bpijk,bp->abp", w, field, ways, 1.0 / second) for field in (new, old)]
    dt, flip_fraction = 0.01, 0.3
    velocity = velocities[0] + flip_fraction * (points.velocity - velocities[1])
    affine = gradients[0] + flip_fraction * (points.affine - gradients[1])
    positions = points.positions + dt * velocities[0]
    reports = points.g2p(dt, flip_fraction)
    exact = ROUND_OFF[precision]
    np.testing.assert_allclose(points.velocity, velocity, atol=10 * exact)
    np.testing.assert_allclose(points.rows_of(LAYOUT.gradient, 3, 3), gradients[0], atol=exact * np.abs(affine).max())
    np.testing.assert_allclose(points.affine, affine, atol=exact * np.abs(affine).max())
    np.testing.assert_allclose(positions_of(points.rows, THREE_D), positions, atol=dt * exact)
    energy = 0.5 * POINT_MASS * ((velocity**2).sum() + np.einsum("abp,bp->", affine**2, second))
    assert reports[KINETIC_ENERGY] == pytest.approx(energy, rel=10 * exact)
    assert reports[MAX_SPEED] == pytest.approx(np.sqrt((velocities[0] ** 2).sum(axis=0).max()), rel=10 * exact)
    for axis, of_axis in enumerate(range(OF_AXES, len(reports), PER_AXIS)):
        assert reports[of_axis + LOWEST] == pytest.approx(positions[axis].min(), abs=dt * exact)
        assert reports[of_axis + HIGHEST] == pytest.approx(positions[axis].max(), abs=dt * exact)
        momentum = POINT_MASS * velocities[0][axis].sum()
        assert reports[of_axis + MOMENTUM] == pytest.approx(momentum, abs=100 * exact)


@pytest.mark.parametrize(("basis", "precision"), CASES)
def test_volumes_and_pressures_go_to_the_nodes_and_back_as_plain_sums_do(basis, precision):
    points = Points(basis, precision)
    (w, _, _), grid, exact = points.weights(), points.grid, ROUND_OFF[precision]
    volume = POINT_MASS / points.rows[LAYOUT.density].astype(float)
    pressure = -np.trace(points.stress) / 3.0
    starts = np.array([0, COUNT])
    make_p2g_of_bulk(points.basis, precision)(points.storage, POINT_MASS, starts, 1, grid.bulk, *points.place)
    bulk = grid.bulk.astype(float).reshape(*grid.shape, BULK_COMPONENTS)
    np.testing.assert_allclose(bulk[..., 0], np.einsum("pijk,p->ijk", w, volume), atol=10 * exact)
    np.testing.assert_allclose(bulk[..., 1], np.einsum("pijk,p->ijk", w, volume * pressure), atol=10 * exact)
    reports = np.zeros((1, reports_of(THREE_D)))
    make_g2p_of_bulk(points.basis, precision)(points.storage, COUNT, grid.bulk, *points.place, 1, reports)
    for row, component in ((LAYOUT.neighbour_pressure, 0), (LAYOUT.neighbour_density, 1)):
        found = np.einsum("pijk,ijk->p", w, bulk[..., component])
        np.testing.assert_allclose(points.rows[row], found, atol=10 * exact * np.abs(bulk).max())


@pytest.mark.parametrize(("basis", "precision"), CASES)
def test_a_linear_velocity_field_reaches_the_points_as_it_is_walls_or_not(basis, precision):
    points = Points(basis, precision)
    gradient, drift = np.array([[0.3, -0.7, 0.2], [1.1, -0.4, 0.5], [-0.6, 0.9, 0.1]]), np.array([0.4, -0.2, 0.1])
    field = drift[:, None, None, None] + np.einsum("ab,bijk->aijk", gradient, points.nodes_at)
    nodes = points.grid.nodes.reshape(*points.grid.shape, COMPONENTS)
    for first in (NODE.momentum, NODE.force):
        nodes[..., first : first + 3] = np.moveaxis(field, 0, -1)
    points.g2p(1e-12, 0.0)
    exact = 100 * ROUND_OFF[precision]
    np.testing.assert_allclose(points.velocity, drift[:, None] + gradient @ points.positions, atol=exact)
    expected = np.broadcast_to(gradient[..., None], (3, 3, COUNT))
    for first in (LAYOUT.gradient, LAYOUT.affine):
        np.testing.assert_allclose(points.rows_of(first, 3, 3), expected, atol=exact)
