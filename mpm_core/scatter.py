"""Adding what points bring to the nodes of their stencils, all components of a node side by side.

Momentum and force change from node to node, bulk quantities do not. Neighbours in memory mostly share their stencil:
two of them go to it together, for the loads and stores of one. In double precision a node is two `quads`, in single
precision one of the `octs`.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from materials.compilation import named
from mpm_core.basis import Basis
from mpm_core.grid import BULK, COMPONENTS
from mpm_core.octs import half_oct_at, oct_at, oct_sum, put_oct, scaled_oct_sum
from mpm_core.quads import LANES, put_quad, quad_at, scaled_sum
from mpm_core.sources import CORE_MARK
from mpm_core.stencils import GROUP


class Node(NamedTuple):
    """The components of a node in double precision: two quads, of which the first changes from node to node."""

    moving: Any
    bulk: Any


class Components(NamedTuple):
    """How compiled code goes about the components of a node.

    load   (array, position) -> those from a position on
    store  (array, position, components) -> None
    step   (array, position) -> what is added from node to node
    moved  (components, step) -> those at the next node
    added  (weight, components, to) -> weight * components + to
    """

    load: Callable[..., Any]
    store: Callable[..., Any]
    step: Callable[..., Any]
    moved: Callable[..., Any]
    added: Callable[..., Any]


@register_jitable(forceinline=True)
def _load_node(array, position):  # type: ignore[no-untyped-def]
    return Node(quad_at(array, position), quad_at(array, position + np.uint64(BULK)))


@register_jitable(forceinline=True)
def _store_node(array, position, node):  # type: ignore[no-untyped-def]
    put_quad(array, position, node.moving)
    put_quad(array, position + np.uint64(BULK), node.bulk)


@register_jitable(forceinline=True)
def _moved_node(node, step):  # type: ignore[no-untyped-def]
    return Node(node.moving + step, node.bulk)


@register_jitable(forceinline=True)
def _added_node(weight, node, to):  # type: ignore[no-untyped-def]
    return Node(scaled_sum(weight, node.moving, to.moving), scaled_sum(weight, node.bulk, to.bulk))


COMPONENTS_IN = {
    "double": Components(_load_node, _store_node, quad_at, _moved_node, _added_node),
    "single": Components(oct_at, put_oct, half_oct_at, oct_sum, scaled_oct_sum),
}


def make_scatter_one(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that adds what a point brings to its nodes."""
    width, (load, store, step, moved, added) = basis.width, COMPONENTS_IN[precision]

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def scatter_one(row, row_length, k, nodes, bringing):  # type: ignore[no-untyped-def]
        _, weights, brought, steps_x, steps_y = bringing
        at_row = load(brought, COMPONENTS * k)
        step_x, step_y = step(steps_x, LANES * k), step(steps_y, LANES * k)
        for a in range(width):
            at_node = at_row
            for b in range(width):
                node = row + np.uint64(b * COMPONENTS)
                weight = weights[np.uint64((a * width + b) * GROUP) + k]
                store(nodes, node, added(weight, at_node, load(nodes, node)))
                at_node = moved(at_node, step_y)
            at_row = moved(at_row, step_x)
            row += row_length

    return scatter_one


def make_scatter_two(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that adds what a point and the next one bring to the nodes that they share."""
    width, (load, store, step, moved, added) = basis.width, COMPONENTS_IN[precision]

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def scatter_two(row, row_length, k, nodes, bringing):  # type: ignore[no-untyped-def]
        _, weights, brought, steps_x, steps_y = bringing
        m = k + np.uint64(1)
        at_row, at_row_2 = load(brought, COMPONENTS * k), load(brought, COMPONENTS * m)
        step_x, step_y = step(steps_x, LANES * k), step(steps_y, LANES * k)
        step_x_2, step_y_2 = step(steps_x, LANES * m), step(steps_y, LANES * m)
        for a in range(width):
            at_node, at_node_2 = at_row, at_row_2
            for b in range(width):
                node, first = row + np.uint64(b * COMPONENTS), np.uint64((a * width + b) * GROUP)
                with_one = added(weights[first + k], at_node, load(nodes, node))
                store(nodes, node, added(weights[first + m], at_node_2, with_one))
                at_node, at_node_2 = moved(at_node, step_y), moved(at_node_2, step_y_2)
            at_row, at_row_2 = moved(at_row, step_x), moved(at_row_2, step_x_2)
            row += row_length

    return scatter_two


def make_scatter(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that adds what the points of a group bring to a grid of this precision."""
    scatter_one, scatter_two = make_scatter_one(basis, precision), make_scatter_two(basis, precision)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def scatter(count, nodes, nodes_y, bringing):  # type: ignore[no-untyped-def]
        starts, row_length = bringing.starts, np.uint64(nodes_y * COMPONENTS)
        k = np.uint64(0)
        while k < count:
            row = np.uint64(starts[k]) * np.uint64(COMPONENTS)
            if k + np.uint64(1) < count and starts[k + np.uint64(1)] == starts[k]:
                scatter_two(row, row_length, k, nodes, bringing)
                k += np.uint64(2)
            else:
                scatter_one(row, row_length, k, nodes, bringing)
                k += np.uint64(1)

    return scatter
