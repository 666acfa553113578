"""Every law gives the same bits in plain Python and compiled, and compiles to PTX where that can be tried."""

from importlib.metadata import PackageNotFoundError, version
from types import SimpleNamespace

import numpy as np
import pytest
from numba import typeof, types

from grainlaw.materials import SymmetricTensor, get_material, isotropic, registry
from grainlaw.materials.compilation import make_single_step, pointwise_law

LAWS_AND_SETS = [
    (name, parameter_set) for name, entry in registry().laws.items() for parameter_set in entry.law.parameter_sets
]
TURING = (7, 5)


def random_strain_rates(steps, seed):
    """Strain increments from 1e-6 to 1e-2 per step, in random directions, compression and extension in turn."""
    random = np.random.default_rng(seed)
    sizes = 10.0 ** random.uniform(-6.0, -2.0, steps)
    drift = np.where(np.arange(steps) // 25 % 2 == 0, -0.5, 0.3)[:, None] * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    return (random.standard_normal((steps, 6)) + drift) * sizes[:, None]


def start(name, parameter_set, pressure=1e4):
    law = get_material(name)
    found = law.parameter_sets[parameter_set]
    density = found.density(pressure, found.parameters)
    stress = isotropic(-pressure)
    return law, found.parameters, stress, density, law.initial_state(stress, density, found.parameters)


@pytest.mark.parametrize(("name", "parameter_set"), LAWS_AND_SETS)
@pytest.mark.parametrize("seed", [1, 2])
def test_python_and_compiled_code_agree_bit_for_bit(name, parameter_set, seed):
    law, parameters, stress, density, state = start(name, parameter_set)
    compiled = make_single_step(pointwise_law(law))
    plain_point, compiled_point = (stress, state), (stress, state)
    dt = 1e-2
    for row in random_strain_rates(300, seed):
        strain_rate = SymmetricTensor(*(row / dt).tolist())
        density *= float(np.exp(-dt * (strain_rate.xx + strain_rate.yy + strain_rate.zz)))
        plain_point = law.update(plain_point[0], strain_rate, density, plain_point[1], parameters, dt)
        compiled_point = compiled(compiled_point[0], strain_rate, density, compiled_point[1], parameters, dt)
        assert plain_point == compiled_point
    assert np.all(np.isfinite(plain_point[0]))
    assert plain_point[0] != stress


@pytest.mark.parametrize(("name", "parameter_set"), LAWS_AND_SETS)
def test_law_compiles_to_ptx(name, parameter_set, monkeypatch):
    cuda = cuda_compiler(monkeypatch)
    law, parameters, stress, _, state = start(name, parameter_set)
    pointwise_law(law)
    arguments = (typeof(stress), typeof(stress), types.float64, typeof(state), typeof(parameters), types.float64)
    ptx, _ = cuda.compile_ptx(law.update, arguments, device=True, cc=TURING)
    assert ".target sm_75" in ptx


def cuda_compiler(monkeypatch):
    """numba.cuda, told which device to compile for because none need be present; skips where its tools are missing."""
    try:
        version("numba-cuda")
    except PackageNotFoundError:
        pytest.skip("numba-cuda is not installed (the CUDA target inside numba itself cannot compile these laws)")
    from numba import cuda

    device = SimpleNamespace(compute_capability=TURING)
    monkeypatch.setattr("numba.cuda.dispatcher.get_current_device", lambda: device)
    try:
        cuda.compile_ptx(lambda x: 2.0 * x, (types.float64,), device=True, cc=TURING)
    except Exception as error:
        pytest.skip(f"numba-cuda finds no CUDA toolkit: {type(error).__name__}")
    return cuda
