"""Gathering from the nodes of their stencils what points receive, four components of a node side by side."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.extending import register_jitable

from materials.compilation import named
from mpm_core.basis import Basis
from mpm_core.grid import COMPONENTS
from mpm_core.lane_arithmetic import filled_like, scaled_sum
from mpm_core.lanes import LANES, first_half, put, quad_at, second_half, single_quad_at, twice_at, two_numbers
from mpm_core.sources import CORE_MARK
from mpm_core.stencils import GROUP


def make_gather(basis: Basis, component: int, with_gradients: bool, precision: str) -> Callable[..., Any]:
    """A function that fills what a group receives of four components of the nodes, and of their gradients."""
    if with_gradients and precision == "single":
        return _make_gather_together(basis, component)
    width, first_component = basis.width, np.uint64(component)
    components_at = quad_at if precision == "double" else single_quad_at

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{component}_{with_gradients:d}_{precision}_{CORE_MARK}")
    def gather(count, nodes, nodes_y, receiving, gathered):  # type: ignore[no-untyped-def]
        starts, weights_x, weights_y, slopes_x, slopes_y, _, _ = receiving
        means, gradients_x, gradients_y = gathered
        row_length = np.uint64(nodes_y * COMPONENTS)
        for k in range(count):
            row = np.uint64(starts[k]) * np.uint64(COMPONENTS) + first_component
            nothing = filled_like(0.0, components_at(nodes, row))
            mean, gradient_x, gradient_y = nothing, nothing, nothing
            for a in range(width):
                in_row, gradient = nothing, nothing
                for b in range(width):
                    at = np.uint64(b * GROUP) + k
                    values = components_at(nodes, row + np.uint64(b * COMPONENTS))
                    in_row = scaled_sum(weights_y[at], values, in_row)
                    if with_gradients:
                        gradient = scaled_sum(slopes_y[at], values, gradient)
                at = np.uint64(a * GROUP) + k
                mean = scaled_sum(weights_x[at], in_row, mean)
                if with_gradients:
                    gradient_x = scaled_sum(slopes_x[at], in_row, gradient_x)
                    gradient_y = scaled_sum(weights_x[at], gradient, gradient_y)
                row += row_length
            put(means, LANES * k, mean)
            if with_gradients:
                put(gradients_x, LANES * k, gradient_x)
                put(gradients_y, LANES * k, gradient_y)

    return gather


def _make_gather_together(basis: Basis, component: int) -> Callable[..., Any]:
    """The same for singles: a sum along y and its gradient, of half a register each, together in one."""
    width, first_component = basis.width, np.uint64(component)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{component}_{CORE_MARK}")
    def gather_together(count, nodes, nodes_y, receiving, gathered):  # type: ignore[no-untyped-def]
        starts, weights_x, weights_y, slopes_x, slopes_y, _, _ = receiving
        means, gradients_x, gradients_y = gathered
        row_length = np.uint64(nodes_y * COMPONENTS)
        for k in range(count):
            row = np.uint64(starts[k]) * np.uint64(COMPONENTS) + first_component
            mean_and_gradient_y = filled_like(0.0, twice_at(nodes, row))
            gradient_x = filled_like(0.0, single_quad_at(nodes, row))
            for a in range(width):
                in_row = filled_like(0.0, mean_and_gradient_y)
                for b in range(width):
                    at = np.uint64(b * GROUP) + k
                    both = two_numbers(weights_y[at], slopes_y[at])
                    in_row = scaled_sum(both, twice_at(nodes, row + np.uint64(b * COMPONENTS)), in_row)
                at = np.uint64(a * GROUP) + k
                mean_and_gradient_y = scaled_sum(weights_x[at], in_row, mean_and_gradient_y)
                gradient_x = scaled_sum(slopes_x[at], first_half(in_row), gradient_x)
                row += row_length
            put(means, LANES * k, first_half(mean_and_gradient_y))
            put(gradients_x, LANES * k, gradient_x)
            put(gradients_y, LANES * k, second_half(mean_and_gradient_y))

    return gather_together
