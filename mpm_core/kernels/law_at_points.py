"""A law at the points: its state in their rows, its update, its short way for small steps, and its sound speed.

What is stored for a point is turned into numbers of the kind that the law computes with.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import register_jitable

from grainlaw.materials.compilation import PointwiseLaw, named
from grainlaw.materials.precision import PRECISIONS
from grainlaw.materials.single_precision import adaptable, in_precision
from grainlaw.materials.tensor import isotropic, pressure
from grainlaw.mpm_core.kernels.kinematics import kinematics
from grainlaw.mpm_core.kernels.simd.loop import loop_over_points
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.space import Space


@register_jitable
def replaced(values, k, value):  # type: ignore[no-untyped-def]
    """A copy of a tuple with one item replaced.

    A function of this module rather than a call in `load`: the disk cache is keyed on what a kernel closes over, and
    the compiler's intrinsic itself is another object in every process.
    """
    return tuple_setitem(values, k, value)  # type: ignore[call-arg]


@register_jitable
def ordered_bits(value):  # type: ignore[no-untyped-def]
    """The bits of a non-negative float as an integer: the same order, and NaN above everything.

    A maximum of integers is vectorised and keeps NaN; a maximum of floats does one or the other.
    """
    return np.float64(value).view(np.int64)


def make_state_access(
    space: Space, state_class: type[Any], mark: str, precision: str = "double"
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that load a law's state of one point from its rows, and store it."""
    zeros = (PRECISIONS[precision](0.0),) * len(state_class._fields)
    load_values, store_values = _load_none, _store_none
    for k in range(len(zeros)):
        row = layout_of(space).first_state + k
        load_values, store_values = _with_variable(k, row, load_values, store_values, mark, precision)

    @register_jitable
    @named(mark)
    def load(rows, p):  # type: ignore[no-untyped-def]
        return state_class(*load_values(rows, p, zeros))

    return load, store_values


@register_jitable
def _load_none(rows, p, values):  # type: ignore[no-untyped-def]
    return values


@register_jitable
def _store_none(rows, p, state):  # type: ignore[no-untyped-def]
    pass


def _with_variable(
    k: int,
    row: int,
    load_others: Callable[..., Any],
    store_others: Callable[..., Any],
    mark: str,
    precision: str,
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Access to one state variable more. Its row is fixed when the functions are made, as the compiler wants it."""
    number = PRECISIONS[precision]

    @register_jitable
    @named(f"{mark}_{k}")
    def load(rows, p, values):  # type: ignore[no-untyped-def]
        return replaced(load_others(rows, p, values), k, number(rows[row][p]))

    @register_jitable
    @named(f"{mark}_{k}")
    def store(rows, p, state):  # type: ignore[no-untyped-def]
        store_others(rows, p, state)
        rows[row][p] = state[k]

    return load, store


def make_apply_law(space: Space, law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The loop over points that calls a law; `coupling` are compressive strains besides those of the motion."""
    if law.small_step is None:
        return _make_update(space, law, mark)
    update = _make_update(space, law, mark)
    take_small_steps = _make_small_steps(space, law, law.small_step, mark)

    @register_jitable
    @named(mark)
    def apply_law(rows, first, last, coupling, parameters, dt):  # type: ignore[no-untyped-def]
        pending = np.empty(last - first, np.int64)
        take_small_steps(rows, first, last, coupling, parameters, dt, pending)
        for p in range(first, last):
            if pending[p - first]:
                update(rows, p, p + np.uint64(1), coupling[p - first :], parameters, dt)

    return apply_law


@adaptable
def with_coupling(strain_rate, coupling, dt):  # type: ignore[no-untyped-def]
    """A strain rate [1/s], less a compressive strain [1] over the step."""
    return strain_rate + isotropic(coupling * (-1.0 / (3.0 * dt)))


def _make_update(space: Space, law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    law_update, parameter_class, number = law.update, law.parameters, PRECISIONS[law.precision]
    of_point, coupled = kinematics(space, law.precision), in_precision(with_coupling, law.precision)
    stress_at, put_stress, strain_rate_at = of_point.stress, of_point.put_stress, of_point.strain_rate
    load, store = make_state_access(space, law.state, mark, law.precision)
    density_row = layout_of(space).density

    @register_jitable(forceinline=True)
    @named(mark)
    def update_one(p, rows, first, coupling, law_parameters, dt):  # type: ignore[no-untyped-def]
        stress = stress_at(rows, p)
        strain_rate = coupled(strain_rate_at(rows, p, dt), number(coupling[p - first]), dt)
        stress, state = law_update(stress, strain_rate, number(rows[density_row][p]), load(rows, p), law_parameters, dt)
        put_stress(rows, p, stress)
        store(rows, p, state)

    @register_jitable
    @named(mark)
    def update(rows, first, last, coupling, parameters, dt):  # type: ignore[no-untyped-def]
        loop_over_points(first, last, update_one, (rows, first, coupling, parameter_class(*parameters), number(dt)))

    return update


def _make_small_steps(space: Space, law: PointwiseLaw, small_step: Callable[..., Any], mark: str) -> Callable[..., Any]:
    """Without a branch but for what is stored, so that the compiler takes several points at once."""
    parameter_class, number = law.parameters, PRECISIONS[law.precision]
    of_point, coupled = kinematics(space, law.precision), in_precision(with_coupling, law.precision)
    stress_at, put_stress, strain_rate_at = of_point.stress, of_point.put_stress, of_point.strain_rate
    load, store = make_state_access(space, law.state, mark, law.precision)
    density_row = layout_of(space).density

    @register_jitable(forceinline=True)
    @named(mark)
    def take_one(p, rows, first, coupling, law_parameters, dt, pending):  # type: ignore[no-untyped-def]
        stress = stress_at(rows, p)
        strain_rate = coupled(strain_rate_at(rows, p, dt), number(coupling[p - first]), dt)
        state, density = load(rows, p), number(rows[density_row][p])
        stress, state, succeeded = small_step(stress, strain_rate, density, state, law_parameters, dt)
        pending[p - first] = not succeeded
        if succeeded:
            put_stress(rows, p, stress)
            store(rows, p, state)

    @register_jitable
    @named(mark)
    def take_small_steps(rows, first, last, coupling, parameters, dt, pending):  # type: ignore[no-untyped-def]
        arguments = rows, first, coupling, parameter_class(*parameters), number(dt), pending
        loop_over_points(first, last, take_one, arguments)

    return take_small_steps


def make_largest_signal_speed(space: Space, law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The largest sum of sound speed and speed of some points [m/s], as ordered bits; NaN if anything is not finite.

    Of single points: with largest sound speed and largest speed of a group apart, the step would depend on the order of
    the points, and a turned scene would not turn out the same.
    """
    sound_speed, parameter_class, number = law.sound_speed, law.parameters, PRECISIONS[law.precision]
    stress_at, (load, _) = (
        kinematics(space, law.precision).stress,
        make_state_access(space, law.state, mark, law.precision),
    )
    layout, in_3d = layout_of(space), space.axes == 3
    vx_row, vy_row, vz_row, density_row = *(layout.velocity + axis for axis in range(3)), layout.density

    @adaptable
    @named(mark)
    def largest_signal_speed(rows, first, last, parameters):  # type: ignore[no-untyped-def]
        vx, vy, vz = rows[vx_row], rows[vy_row], rows[vz_row]
        density, law_parameters = rows[density_row], parameter_class(*parameters)
        fastest = np.int64(0)
        for p in range(first, last):
            stress = stress_at(rows, p)
            sound = sound_speed(stress, number(density[p]), load(rows, p), law_parameters)
            not_finite = 0.0 * (stress.xx + stress.yy + stress.zz + stress.xy)
            squared = vx[p] * vx[p] + vy[p] * vy[p]
            if in_3d:
                not_finite += 0.0 * (stress.yz + stress.xz)
                squared += vz[p] * vz[p]
            fastest = max(fastest, ordered_bits(np.sqrt(squared) + sound + not_finite))
        return fastest

    return in_precision(largest_signal_speed, law.precision)


def make_largest_diffusivity(space: Space, law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The largest viscosity over density of some points [m2/s], as ordered bits; zero for a law without one."""
    if law.viscosity is None:
        return no_diffusivity
    viscosity, parameter_class, density_row = law.viscosity, law.parameters, layout_of(space).density
    of_point, (load, _) = kinematics(space, "double"), make_state_access(space, law.state, mark)
    stress_at, strain_rate_at = of_point.stress, of_point.strain_rate

    @register_jitable
    @named(mark)
    def largest_diffusivity(rows, first, last, parameters, dt):  # type: ignore[no-untyped-def]
        law_parameters, largest = parameter_class(*parameters), np.int64(0)
        for p in range(first, last):
            density, strain_rate = np.float64(rows[density_row][p]), strain_rate_at(rows, p, dt)
            found = viscosity(stress_at(rows, p), strain_rate, density, load(rows, p), law_parameters)
            largest = max(largest, ordered_bits(found / density))
        return largest

    return largest_diffusivity


@register_jitable
def no_diffusivity(rows, first, last, parameters, dt):  # type: ignore[no-untyped-def]
    """Nothing diffuses."""
    return np.int64(0)


def make_find_stiffness(space: Space, law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The stiffness rho c^2 of some points [Pa]: the mean of those at their own pressure and at that around them."""
    sound_speed, parameter_class, number = law.sound_speed, law.parameters, PRECISIONS[law.precision]
    stress_at, (load, _) = (
        kinematics(space, law.precision).stress,
        make_state_access(space, law.state, mark, law.precision),
    )
    density_row, pressure_row = layout_of(space).density, layout_of(space).neighbour_pressure

    @register_jitable
    @named(mark)
    def find_stiffness(rows, first, last, parameters, stiffness):  # type: ignore[no-untyped-def]
        law_parameters = parameter_class(*parameters)
        for p in range(first, last):
            density, stress, state = number(rows[density_row][p]), stress_at(rows, p), load(rows, p)
            around = stress + isotropic(pressure(stress) - number(rows[pressure_row][p]))
            own, shared = (
                sound_speed(stress, density, state, law_parameters),
                sound_speed(around, density, state, law_parameters),
            )
            stiffness[p - first] = number(0.5) * density * (own * own + shared * shared)

    return find_stiffness
