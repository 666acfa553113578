"""Adding what points bring to the nodes of their stencils in three dimensions, a register of a node at a time.

A node fills two registers in double precision, one in single. Each register is taken through the whole stencil by
itself: all that it needs then stays in registers, for two neighbours that share their stencil.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, put, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP_3D


class P2GContributions3D(NamedTuple):
    """What the points of a group contribute to their nodes, in the precision of the grid.

    first_nodes       number of the first node of each point
    weights           w of each node, those of one node for the whole group side by side
    values            the components of the first node, those of each point side by side, before they are weighed
    along_x, along_y, along_z  what is added to them from node to node along an axis
    """

    first_nodes: Any
    weights: Any
    values: Any
    along_x: Any
    along_y: Any
    along_z: Any


def make_scatter_one_3d(basis: Basis) -> Callable[..., Any]:
    """A function that adds a register of what a point brings to its nodes."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_one_3d(plane, lengths, k, at, nodes, contributions):  # type: ignore[no-untyped-def]
        weights, at_plane = contributions.weights, several_at(contributions.values, at)
        along_x, along_y = several_at(contributions.along_x, at), several_at(contributions.along_y, at)
        along_z = several_at(contributions.along_z, at)
        for a in range(width):
            at_row, row = at_plane, plane
            for b in range(width):
                at_node = at_row
                for c in range(width):
                    node, first = row + np.uint64(c * COMPONENTS), np.uint64(((a * width + b) * width + c) * GROUP_3D)
                    put(nodes, node, scaled_sum(weights[first + k], at_node, several_at(nodes, node)))
                    at_node = at_node + along_z
                at_row = at_row + along_y
                row += lengths[1]
            at_plane = at_plane + along_x
            plane += lengths[0]

    return scatter_one_3d


def make_scatter_two_3d(basis: Basis) -> Callable[..., Any]:
    """A function that adds a register of what a point and the next one bring to the nodes that they share."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_two_3d(plane, lengths, k, at, nodes, contributions):  # type: ignore[no-untyped-def]
        m, at_2 = k + np.uint64(1), at + np.uint64(COMPONENTS)
        weights, values = contributions.weights, contributions.values
        at_plane, at_plane_2 = several_at(values, at), several_at(values, at_2)
        along_x, along_x_2 = several_at(contributions.along_x, at), several_at(contributions.along_x, at_2)
        along_y, along_y_2 = several_at(contributions.along_y, at), several_at(contributions.along_y, at_2)
        along_z, along_z_2 = several_at(contributions.along_z, at), several_at(contributions.along_z, at_2)
        for a in range(width):
            at_row, at_row_2, row = at_plane, at_plane_2, plane
            for b in range(width):
                at_node, at_node_2 = at_row, at_row_2
                for c in range(width):
                    node, first = row + np.uint64(c * COMPONENTS), np.uint64(((a * width + b) * width + c) * GROUP_3D)
                    with_one = scaled_sum(weights[first + k], at_node, several_at(nodes, node))
                    put(nodes, node, scaled_sum(weights[first + m], at_node_2, with_one))
                    at_node, at_node_2 = at_node + along_z, at_node_2 + along_z_2
                at_row, at_row_2 = at_row + along_y, at_row_2 + along_y_2
                row += lengths[1]
            at_plane, at_plane_2 = at_plane + along_x, at_plane_2 + along_x_2
            plane += lengths[0]

    return scatter_two_3d


def make_scatter_3d(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that adds what the points of a group bring to a grid."""
    scatter_one, scatter_two, in_register = make_scatter_one_3d(basis), make_scatter_two_3d(basis), LANES_OF[precision]

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def scatter_3d(count, nodes, strides, contributions):  # type: ignore[no-untyped-def]
        first_nodes = contributions.first_nodes
        lengths = np.uint64(strides[0] * COMPONENTS), np.uint64(strides[1] * COMPONENTS)
        k = np.uint64(0)
        while k < count:
            first, at = np.uint64(first_nodes[k]) * np.uint64(COMPONENTS), np.uint64(COMPONENTS) * k
            if k + np.uint64(1) < count and first_nodes[k + np.uint64(1)] == first_nodes[k]:
                for lane in range(0, COMPONENTS, in_register):
                    scatter_two(first + np.uint64(lane), lengths, k, at + np.uint64(lane), nodes, contributions)
                k += np.uint64(2)
            else:
                for lane in range(0, COMPONENTS, in_register):
                    scatter_one(first + np.uint64(lane), lengths, k, at + np.uint64(lane), nodes, contributions)
                k += np.uint64(1)

    return scatter_3d
