"""A law that one number stretches, for tests of what compiled code is kept under; and processes that run it."""

import os
import subprocess
import sys
from pathlib import Path

LAW = '''
"""Stress = factor E D dt, with a factor that a test writes in the way that it is about."""

from typing import Annotated, NamedTuple

from grainlaw.materials import Law, Parameter, ParameterSet, SymmetricTensor, hookimpl, pointwise
{above}

class Parameters(NamedTuple):
    stiffness: Annotated[float, Parameter("Pa", "stiffness E", "(0, inf)")]


class State(NamedTuple):
    pass


def initial_state(stress, density, parameters):
    return State()


def update(stress, strain_rate, density, state, parameters, dt):
    return {factor} * parameters.stiffness * dt * strain_rate, state


def sound_speed(stress, density, state, parameters):
    return {factor} * (parameters.stiffness / density) ** 0.5


@hookimpl
def grainlaw_materials():
    sets = {{"one": ParameterSet(Parameters(1e6), "made up", lambda pressure, parameters: 1000.0)}}
    return [Law("{name}", "stretched", Parameters, State, initial_state, update, sound_speed, sets)]
'''

# One compiled step of the law of each of some files.
COMPILED_STEP = """
import sys
from pathlib import Path
from grainlaw.materials import SymmetricTensor, isotropic
from grainlaw.materials.compilation import make_single_step, pointwise_law
from grainlaw.materials.registry import Registry
for path in map(Path, sys.argv[1:]):
    found = Registry()
    found.load_file(path)
    law = found.get("stretched").law
    values = law.parameter_sets["one"].parameters
    step = make_single_step(pointwise_law(law))
    stress, _ = step(isotropic(0.0), SymmetricTensor(1.0, *5 * (0.0,)), 1000.0, law.state(), values, 1e-6)
    print(stress.xx)
"""


def write_law(path: Path, above: str, factor: str, name: str = "stretched") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(LAW.format(above=above, factor=factor, name=name))
    return path


def write_constant(folder: Path, value: str) -> None:
    """The module `constants`; values of different length, lest Python's own cache take an edit for none."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "constants.py").write_text(
        f"from grainlaw.materials import pointwise\n\nC = {value}\n\n\n@pointwise\ndef factor():\n    return C\n"
    )


def command(*arguments, **environment) -> subprocess.CompletedProcess[str]:
    """Python in a process of its own; `environment` replaces variables, and removes those that are None."""
    variables = {**os.environ, **{name: value and str(value) for name, value in environment.items()}}
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={name: value for name, value in variables.items() if value is not None},
        capture_output=True,
        text=True,
        check=False,
    )


def printed(*arguments, **environment) -> str:
    done = command(*arguments, **environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
