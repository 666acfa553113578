"""A law at the points: its state in their rows, its update, its short way for small steps, and its sound speed."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import register_jitable

from materials.compilation import PointwiseLaw, named
from materials.tensor import SymmetricTensor, added, isotropic
from mpm_core.columns import DENSITY, FIRST_STATE, LXX, LXY, LYX, LYY, SXX, SXY, SYY, SZZ, VX, VY
from mpm_core.side_by_side import side_by_side


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


def make_state_access(state_class: type[Any], mark: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that load a law's state of one point from its rows, and store it."""
    zeros = (0.0,) * len(state_class._fields)
    load_values, store_values = _load_none, _store_none
    for k in range(len(zeros)):
        load_values, store_values = _with_variable(k, load_values, store_values, mark)

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
    k: int, load_others: Callable[..., Any], store_others: Callable[..., Any], mark: str
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Access to one state variable more. Its row is fixed when the functions are made, as the compiler wants it."""
    row = FIRST_STATE + k

    @register_jitable
    @named(f"{mark}_{k}")
    def load(rows, p, values):  # type: ignore[no-untyped-def]
        return replaced(load_others(rows, p, values), k, rows[row][p])

    @register_jitable
    @named(f"{mark}_{k}")
    def store(rows, p, state):  # type: ignore[no-untyped-def]
        store_others(rows, p, state)
        rows[row][p] = state[k]

    return load, store


def make_apply_law(law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The loop over points that calls a law; `ties` are compressive strains besides those of the motion."""
    if law.small_step is None:
        return _make_update(law, mark)
    update, take_small_steps = _make_update(law, mark), _make_small_steps(law, law.small_step, mark)

    @register_jitable
    @named(mark)
    def apply_law(rows, first, last, ties, parameters, dt):  # type: ignore[no-untyped-def]
        pending = np.empty(last - first, np.int64)
        take_small_steps(rows, first, last, ties, parameters, dt, pending)
        for p in range(first, last):
            if pending[p - first]:
                update(rows, p, p + np.uint64(1), ties[p - first :], parameters, dt)

    return apply_law


@register_jitable(forceinline=True)
def _stress_at(rows, p):  # type: ignore[no-untyped-def]
    return SymmetricTensor(rows[SXX][p], rows[SYY][p], rows[SZZ][p], rows[SXY][p], 0.0, 0.0)


@register_jitable(forceinline=True)
def _put_stress(rows, p, stress):  # type: ignore[no-untyped-def]
    rows[SXX][p], rows[SYY][p], rows[SZZ][p], rows[SXY][p] = stress.xx, stress.yy, stress.zz, stress.xy


@register_jitable(forceinline=True)
def _strain_rate_at(rows, p, tie, dt):  # type: ignore[no-untyped-def]
    """That of the motion, less a compressive strain [1] over the step."""
    shear = 0.5 * (rows[LXY][p] + rows[LYX][p])
    motion = SymmetricTensor(rows[LXX][p], rows[LYY][p], 0.0, shear, 0.0, 0.0)
    return added(motion, isotropic(tie * (-1.0 / (3.0 * dt))))


def _make_update(law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    law_update, parameter_class = law.update, law.parameters
    load, store = make_state_access(law.state, mark)

    @register_jitable(forceinline=True)
    @named(mark)
    def update_one(p, rows, first, ties, law_parameters, dt):  # type: ignore[no-untyped-def]
        stress, strain_rate = _stress_at(rows, p), _strain_rate_at(rows, p, ties[p - first], dt)
        stress, state = law_update(stress, strain_rate, rows[DENSITY][p], load(rows, p), law_parameters, dt)
        _put_stress(rows, p, stress)
        store(rows, p, state)

    @register_jitable
    @named(mark)
    def update(rows, first, last, ties, parameters, dt):  # type: ignore[no-untyped-def]
        side_by_side(first, last, update_one, (rows, first, ties, parameter_class(*parameters), dt))

    return update


def _make_small_steps(law: PointwiseLaw, small_step: Callable[..., Any], mark: str) -> Callable[..., Any]:
    """Without a branch but for what is stored, so that the compiler takes several points at once."""
    parameter_class = law.parameters
    load, store = make_state_access(law.state, mark)

    @register_jitable(forceinline=True)
    @named(mark)
    def take_one(p, rows, first, ties, law_parameters, dt, pending):  # type: ignore[no-untyped-def]
        stress, strain_rate = _stress_at(rows, p), _strain_rate_at(rows, p, ties[p - first], dt)
        state, density = load(rows, p), rows[DENSITY][p]
        stress, state, succeeded = small_step(stress, strain_rate, density, state, law_parameters, dt)
        pending[p - first] = not succeeded
        if succeeded:
            _put_stress(rows, p, stress)
            store(rows, p, state)

    @register_jitable
    @named(mark)
    def take_small_steps(rows, first, last, ties, parameters, dt, pending):  # type: ignore[no-untyped-def]
        side_by_side(first, last, take_one, (rows, first, ties, parameter_class(*parameters), dt, pending))

    return take_small_steps


def make_largest_signal_speed(law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The largest sum of sound speed and speed of some points [m/s], as ordered bits; NaN if anything is not finite.

    Of single points: with largest sound speed and largest speed of a group apart, the step would depend on the order of
    the points, and a turned scene would not turn out the same.
    """
    sound_speed, parameter_class = law.sound_speed, law.parameters
    load, _ = make_state_access(law.state, mark)

    @register_jitable
    @named(mark)
    def largest_signal_speed(rows, first, last, parameters):  # type: ignore[no-untyped-def]
        vx, vy = rows[VX], rows[VY]
        density, law_parameters = rows[DENSITY], parameter_class(*parameters)
        fastest = np.int64(0)
        for p in range(first, last):
            stress = _stress_at(rows, p)
            sound = sound_speed(stress, density[p], load(rows, p), law_parameters)
            not_finite = 0.0 * (stress.xx + stress.yy + stress.zz + stress.xy)
            speed = np.sqrt(vx[p] * vx[p] + vy[p] * vy[p])
            fastest = max(fastest, ordered_bits(speed + sound + not_finite))
        return fastest

    return largest_signal_speed


def make_find_stiffness(law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    """The stiffness rho c^2 of some points [Pa]."""
    sound_speed, parameter_class = law.sound_speed, law.parameters
    load, _ = make_state_access(law.state, mark)

    @register_jitable
    @named(mark)
    def find_stiffness(rows, first, last, parameters, stiffness):  # type: ignore[no-untyped-def]
        density, law_parameters = rows[DENSITY], parameter_class(*parameters)
        for p in range(first, last):
            sound = sound_speed(_stress_at(rows, p), density[p], load(rows, p), law_parameters)
            stiffness[p - first] = density[p] * sound * sound

    return find_stiffness
