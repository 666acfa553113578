"""Small scenes for the tests of the core, and the command line called from within the tests."""

import contextlib
import copy
import io
import sys
from typing import NamedTuple
from unittest import mock

import numpy as np
import pytest
import tomli_w

from grainlaw.materials import registry
from grainlaw.mpm_core import Scene, Simulation
from grainlaw.mpm_core.grid.grid import COMPONENTS

ELASTIC = {"bulk_modulus": 1e4, "poisson_ratio": 0.2}
MU_I_LC = {
    "static_friction": 0.69,
    "dynamic_friction": 1.25,
    "inertial_number_constant": 0.279,
    "bulk_modulus": 2e4,
    "poisson_ratio": 0.2,
    "grain_density": 2450.0,
    "grain_diameter": 0.005,
}
CAM_CLAY = {
    "critical_state_ratio": 1.2,
    "compression_index": 0.04,
    "swelling_index": 0.008,
    "poisson_ratio": 0.2,
    "overconsolidation_ratio": 1.0,
    "grain_density": 2450.0,
}

# An elastic block of 4 x 4 cells in the middle of a box of 10 x 8 cells, without gravity.
BLOCK = {
    "title": "block",
    "gravity": [0.0, 0.0],
    "grid": {"cell_size": 0.1, "upper": [1.0, 0.8]},
    "time": {"end": 0.1},
    "material": {"linear_elastic": ELASTIC},
    "body": [
        {
            "material": "linear_elastic",
            "shape": {"kind": "rectangle", "lower": [0.3, 0.2], "upper": [0.7, 0.6]},
            "density": 1000.0,
        }
    ],
}

# An elastic cube of 4 x 4 x 4 cells on the floor of a box, under its weight.
CUBE = {
    "title": "cube",
    "space": "3d",
    "grid": {"cell_size": 0.1, "upper": [1.0, 0.8, 0.6]},
    "time": {"end": 0.1},
    "material": {"linear_elastic": ELASTIC},
    "body": [
        {
            "material": "linear_elastic",
            "shape": {"kind": "box", "lower": [0.3, 0.2, 0.0], "upper": [0.7, 0.6, 0.4]},
            "density": 1000.0,
        }
    ],
}

# An elastic cylinder around the axis.
RING = {
    "title": "ring",
    "space": "axisymmetric",
    "grid": {"cell_size": 0.1, "upper": [1.0, 0.8]},
    "time": {"end": 0.1},
    "material": {"linear_elastic": ELASTIC},
    "body": [
        {
            "material": "linear_elastic",
            "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.5, 0.4]},
            "density": 1000.0,
        }
    ],
}

# A column of mu(I)-LC, 12 cells wide and 32 high, that falls apart quickly.
COLUMN = {
    "title": "column",
    "gravity": [0.0, -9.8],
    "grid": {"cell_size": 0.025, "upper": [3.2, 1.0]},
    "time": {"end": 0.3},
    "boundary": {"bottom": {"kind": "friction", "coefficient": 0.5}},
    "material": {"mu_i_lc": MU_I_LC},
    "body": [
        {
            "material": "mu_i_lc",
            "shape": {"kind": "rectangle", "lower": [1.45, 0.0], "upper": [1.75, 0.8]},
            "density": 1500.0,
            "initial_stress": {"kind": "geostatic"},
        }
    ],
    "output": {"interval": 0.05, "pictures": False},
}


def changed(content, changes):
    """A copy of nested dictionaries with values by dotted key; the value None removes the key."""
    content = copy.deepcopy(content)
    for key, value in changes.items():
        *parents, last = key.split(".")
        table = content
        for name in parents:
            table = table[int(name)] if isinstance(table, list) else table.setdefault(name, {})
        if value is None:
            del table[last]
        else:
            table[last] = copy.deepcopy(value)
    return content


def simulation(content, changes=None, threads=1):
    """The simulation of a scene given as dictionaries, with changes by dotted key."""
    return Simulation(Scene.from_dict(changed(content, changes or {})), threads)


def write_scene(path, content, changes=None):
    """Write a scene as TOML; return its path."""
    path.write_text(tomli_w.dumps(changed(content, changes or {})))
    return path


def set_affine_velocity(body, velocity, gradient):
    """Give all points the velocity v + L x and the gradient L."""
    gradient = np.asarray(gradient)
    body.velocity = np.reshape(velocity, (-1, 1)) + gradient @ body.positions
    body.velocity_gradient = body.affine = gradient[:, :, None]


def node_mass_and_momentum(simulation):
    """Mass [kg/m] of each node and momentum [kg/s] that the points brought, shapes of the grid, the axes before it."""
    grid = simulation.grid
    nodes = np.moveaxis(grid.nodes.reshape(*grid.shape, COMPONENTS), -1, 0)
    mass, old = nodes[grid.components.mass], grid.components.force
    return mass, np.where(mass > 0.0, mass * nodes[old : old + grid.space.axes], 0.0)


def momentum(simulation):
    """Momentum of all points [kg/s], shape (2,)."""
    return sum(body.point_mass * body.velocity.sum(axis=1) for body in simulation.bodies)


def call_command_line(monkeypatch, *arguments):
    """Run the command `grainlaw` in this process; return its exit code."""
    from grainlaw.cli.main import main

    monkeypatch.setattr(sys, "argv", ["grainlaw", *map(str, arguments)])
    with pytest.raises(SystemExit) as exit_:
        main()
    return exit_.value.code or 0


class Finished(NamedTuple):
    """What a command left: its exit code, and what it printed."""

    returncode: int
    stdout: str
    stderr: str


def grainlaw(*arguments):
    """Run the command `grainlaw` in this process, which saves the start of another; its plugins are forgotten."""
    from grainlaw.cli.main import main

    known = registry()
    laws, refusals = dict(known.laws), list(known.refusals)
    out, err = io.StringIO(), io.StringIO()
    with (
        mock.patch.object(sys, "argv", ["grainlaw", *map(str, arguments)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as exit_,
    ):
        main()
    known.laws, known.refusals = laws, refusals
    return Finished(exit_.value.code or 0, out.getvalue(), err.getvalue())


PLUGIN = '''
"""A spring law for one test, changed in one place at a time."""

import math
from typing import Annotated, NamedTuple

from grainlaw.materials import Law, Parameter, SymmetricTensor, hookimpl, trace


class Parameters(NamedTuple):
    stiffness: Annotated[float, Parameter({unit}, "stiffness E", "(0, inf)")]


class State(NamedTuple):
    pass


def initial_state(stress, density, parameters):
    return State()


def update(stress, strain_rate, density, state, parameters, dt):
    new = stress + parameters.stiffness * dt * strain_rate
    {update}
    return new, state


def sound_speed(stress, density, state, parameters):
    {sound_speed}
    return math.sqrt(parameters.stiffness / density)


@hookimpl
def grainlaw_materials():
    {hook}
    return [Law("{name}", "a spring", Parameters, State, initial_state, update, sound_speed)]
'''
SOUND_PLUGIN = {"unit": '"Pa"', "update": "pass", "sound_speed": "pass", "hook": "pass", "name": "spring"}


def write_plugin(path, **changes):
    """Write a plugin of one law, `spring`, with parts replaced; return its path."""
    path.write_text(PLUGIN.format(**SOUND_PLUGIN | changes))
    return path


# A block of the plugin's law that falls on the floor of a box.
FALLING_SPRING = changed(
    BLOCK,
    {
        "gravity": [0.0, -9.81],
        "time.end": 0.5,
        "material": {"spring": {"stiffness": 2e4}},
        "body.0.material": "spring",
        "body.0.shape.lower": [0.3, 0.1],
        "body.0.shape.upper": [0.7, 0.5],
        "output": {"fields": ["velocity"], "pictures": False, "interval": 0.05},
    },
)


@pytest.fixture
def fresh_registry():
    """The registry as it is, restored after a test that loads plugins into it."""
    known = registry()
    laws, refusals = dict(known.laws), list(known.refusals)
    yield known
    known.laws, known.refusals = laws, refusals
