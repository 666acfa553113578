"""Interpolating from the nodes of their stencils to points, four components of a node side by side."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import filled_like, scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import (
    LANES,
    first_half,
    put,
    quad_at,
    second_half,
    twice_at,
    two_numbers,
)
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP


def make_gather(basis: Basis, component: int, with_gradients: bool, precision: str) -> Callable[..., Any]:
    """A function that interpolates four components of the nodes to a group, and their gradients.

    With gradients, a sum along y and its gradient go side by side.
    """
    width, first_component = basis.width, np.uint64(component)
    values_at, weights_at = (twice_at, _weight_and_slope) if with_gradients else (quad_at, _weight)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{component}_{with_gradients:d}_{precision}_{CORE_MARK}")
    def gather(count, nodes, column, stencils, interpolated):  # type: ignore[no-untyped-def]
        first_nodes, weights_x, weights_y, slopes_x, slopes_y, _, _ = stencils
        means, gradients_x, gradients_y = interpolated
        row_length = np.uint64(column * COMPONENTS)
        for k in range(count):
            row = np.uint64(first_nodes[k]) * np.uint64(COMPONENTS) + first_component
            along_y = filled_like(0.0, values_at(nodes, row))
            gradient_x = first_half(along_y)
            for a in range(width):
                in_row = filled_like(0.0, along_y)
                for b in range(width):
                    at = np.uint64(b * GROUP) + k
                    values = values_at(nodes, row + np.uint64(b * COMPONENTS))
                    in_row = scaled_sum(weights_at(weights_y, slopes_y, at), values, in_row)
                at = np.uint64(a * GROUP) + k
                along_y = scaled_sum(weights_x[at], in_row, along_y)
                if with_gradients:
                    gradient_x = scaled_sum(slopes_x[at], first_half(in_row), gradient_x)
                row += row_length
            if with_gradients:
                put(means, LANES * k, first_half(along_y))
                put(gradients_x, LANES * k, gradient_x)
                put(gradients_y, LANES * k, second_half(along_y))
            else:
                put(means, LANES * k, along_y)

    return gather


@register_jitable(forceinline=True)
def _weight(weights_y, slopes_y, at):  # type: ignore[no-untyped-def]
    return weights_y[at]


@register_jitable(forceinline=True)
def _weight_and_slope(weights_y, slopes_y, at):  # type: ignore[no-untyped-def]
    return two_numbers(weights_y[at], slopes_y[at])
