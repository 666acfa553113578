"""Adding what points bring to the nodes of their stencils, all components of a node side by side.

Momentum and force change from node to node, bulk quantities do not. Neighbours in memory mostly share their stencil:
two of them go to it together, for the loads and stores of one.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES, half_oct_at, oct_at, put
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP


@register_jitable(forceinline=True)
def increments_at(increments, k):  # type: ignore[no-untyped-def]
    """What a point adds from node to node along x and y, to all components of which half do not change."""
    return half_oct_at(increments, COMPONENTS * k), half_oct_at(increments, COMPONENTS * k + np.uint64(LANES))


def make_scatter_one(basis: Basis) -> Callable[..., Any]:
    """A function that adds what a point brings to its nodes."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_one(row, row_length, k, nodes, contributions):  # type: ignore[no-untyped-def]
        _, weights, values, increments = contributions
        at_row = oct_at(values, COMPONENTS * k)
        increment_x, increment_y = increments_at(increments, k)
        for a in range(width):
            at_node = at_row
            for b in range(width):
                node = row + np.uint64(b * COMPONENTS)
                weight = weights[np.uint64((a * width + b) * GROUP) + k]
                put(nodes, node, scaled_sum(weight, at_node, oct_at(nodes, node)))
                at_node = at_node + increment_y
            at_row = at_row + increment_x
            row += row_length

    return scatter_one


def make_scatter_two(basis: Basis) -> Callable[..., Any]:
    """A function that adds what a point and the next one bring to the nodes that they share."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_two(row, row_length, k, nodes, contributions):  # type: ignore[no-untyped-def]
        _, weights, values, increments = contributions
        m = k + np.uint64(1)
        at_row, at_row_2 = oct_at(values, COMPONENTS * k), oct_at(values, COMPONENTS * m)
        increment_x, increment_y = increments_at(increments, k)
        increment_x_2, increment_y_2 = increments_at(increments, m)
        for a in range(width):
            at_node, at_node_2 = at_row, at_row_2
            for b in range(width):
                node, first = row + np.uint64(b * COMPONENTS), np.uint64((a * width + b) * GROUP)
                with_one = scaled_sum(weights[first + k], at_node, oct_at(nodes, node))
                put(nodes, node, scaled_sum(weights[first + m], at_node_2, with_one))
                at_node, at_node_2 = at_node + increment_y, at_node_2 + increment_y_2
            at_row, at_row_2 = at_row + increment_x, at_row_2 + increment_x_2
            row += row_length

    return scatter_two


def make_scatter(basis: Basis) -> Callable[..., Any]:
    """A function that adds what the points of a group bring to a grid."""
    scatter_one, scatter_two = make_scatter_one(basis), make_scatter_two(basis)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter(count, nodes, column, contributions):  # type: ignore[no-untyped-def]
        first_nodes, row_length = contributions.first_nodes, np.uint64(column * COMPONENTS)
        k = np.uint64(0)
        while k < count:
            row = np.uint64(first_nodes[k]) * np.uint64(COMPONENTS)
            if k + np.uint64(1) < count and first_nodes[k + np.uint64(1)] == first_nodes[k]:
                scatter_two(row, row_length, k, nodes, contributions)
                k += np.uint64(2)
            else:
                scatter_one(row, row_length, k, nodes, contributions)
                k += np.uint64(1)

    return scatter
