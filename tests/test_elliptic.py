"""The elliptic solver against a direct one and against an exact solution, in two and three axes."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from grainlaw.materials import SimulationError
from grainlaw.mpm_core.grid import elliptic
from grainlaw.mpm_core.grid.elliptic import solve

TIGHT = 1e-11


def faces(shape, periodic=(), closed=()):
    """Conductances of one between all cells but those beyond closed sides (axis, end)."""
    found = [np.ones(shape) for _ in shape]
    for axis, end in closed:
        np.moveaxis(found[axis], axis, 0)[0 if end == 0 else -2] = 0.0
    for axis in periodic:
        along = np.moveaxis(found[axis], axis, 0)
        along[0] = along[-2]
    return found


def direct(zeroth, conductances, is_unknown, source, periodic):
    """The same equations put together face by face and solved directly."""
    numbers = np.arange(source.size).reshape(source.shape)
    rows, columns, values = [], [], []
    for axis, k in enumerate(conductances):
        cells, face = np.moveaxis(numbers, axis, 0), np.moveaxis(k, axis, 0)
        pairs = [(cells[i], cells[i + 1], face[i]) for i in range(len(cells) - 1)]
        if axis in periodic:
            pairs = [*pairs[1:-1], (cells[-2], cells[1], face[-2])]
        for one, other, coupling in pairs:
            for a, b in ((one, other), (other, one)):
                rows += [a.ravel(), a.ravel()]
                columns += [a.ravel(), b.ravel()]
                values += [coupling.ravel(), -coupling.ravel()]
    size = source.size
    matrix = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (size, size)).tocsr()
    inside = np.flatnonzero(is_unknown.ravel())
    left = matrix[inside][:, inside] + coo_array((zeroth.ravel()[inside], (range(len(inside)), range(len(inside)))))
    psi = np.zeros(size)
    psi[inside] = spsolve(left.tocsc(), source.ravel()[inside])
    return psi.reshape(source.shape)


@pytest.mark.parametrize(
    ("shape", "periodic", "closed", "zeroth"),
    [
        ((23, 14), (), ((1, 0),), 0.0),
        ((24, 15), (0,), ((1, 0),), 0.0),
        ((25, 16), (0, 1), (), 0.3),
        ((12, 13), (), ((0, 0), (0, 1), (1, 0), (1, 1)), 1e-6),
        ((9, 10, 11), (1,), ((2, 0), (0, 0)), 0.0),
    ],
    ids=["free surface", "periodic", "all round", "closed to the lid", "three axes"],
)
def test_it_solves_the_equations(shape, periodic, closed, zeroth):
    random = np.random.default_rng(4)
    is_unknown = np.zeros(shape, bool)
    inner = tuple(slice(1, -1) for _ in shape)
    hole = random.random(tuple(n - 2 for n in shape)) < (0.1 if zeroth == 0.0 else 0.0)
    is_unknown[inner] = ~hole
    conductances = faces(shape, periodic, closed)
    if not periodic:
        # Some faces conduct less, and some are walls; both copies of a periodic one would have to be the same.
        conductances = [k * random.choice([1.0, 0.3, 0.0], p=[0.8, 0.15, 0.05], size=shape) for k in conductances]
    source = random.normal(size=shape)
    found = solve(np.full(shape, zeroth or 1e-7), conductances, is_unknown, source, periodic, TIGHT)
    expected = direct(np.full(shape, zeroth or 1e-7), conductances, is_unknown, source, periodic)
    np.testing.assert_allclose(found.psi, expected, atol=1e-7 * np.abs(expected).max())
    assert (found.psi[~is_unknown] == 0.0).all()


def waves(cells):
    """Largest error of psi = sin(pi x) sin(pi y) on the unit square, whose sides are air half a cell away."""
    shape = (cells + 2, cells + 2)
    h = 1.0 / (cells + 1)
    x = np.arange(cells + 2) * h
    exact = np.outer(np.sin(np.pi * x), np.sin(np.pi * x))
    is_unknown = np.zeros(shape, bool)
    is_unknown[1:-1, 1:-1] = True
    found = solve(np.zeros(shape), faces(shape), is_unknown, 2.0 * (np.pi * h) ** 2 * exact, (), TIGHT)
    return np.abs(found.psi - exact).max()


def test_it_converges_with_second_order_to_an_exact_solution():
    errors = [waves(cells) for cells in (15, 31, 63)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.05)


def iterations(cells):
    shape = (2 * cells + 2, cells + 2)
    is_unknown = np.zeros(shape, bool)
    is_unknown[1:-1, 1:-1] = True
    source = np.random.default_rng(1).normal(size=shape)
    return solve(np.zeros(shape), faces(shape, (), ((1, 0),)), is_unknown, source, (), 1e-6).iterations


def test_eight_times_as_many_cells_along_an_axis_take_few_more_iterations():
    assert iterations(160) < 2.0 * iterations(20)


@pytest.mark.parametrize("cells", [(13, 22), (26, 15), (21, 11), (7, 6, 9)], ids=str)
def test_mirror_images_and_turned_problems_have_mirrored_and_turned_solutions_however_loose_the_tolerance(cells):
    shape = tuple(n + 2 for n in cells)
    random = np.random.default_rng(2)
    is_unknown = np.zeros(shape, bool)
    is_unknown[(slice(1, -1),) * len(cells)] = random.random(cells) < 0.9
    source = random.normal(size=shape)

    def solved(unknown, right):
        return solve(np.zeros(right.shape), faces(right.shape), unknown, right, (), 1e-2).psi

    expected = solved(is_unknown, source)
    tight = {"rtol": 0.0, "atol": 1e-12 * np.abs(expected).max()}
    for axis in range(len(cells)):
        mirrored = solved(np.flip(is_unknown, axis), np.flip(source, axis))
        np.testing.assert_allclose(np.flip(mirrored, axis), expected, **tight)
    np.testing.assert_allclose(solved(is_unknown.T, source.T).T, expected, **tight)


def test_what_does_not_converge_is_said(monkeypatch):
    shape = (8, 8)
    closed = faces(shape, (), ((0, 0), (0, 1), (1, 0), (1, 1)))
    is_unknown = np.zeros(shape, bool)
    is_unknown[1:-1, 1:-1] = True
    monkeypatch.setattr(elliptic, "_conjugate_gradients", lambda *_: elliptic.MOST_ITERATIONS + 1)
    with pytest.raises(SimulationError, match="36 cells did not converge in 400 iterations"):
        solve(np.zeros(shape), closed, is_unknown, np.ones(shape), (), 1e-6)
