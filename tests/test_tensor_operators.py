"""The operators of symmetric tensors: componentwise, plain and compiled, and nothing but tensors and numbers."""

import operator

import numpy as np
import pytest
from numba import njit
from numba.core.errors import TypingError

from grainlaw.materials import SymmetricTensor, isotropic, pointwise
from grainlaw.materials.compilation import registered
from grainlaw.materials.precision import as_numbers
from grainlaw.materials.single_precision import in_single

# With the first function that is made callable from compiled code, all of `materials` is.
registered(isotropic)

A = SymmetricTensor(1.0, -2.0, 3.5, 0.25, -0.125, 7.0)
B = SymmetricTensor(0.1, 0.2, -0.3, 0.4, 0.5, -0.6)
CASES = {
    "sum": (lambda a, b: a + b, lambda x, y: x + y),
    "difference": (lambda a, b: a - b, lambda x, y: x - y),
    "negative": (lambda a, b: -b, lambda x, y: -y),
    "number before": (lambda a, b: 0.3 * a, lambda x, y: 0.3 * x),
    "number behind": (lambda a, b: a * 0.3, lambda x, y: x * 0.3),
    "whole number": (lambda a, b: 3 * b, lambda x, y: 3 * y),
    "quotient": (lambda a, b: a / 0.3, lambda x, y: x / 0.3),
}


@pytest.mark.parametrize("case", CASES)
def test_operators_are_componentwise_in_python_and_compiled(case):
    of_tensors, of_numbers = CASES[case]
    wanted = SymmetricTensor(*map(of_numbers, A, B))
    for found in (of_tensors(A, B), njit(of_tensors)(A, B)):
        assert isinstance(found, SymmetricTensor)
        assert found == wanted


def test_a_number_of_numpy_gives_a_tensor():
    assert np.float64(2.0) * A == A * np.float32(2.0) == A + A
    assert isinstance(np.float64(2.0) * A, SymmetricTensor)


@pointwise
def trial_stress(stress, strain):
    """A sum as in a law, with numbers in it."""
    return stress + 2.0 * 0.3 * strain - strain / 3.0


def test_single_precision_stays_single():
    singles = [as_numbers(tensor, np.float32) for tensor in (A, B)]
    function = in_single(trial_stress)
    found = njit(lambda a, b: function(a, b))(*singles)  # noqa: PLW0108
    assert found == pytest.approx(trial_stress(A, B), rel=1e-6)
    kind = njit(lambda a, b: function(a, b).xx * a.xx)
    kind(*singles)
    assert str(kind.nopython_signatures[0].return_type) == "float32"


REFUSED = [
    *[(sign, other) for sign in (operator.add, operator.sub) for other in ((1.0, 2.0), 1.0)],
    *[(sign, other) for sign in (operator.mul, operator.truediv) for other in ((1.0, 2.0), isotropic(1.0))],
]


@pytest.mark.parametrize(("sign", "other"), REFUSED)
def test_anything_else_is_refused_in_python_and_does_not_compile(sign, other):
    with pytest.raises(TypeError, match=r"SymmetricTensor [-+*/] .*: only (a number|another SymmetricTensor) can"):
        sign(A, other)
    with pytest.raises(TypeError):
        sign(other, A)
    for one, another in ((A, other), (other, A)):
        with pytest.raises(TypingError):
            njit(lambda a, b: sign(a, b))(one, another)  # noqa: PLW0108
