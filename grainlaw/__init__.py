"""Constitutive laws for granular matter, an MPM core that runs any of them, and the evidence for each.

    import grainlaw as gl

    gl.laws()                                                    the laws
    gl.law("mu_i_lc").element_test("simple-shear").plot()        one point of a law
    gl.run("collapse_mu_i_lc", "runs/column")                    a scene into a run's folder
    gl.read_run("runs/column").history["runout"]                 what it left there
    gl.Simulation("two_discs").advance_to(0.1)                   a scene step by step
    gl.sweep("two_discs", "runs/s", {"time.end": "1:3:3"})       a scene for each of several values

Each name is imported when it is first asked for, so that `import grainlaw` costs nothing and starts nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from grainlaw.face.element_tests import ElementTestResult as ElementTestResult
    from grainlaw.face.laws import ConstitutiveLaw as ConstitutiveLaw
    from grainlaw.face.laws import law as law
    from grainlaw.face.laws import laws as laws
    from grainlaw.face.laws import load_plugin as load_plugin
    from grainlaw.face.runs import Run as Run
    from grainlaw.face.runs import read_run as read_run
    from grainlaw.face.runs import run as run
    from grainlaw.face.scenes import Scene as Scene
    from grainlaw.face.scenes import scenes as scenes
    from grainlaw.face.simulations import Simulation as Simulation
    from grainlaw.materials.errors import InputError as InputError
    from grainlaw.materials.errors import InputWarning as InputWarning
    from grainlaw.materials.errors import SimulationError as SimulationError
    from grainlaw.studies.sweep import Sweep as Sweep
    from grainlaw.studies.sweep import sweep as sweep

    __version__: str

_HOMES = {
    "ConstitutiveLaw": "grainlaw.face.laws",
    "ElementTestResult": "grainlaw.face.element_tests",
    "InputError": "grainlaw.materials.errors",
    "InputWarning": "grainlaw.materials.errors",
    "Run": "grainlaw.face.runs",
    "Scene": "grainlaw.face.scenes",
    "Simulation": "grainlaw.face.simulations",
    "SimulationError": "grainlaw.materials.errors",
    "Sweep": "grainlaw.studies.sweep",
    "law": "grainlaw.face.laws",
    "laws": "grainlaw.face.laws",
    "load_plugin": "grainlaw.face.laws",
    "read_run": "grainlaw.face.runs",
    "run": "grainlaw.face.runs",
    "scenes": "grainlaw.face.scenes",
    "sweep": "grainlaw.studies.sweep",
}
__all__ = [
    "ConstitutiveLaw",
    "ElementTestResult",
    "InputError",
    "InputWarning",
    "Run",
    "Scene",
    "Simulation",
    "SimulationError",
    "Sweep",
    "law",
    "laws",
    "load_plugin",
    "read_run",
    "run",
    "scenes",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("grainlaw")
    if name not in _HOMES:
        raise AttributeError(f"module 'grainlaw' has no attribute '{name}'")
    found = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})
