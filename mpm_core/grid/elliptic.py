"""The elliptic problem a psi - div(k grad psi) = f on some cells of a box, by conjugate gradients with multigrid.

Arrays hold a box of cells with one layer of padding around it, in two or three axes alike. Flattened, the neighbour of
cell c along an axis is c + stride, and nothing couples to the padding. Cells on opposite sides of a periodic axis are
coupled by links. A cell that is no unknown has zeros everywhere, and so has the solution there.

The preconditioner is one V-cycle on aggregates (Braess 1995, Computing 55, 379): cells are joined two by two along
every axis; the sums of their equations, halved as the middles of coarser cells are farther apart, are the coarser
problem; damped Jacobi steps smooth. It is symmetric, and the number of iterations hardly grows with the number of
cells. Sums are taken in the order of the cells: the bits do not depend on the number of threads.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials import SimulationError
from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.sources import CORE_MARK

DAMPING = 0.8
# A level with no more cells is the coarsest; Jacobi steps there damp what is left.
FEWEST_CELLS, STEPS_AT_COARSEST = 40, 8
# Iterations beyond which something is wrong: many times what the hardest problems take.
MOST_ITERATIONS = 400


class Hierarchy(NamedTuple):
    """The equations of all levels one behind the other, the finest first, for compiled code.

    starts          where the cells of each level begin in the arrays below, and where the last ends
    strides         distances between neighbours along each axis, shape (levels, axes)
    diagonal        of each cell, zero where it is no unknown
    couplings       of each cell with the next one along each axis, shape (axes, cells)
    parents         the coarser cell that each cell is part of, counted from the start of its level
    links           pairs of cells coupled across periodic sides, shape (levels, links, 2)
    link_couplings  their couplings, shape (levels, links)
    """

    starts: NDArray[np.int64]
    strides: NDArray[np.int64]
    diagonal: NDArray[np.float64]
    couplings: NDArray[np.float64]
    parents: NDArray[np.int32]
    links: NDArray[np.int64]
    link_couplings: NDArray[np.float64]


class Solution(NamedTuple):
    """What was found: psi, and how many iterations it took."""

    psi: NDArray[np.float64]
    iterations: int


def solve(
    zeroth: NDArray[np.float64],
    conductances: Sequence[NDArray[np.float64]],
    is_unknown: NDArray[np.bool_],
    source: NDArray[np.float64],
    periodic_axes: Sequence[int],
    tolerance: float,
) -> Solution:
    """Solve a psi - div(k grad psi) = f in units of the cell size, to a root mean square residual of `tolerance`.

    All arrays have the shape of the padded box, in two or three axes. `zeroth` is a of each cell, `conductances` k of
    the face between each cell and the next along each axis. Where a cell is no unknown psi is zero, as in the air
    beyond a free surface; a face without conductance is a wall. Along a periodic axis the box is the whole domain, and
    the face behind the last cell is that before the first.
    Cells that are closed off from any free surface need some a > 0, or there is no solution but for a source that adds
    up to zero. Raises SimulationError if the residual does not get there.
    """
    levels = _hierarchy(zeroth, conductances, is_unknown, periodic_axes)
    right = np.where(is_unknown, source, 0.0).ravel()
    count = int(np.count_nonzero(is_unknown))
    psi = np.zeros_like(right)
    iterations = _conjugate_gradients(levels, right, psi, tolerance * np.sqrt(count))
    if iterations > MOST_ITERATIONS:
        raise SimulationError(f"an elliptic problem of {count} cells did not converge in {MOST_ITERATIONS} iterations")
    return Solution(psi.reshape(source.shape), iterations)


def _hierarchy(
    zeroth: NDArray[np.float64],
    conductances: Sequence[NDArray[np.float64]],
    is_unknown: NDArray[np.bool_],
    periodic_axes: Sequence[int],
) -> Hierarchy:
    shapes = _shapes(is_unknown.shape)
    starts = np.cumsum([0, *(math.prod(shape) for shape in shapes)])
    strides = np.array([[math.prod(shape[axis + 1 :]) for axis in range(len(shape))] for shape in shapes])
    links, link_couplings = _links(conductances, is_unknown, periodic_axes)
    levels = Hierarchy(
        starts,
        strides,
        np.zeros(starts[-1]),
        np.zeros((len(shapes[0]), starts[-1])),
        np.zeros(starts[-1], np.int32),
        np.zeros((len(shapes), *links.shape), np.int64),
        np.zeros((len(shapes), len(links))),
    )
    for number in range(len(shapes) - 1):
        levels.parents[starts[number] : starts[number + 1]] = _parents(shapes[number], shapes[number + 1])
    levels.links[0], levels.link_couplings[0] = links, link_couplings
    faces = np.stack([_inner_faces(k, axis, periodic_axes).ravel() for axis, k in enumerate(conductances)])
    _assemble(levels, zeroth.ravel(), faces, is_unknown.ravel())
    return levels


def _shapes(finest: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Cells along each axis of all levels, with one layer of padding around them."""
    shapes = [finest]
    while math.prod(shapes[-1]) > FEWEST_CELLS and max(shapes[-1]) > 3:
        shapes.append(tuple(int(_joined_along(cells)[-1]) + 1 for cells in shapes[-1]))
    return shapes


def _joined_along(cells: int) -> NDArray[np.int32]:
    """The number of the coarser cell that each cell along an axis is part of, padding included.

    Two by two from both ends; of an odd number of cells the one in the middle is alone, or three are joined there. A
    mirror image is thus joined in mirror image, and solved like what it mirrors.
    """
    inner = cells - 2
    from_end = np.arange(inner, dtype=np.int32) // 2
    coarser = inner // 2 + (1 if inner % 4 == 1 else 0)
    from_below = np.arange(inner) < (inner + 1) // 2
    joined = np.where(from_below, from_end, coarser - 1 - from_end[::-1])
    return np.concatenate([[0], joined + 1, [coarser + 1]]).astype(np.int32)


def _parents(shape: tuple[int, ...], coarser_shape: tuple[int, ...]) -> NDArray[np.int32]:
    parents = np.zeros((1,) * len(shape), np.int32)
    for axis, (cells, coarser_cells) in enumerate(zip(shape, coarser_shape, strict=True)):
        along = _joined_along(cells).reshape([-1 if k == axis else 1 for k in range(len(shape))])
        parents = parents * coarser_cells + along
    return parents.ravel()


def _links(
    conductances: Sequence[NDArray[np.float64]], is_unknown: NDArray[np.bool_], periodic_axes: Sequence[int]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Pairs of cells across periodic sides of which one is an unknown, and their couplings."""
    numbers = np.arange(is_unknown.size).reshape(is_unknown.shape)
    links, couplings = [np.empty((0, 2), np.int64)], [np.empty(0)]
    for axis in periodic_axes:
        links.append(np.stack([np.moveaxis(numbers, axis, 0)[k].ravel() for k in (-2, 1)], axis=1))
        couplings.append(np.moveaxis(conductances[axis], axis, 0)[-2].ravel())
    return np.concatenate(links), np.concatenate(couplings)


def _inner_faces(faces: NDArray[np.float64], axis: int, periodic_axes: Sequence[int]) -> NDArray[np.float64]:
    """The faces between neighbours in the box; those of periodic sides are links."""
    inner = faces.copy()
    along = np.moveaxis(inner, axis, 0)
    along[-1] = 0.0
    if axis in periodic_axes:
        along[0] = along[-2] = 0.0
    return inner


@njit(cache=True)
@named(CORE_MARK)
def _assemble(levels, zeroth, faces, is_unknown):  # type: ignore[no-untyped-def]
    """Fill in the equations: of the finest level from the faces, of the others from those below."""
    for c in range(len(zeroth)):
        levels.diagonal[c] = zeroth[c] if is_unknown[c] else 0.0
    for axis in range(len(faces)):
        stride = levels.strides[0, axis]
        for c in range(len(zeroth) - stride):
            levels.couplings[axis, c] = _coupled(levels.diagonal, is_unknown, c, c + stride, faces[axis, c])
    for k in range(levels.links.shape[1]):
        one, other = levels.links[0, k]
        levels.link_couplings[0, k] = _coupled(levels.diagonal, is_unknown, one, other, levels.link_couplings[0, k])
    for number in range(len(levels.starts) - 2):
        _join_cells(levels, number)


@register_jitable
def _coupled(diagonal, is_unknown, one, other, face):  # type: ignore[no-untyped-def]
    """Count a face in the equations of the unknowns beside it; returns the coupling between two of them."""
    if is_unknown[one]:
        diagonal[one] += face
    if is_unknown[other]:
        diagonal[other] += face
    return face if is_unknown[one] and is_unknown[other] else 0.0


@register_jitable
def _join_cells(levels, number):  # type: ignore[no-untyped-def]
    """The sums of the equations of the cells that are joined, halved, and couplings between them no more."""
    start, coarser = levels.starts[number], levels.starts[number + 1]
    for c in range(start, coarser):
        parent = coarser + levels.parents[c]
        levels.diagonal[parent] += 0.5 * levels.diagonal[c]
        for axis in range(levels.strides.shape[1]):
            coupling = levels.couplings[axis, c]
            if coupling > 0.0:
                if coarser + levels.parents[c + levels.strides[number, axis]] == parent:
                    levels.diagonal[parent] -= coupling
                else:
                    levels.couplings[axis, parent] += 0.5 * coupling
    for k in range(levels.links.shape[1]):
        for end in range(2):
            levels.links[number + 1, k, end] = levels.parents[start + levels.links[number, k, end]]
        levels.link_couplings[number + 1, k] = 0.5 * levels.link_couplings[number, k]


@njit(cache=True, error_model="numpy")
@named(CORE_MARK)
def _conjugate_gradients(levels, source, psi, tolerance):  # type: ignore[no-untyped-def]
    """Bring psi from zero to a residual whose norm is at most `tolerance`; returns the number of iterations."""
    residual = source.copy()
    memory = np.zeros((3, levels.starts[-1]))
    image = np.zeros_like(source)
    direction = np.zeros_like(source)
    before = 1.0
    for iteration in range(MOST_ITERATIONS + 1):
        if not np.sqrt(_product(residual, residual)) > tolerance:
            return iteration
        _v_cycle(levels, residual, memory)
        step = memory[1, : len(source)]
        now = _product(residual, step)
        ratio = now / before if iteration > 0 else 0.0
        for c in range(len(direction)):
            direction[c] = step[c] + ratio * direction[c]
        _apply(levels, 0, direction, image)
        length = now / _product(direction, image)
        for c in range(len(psi)):
            psi[c] += length * direction[c]
            residual[c] -= length * image[c]
        before = now
    return MOST_ITERATIONS + 1


@register_jitable
def _product(a, b):  # type: ignore[no-untyped-def]
    total = 0.0
    for c in range(len(a)):
        total += a[c] * b[c]
    return total


@register_jitable
def _apply(levels, number, x, image):  # type: ignore[no-untyped-def]
    """The left side of the equations of a level."""
    start, end = levels.starts[number], levels.starts[number + 1]
    diagonal = levels.diagonal[start:end]
    for c in range(len(x)):
        image[c] = diagonal[c] * x[c]
    for axis in range(levels.strides.shape[1]):
        stride, coupling = levels.strides[number, axis], levels.couplings[axis, start:end]
        for c in range(len(x) - stride):
            image[c] -= coupling[c] * x[c + stride]
        for c in range(len(x) - stride):
            image[c + stride] -= coupling[c] * x[c]
    for k in range(levels.links.shape[1]):
        one, other, coupling = levels.links[number, k, 0], levels.links[number, k, 1], levels.link_couplings[number, k]
        image[one] -= coupling * x[other]
        image[other] -= coupling * x[one]


@register_jitable
def _v_cycle(levels, residual, memory):  # type: ignore[no-untyped-def]
    """An approximate solution for a residual on the finest level, in `memory[1]`.

    On each level `memory` holds the right side, the solution, and what the left side makes of it.
    """
    coarsest = len(levels.starts) - 2
    memory[0, : len(residual)] = residual
    for number in range(coarsest):
        start, end = levels.starts[number], levels.starts[number + 1]
        right, x, image = memory[0, start:end], memory[1, start:end], memory[2, start:end]
        diagonal, parents = levels.diagonal[start:end], levels.parents[start:end]
        for c in range(len(x)):
            x[c] = DAMPING * right[c] / diagonal[c] if diagonal[c] > 0.0 else 0.0
        _apply(levels, number, x, image)
        coarser_right = memory[0, end : levels.starts[number + 2]]
        coarser_right[:] = 0.0
        for c in range(len(x)):
            coarser_right[parents[c]] += right[c] - image[c]
    start, end = levels.starts[coarsest], levels.starts[coarsest + 1]
    memory[1, start:end] = 0.0
    for _ in range(STEPS_AT_COARSEST):
        _smooth(levels, coarsest, memory)
    for number in range(coarsest - 1, -1, -1):
        start, end = levels.starts[number], levels.starts[number + 1]
        x, coarser, parents = (
            memory[1, start:end],
            memory[1, end : levels.starts[number + 2]],
            levels.parents[start:end],
        )
        for c in range(len(x)):
            x[c] += coarser[parents[c]]
        _smooth(levels, number, memory)


@register_jitable
def _smooth(levels, number, memory):  # type: ignore[no-untyped-def]
    """A damped Jacobi step."""
    start, end = levels.starts[number], levels.starts[number + 1]
    right, x, image, diagonal = (
        memory[0, start:end],
        memory[1, start:end],
        memory[2, start:end],
        levels.diagonal[start:end],
    )
    _apply(levels, number, x, image)
    for c in range(len(x)):
        x[c] = x[c] + DAMPING * (right[c] - image[c]) / diagonal[c] if diagonal[c] > 0.0 else 0.0
