"""A law at the points: its state in their rows, its update, its short way for small steps, and its sound speed."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import register_jitable

from materials.compilation import PointwiseLaw, named
from materials.tensor import SymmetricTensor, added, isotropic
from mpm_core.columns import DENSITY, FIRST_STATE, LXX, LXY, LYX, LYY, SXX, SXY, SYY, SZZ, VX, VY


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


def _make_update(law: PointwiseLaw, mark: str) -> Callable[..., Any]:
    law_update, parameter_class = law.update, law.parameters
    load, store = make_state_access(law.state, mark)

    @register_jitable
    @named(mark)
    def update(rows, first, last, ties, parameters, dt):  # type: ignore[no-untyped-def]
        lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
        sxx, syy, szz, sxy, density = rows[SXX], rows[SYY], rows[SZZ], rows[SXY], rows[DENSITY]
        law_parameters = parameter_class(*parameters)
        for p in range(first, last):
            motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
            strain_rate = added(motion, isotropic(ties[p - first] * (-1.0 / (3.0 * dt))))
            stress = SymmetricTensor(sxx[p], syy[p], szz[p], sxy[p], 0.0, 0.0)
            stress, state = law_update(stress, strain_rate, density[p], load(rows, p), law_parameters, dt)
            sxx[p], syy[p], szz[p], sxy[p] = stress.xx, stress.yy, stress.zz, stress.xy
            store(rows, p, state)

    return update


def _make_small_steps(law: PointwiseLaw, small_step: Callable[..., Any], mark: str) -> Callable[..., Any]:
    """Without a branch but for what is stored, so that the compiler takes several points at once."""
    parameter_class = law.parameters
    load, store = make_state_access(law.state, mark)

    @register_jitable
    @named(mark)
    def take_small_steps(rows, first, last, ties, parameters, dt, pending):  # type: ignore[no-untyped-def]
        lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
        sxx, syy, szz, sxy, density = rows[SXX], rows[SYY], rows[SZZ], rows[SXY], rows[DENSITY]
        law_parameters = parameter_class(*parameters)
        for p in range(first, last):
            motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
            strain_rate = added(motion, isotropic(ties[p - first] * (-1.0 / (3.0 * dt))))
            stress = SymmetricTensor(sxx[p], syy[p], szz[p], sxy[p], 0.0, 0.0)
            stress, state, succeeded = small_step(stress, strain_rate, density[p], load(rows, p), law_parameters, dt)
            pending[p - first] = not succeeded
            if succeeded:
                sxx[p], syy[p], szz[p], sxy[p] = stress.xx, stress.yy, stress.zz, stress.xy
                store(rows, p, state)

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
        sxx, syy, szz, sxy, density = rows[SXX], rows[SYY], rows[SZZ], rows[SXY], rows[DENSITY]
        law_parameters = parameter_class(*parameters)
        fastest = np.int64(0)
        for p in range(first, last):
            stress = SymmetricTensor(sxx[p], syy[p], szz[p], sxy[p], 0.0, 0.0)
            sound = sound_speed(stress, density[p], load(rows, p), law_parameters)
            not_finite = 0.0 * (sxx[p] + syy[p] + szz[p] + sxy[p])
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
        sxx, syy, szz, sxy, density = rows[SXX], rows[SYY], rows[SZZ], rows[SXY], rows[DENSITY]
        law_parameters = parameter_class(*parameters)
        for p in range(first, last):
            stress = SymmetricTensor(sxx[p], syy[p], szz[p], sxy[p], 0.0, 0.0)
            sound = sound_speed(stress, density[p], load(rows, p), law_parameters)
            stiffness[p - first] = density[p] * sound * sound

    return find_stiffness
