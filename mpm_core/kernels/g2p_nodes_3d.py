"""Interpolating from the nodes of their stencils to points in three dimensions, a register of a node at a time.

Sums along the last axis come first: over a row of nodes the values and their first moments, over the rows of a plane
the sums of both and the first moments of the former, over the planes likewise. That is four multiply-adds and less for
a node, of which plain sums take eight. Moments count from the node in the middle of the stencil, which costs least.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import filled_like, scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, put, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP_3D


class Interpolated3D(NamedTuple):
    """The components of the nodes at the points of a group, those of each point side by side.

    means                          sum of w v
    moments_x, moments_y, moments_z  sum of w v (i - middle) along each axis
    """

    means: Any
    moments_x: Any
    moments_y: Any
    moments_z: Any


def middle_of(basis: Basis) -> int:
    """The node of a stencil, along an axis, from which moments count."""
    return (basis.width - 1) // 2


def make_with_moment(basis: Basis) -> Callable[..., Any]:
    """A function that adds a node to a sum, and to its first moment; nodes come in their order."""
    middle = middle_of(basis)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def with_moment(node, weight, value, total, moment):  # type: ignore[no-untyped-def]
        total = scaled_sum(weight, value, total)
        if node < middle:
            # the first node alone lies before the middle: what there is
            moment = -0.0 - total
        elif node > middle:
            moment = scaled_sum(float(node - middle) * weight, value, moment)
        return total, moment

    return with_moment


def make_gather_one_3d(basis: Basis) -> Callable[..., Any]:
    """A function that interpolates a register of the nodes to a point."""
    width, with_moment = basis.width, make_with_moment(basis)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def gather_one_3d(plane, lengths, k, at, nodes, weights_x, weights_y, weights_z, interpolated):  # type: ignore[no-untyped-def]
        nothing = filled_like(0.0, several_at(nodes, plane))
        mean, moment_x, moment_y, moment_z = nothing, nothing, nothing, nothing
        for a in range(width):
            row, in_plane, in_plane_y, in_plane_z = plane, nothing, nothing, nothing
            for b in range(width):
                in_row, in_row_z = nothing, nothing
                for c in range(width):
                    value, weight = (
                        several_at(nodes, row + np.uint64(c * COMPONENTS)),
                        weights_z[np.uint64(c * GROUP_3D) + k],
                    )
                    in_row, in_row_z = with_moment(c, weight, value, in_row, in_row_z)
                weight = weights_y[np.uint64(b * GROUP_3D) + k]
                in_plane, in_plane_y = with_moment(b, weight, in_row, in_plane, in_plane_y)
                in_plane_z = scaled_sum(weight, in_row_z, in_plane_z)
                row += lengths[1]
            weight = weights_x[np.uint64(a * GROUP_3D) + k]
            mean, moment_x = with_moment(a, weight, in_plane, mean, moment_x)
            moment_y = scaled_sum(weight, in_plane_y, moment_y)
            moment_z = scaled_sum(weight, in_plane_z, moment_z)
            plane += lengths[0]
        put(interpolated.means, at, mean)
        put(interpolated.moments_x, at, moment_x)
        put(interpolated.moments_y, at, moment_y)
        put(interpolated.moments_z, at, moment_z)

    return gather_one_3d


def make_gather_3d(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that interpolates the nodes to a group, with their first moments."""
    gather_one, in_register = make_gather_one_3d(basis), LANES_OF[precision]

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def gather_3d(count, nodes, strides, stencils, interpolated):  # type: ignore[no-untyped-def]
        first_nodes, (weights_x, weights_y, weights_z) = stencils.first_nodes, stencils.weights
        lengths = np.uint64(strides[0] * COMPONENTS), np.uint64(strides[1] * COMPONENTS)
        for k in range(count):
            first = np.uint64(first_nodes[k]) * np.uint64(COMPONENTS)
            for lane in range(0, COMPONENTS, in_register):
                at = np.uint64(COMPONENTS) * k + np.uint64(lane)
                gather_one(
                    first + np.uint64(lane), lengths, k, at, nodes, weights_x, weights_y, weights_z, interpolated
                )

    return gather_3d
