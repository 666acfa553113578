"""What each data file says by itself: the interval of a parameter from that file alone, the others held.

With the other parameters at their estimates, the information on one of them is the sum of the squares of its column of
the Jacobian. It adds up over the files, so that the file with the shortest interval is the one that tells a parameter.
"""

import math
from dataclasses import dataclass

import numpy as np

from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.model import ForwardModel


@dataclass(frozen=True)
class Told:
    """A file that determines a parameter as long as the others are known, and its 95 % interval."""

    name: str
    file: str
    lower: float
    upper: float


def told_by(findings: Findings, model: ForwardModel) -> tuple[Told, ...]:
    """For each parameter the files that determine it alone, the most telling first; `model` is that of the fit."""
    files = np.repeat(
        [data.file for data in model.data],
        [sum(int(np.isfinite(measured.values).sum()) for measured in data.measured) for data in model.data],
    )
    fit = findings.fit
    noise = 1.0 if fit.knows_errors else math.sqrt(findings.misfit / findings.freedom)
    found = []
    for index, at in enumerate(fit.coordinates):
        half_widths = {}
        for file in dict.fromkeys(files.tolist()):
            information = float(np.sum(fit.jacobian[files == file, index] ** 2))
            if findings.quantile * noise <= findings.reach[index] * math.sqrt(information):
                half_widths[file] = findings.quantile * noise / math.sqrt(information)
        for file in sorted(half_widths, key=half_widths.__getitem__):
            lower, upper = at.interval(float(fit.solution[index]), half_widths[file])
            found.append(Told(at.name, file, lower, upper))
    return tuple(found)
