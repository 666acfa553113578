"""Parameters of the laws from the shear and the compression of the grains; nothing is fitted to a collapse.

What a law is fitted to lies in files for `grainlaw calibrate` (`fitting_data`), so that a fit can be repeated by hand.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from grainlaw.materials.calibration.findings import Estimate, Findings
from grainlaw.materials.calibration.fit import ElementFit, calibrate
from grainlaw.materials.calibration.model import answer

CURVE_POINTS = 12


@dataclass(frozen=True)
class JudgedLaw:
    """How a law is fitted and what limits it on this case.

    data    names of the files with its data
    given   values by name of what no element test tells, or what the grains themselves are; the rest is fitted
    """

    law: str
    title: str
    data: tuple[str, ...]
    given: dict[str, float]
    limits: str


@dataclass(frozen=True)
class FittedLaw:
    """A law with all its parameters, what the fit says, and the command that repeats it.

    curve   friction of the fitted law over the engineering inertial number
    """

    judged: JudgedLaw
    parameters: dict[str, float]
    estimates: tuple[Estimate, ...]
    remarks: tuple[str, ...]
    command: str
    curve: tuple[tuple[float, ...], tuple[float, ...]]


def fitted(judged: JudgedLaw, folder: Path) -> FittedLaw:
    """Fit a law to its data files in a folder. Raises InputError or SimulationError if that cannot be done."""
    paths = [folder / name for name in judged.data if (folder / name).is_file()]
    fit = calibrate(judged.law, paths, fixed=judged.given)
    findings = Findings(fit)
    fixed = "".join(f" --fix {name}={value:g}" for name, value in judged.given.items())
    command = f"grainlaw calibrate {judged.law} {' '.join(path.name for path in paths)}{fixed}"
    return FittedLaw(judged, fit.values, findings.estimates, findings.remarks, command, _curve(fit))


def _curve(fit: ElementFit) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The friction that the law has in steady shear, over the range of the data."""
    shear = next(data for data in fit.model.data if data.experiment.name == "steady-shear")
    numbers = np.geomspace(shear.abscissa.min(), shear.abscissa.max(), CURVE_POINTS)
    friction = answer(fit.model.history(shear, fit.values, numbers), shear.measured[0])
    return tuple(numbers.tolist()), tuple(friction.tolist())
