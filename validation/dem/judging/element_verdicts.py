"""How far fitted laws are from the element tests of the grains, test by test, whatever each was fitted to.

Start of shear of a dense packing: the peak of the friction, the strain at which it is reached, the friction after it
and the dilation; triaxial compression the same. Everything else: root mean squares over the rows, of compression and
steady shear relative row by row, of shear at changing rates relative to that of the grains.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, SimulationError, get_material
from grainlaw.materials.calibration.data import DataSet, read_data
from grainlaw.materials.calibration.model import ForwardModel, answer
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.fitting_data import CRITICAL_FLOW_FILE, CYCLE_FILE, FLOW_FILE, PEAK_FILE
from grainlaw.validation.dem.judging.history_data import (
    LOOSE_FILE,
    MEDIUM_FILE,
    PRESSURE_FILE,
    RATE_DROP_FILE,
    RATE_JUMP_FILE,
    REVERSAL_FILE,
    SLOWING_FILE,
    TRIAXIAL_FILE,
)
from grainlaw.validation.grains.distance import Distance

Array = NDArray[np.float64]
Answers = dict[str, Array]

# The packings of grains scatter by 2 to 8 % in friction at the start of shear, by 5 to 12 % in dilation.
PEAK_BAND, SOFTENING_BAND, DILATION_BAND, COMPRESSION_BAND, STEADY_BAND = 0.05, 0.07, 0.10, 0.07, 0.03
# Between its values in flow and at rest the solid fraction changes by a tenth; packings differ by half a percent.
FRACTION_BAND = 0.015
# The grains tell the strain of their peak to half of it.
PEAK_STRAIN_BAND = 0.5
# Strains after the peak of the grains.
AFTER_PEAK = (0.025, 0.105)
# Steps of the law between the strains of the data, among which it has a peak of its own.
FINER = 5
# Axial strains after the peak of triaxial compression.
AFTER_TRIAXIAL_PEAK = (0.05, 0.16)
FRICTION, FRACTION, PRESSURE = "friction_of_mean_pressure", "solid_fraction", "pressure"
RATIO, VOLUME = "stress_ratio", "volumetric_strain"


@dataclass(frozen=True)
class Followed:
    """A quantity along an element test: of the grains and of the law at values of the driven column, (rows,) each."""

    test: str
    control: str
    quantity: str
    abscissa: Array
    grains: Array
    of_law: Array


@dataclass(frozen=True)
class ElementVerdict:
    """A law in the element tests of the grains: what each test measures, or why it could not be followed."""

    title: str
    distances: tuple[Distance, ...]
    failures: tuple[str, ...]
    curves: tuple[Followed, ...]


def element_verdict(law: FittedLaw, folder: Path) -> ElementVerdict:
    """A fitted law in the tests whose data lie in a folder; a test without data is left out."""
    distances: list[Distance] = []
    curves: list[Followed] = []
    failures = []
    for name, measured in MEASURED.items():
        if not (folder / name).is_file():
            continue
        try:
            distances += measured(law, folder / name)
            curves += _curves(law, folder / name, DRAWN[name]) if name in DRAWN else []
        except (InputError, SimulationError) as error:
            failures.append(str(error))
    return ElementVerdict(law.judged.title, tuple(distances), tuple(failures), tuple(curves))


def _answers(law: FittedLaw, data: DataSet, abscissa: Array) -> Answers:
    """The law's values at values of the driven column, by name of the measured quantity."""
    model = ForwardModel(get_material(law.judged.law), (data,))
    result = model.history(data, law.parameters, abscissa)
    return {measured.name: answer(result, measured) for measured in data.measured}


def _data(law: FittedLaw, path: Path) -> list[DataSet]:
    return read_data(path, get_material(law.judged.law))


def _curves(law: FittedLaw, path: Path, test: str) -> list[Followed]:
    (data,) = _data(law, path)
    of_law = _answers(law, data, data.abscissa)
    curves = []
    for found in data.measured:
        known = np.isfinite(found.values)
        columns = (values[known] for values in (data.abscissa, found.values, of_law[found.name]))
        curves.append(Followed(test, data.control, found.name, *columns))
    return curves


def _start_of_shear(law: FittedLaw, path: Path) -> list[Distance]:
    (data,) = _data(law, path)
    grains = {measured.name: measured.values for measured in data.measured}
    strains = data.abscissa
    edges = itertools.pairwise([0.0, *strains.tolist()])
    finer = np.concatenate([np.linspace(start, end, FINER + 1)[1:] for start, end in edges])
    whole = _answers(law, data, finer)
    of_law = {name: values[FINER - 1 :: FINER] for name, values in whole.items()}
    peak, peak_of_grains = int(np.argmax(whole[FRICTION])), int(np.argmax(grains[FRICTION]))
    after = (strains > AFTER_PEAK[0]) & (strains < AFTER_PEAK[1])
    dense = data.statements["density"] / data.statements["grain_density"]
    return [
        _relative("peak friction", "1", whole[FRICTION][peak], grains[FRICTION][peak_of_grains], PEAK_BAND),
        _relative("strain of the peak", "1", finer[peak], strains[peak_of_grains], PEAK_STRAIN_BAND),
        _furthest("friction after the peak", of_law[FRICTION][after], grains[FRICTION][after]),
        _relative(
            "dilation", "1", np.log(dense / of_law[FRACTION][-1]), np.log(dense / grains[FRACTION][-1]), DILATION_BAND
        ),
    ]


def _triaxial(law: FittedLaw, path: Path) -> list[Distance]:
    (data,) = _data(law, path)
    grains = {measured.name: measured.values for measured in data.measured}
    of_law = _answers(law, data, data.abscissa)
    after = (data.abscissa > AFTER_TRIAXIAL_PEAK[0]) & (data.abscissa < AFTER_TRIAXIAL_PEAK[1])
    return [
        _relative("triaxial peak", "1", of_law[RATIO].max(), grains[RATIO].max(), PEAK_BAND),
        _furthest("triaxial q/p after the peak", of_law[RATIO][after], grains[RATIO][after]),
        _relative("triaxial dilation", "1", of_law[VOLUME][-1], grains[VOLUME][-1], DILATION_BAND),
    ]


def _followed(law: FittedLaw, path: Path, name: str) -> list[Distance]:
    """Friction and solid fraction along a history of shear, wherever they were measured."""
    (data,) = _data(law, path)
    of_law = _answers(law, data, data.abscissa)
    distances = []
    for measured, what, band in zip(
        data.measured, ("friction", "packing"), (SOFTENING_BAND, FRACTION_BAND), strict=True
    ):
        known = np.isfinite(measured.values)
        scale = float(np.sqrt(np.mean(measured.values[known] ** 2)))
        errors = (of_law[measured.name][known] - measured.values[known]) / scale
        distances.append(_scatter(f"{name}: {what}", (errors**2).tolist(), band))
    return distances


def _compression(law: FittedLaw, path: Path) -> list[Distance]:
    squares: list[float] = []
    for data in _data(law, path):
        (measured,) = data.measured
        error = _answers(law, data, data.abscissa)[PRESSURE] / measured.values - 1.0
        squares += (error[np.isfinite(error)] ** 2).tolist()
    return [_scatter("compression", squares, COMPRESSION_BAND)]


def _steady_shear(law: FittedLaw, path: Path, name: str = "steady") -> list[Distance]:
    """Over all rates, or pressures; the solid fraction of a law that was fitted to one."""
    own = next((name for name in law.judged.data if name in (FLOW_FILE, CRITICAL_FLOW_FILE)), "")
    squares: dict[str, list[float]] = {FRICTION: [], FRACTION: []} if own else {FRICTION: []}
    for data in _data(law, path.with_name(own) if own and path.name == FLOW_FILE else path):
        of_law = _answers(law, data, data.abscissa)
        for found in data.measured:
            if found.name in squares:
                squares[found.name] += ((of_law[found.name] / found.values - 1.0) ** 2).tolist()
    said = {FRICTION: f"{name} friction", FRACTION: f"{name} solid fraction"}
    return [_scatter(said[quantity], found, STEADY_BAND) for quantity, found in squares.items()]


def _furthest(name: str, of_law: Array, grains: Array) -> Distance:
    """Where the law is farthest from the grains, relative to them."""
    row = int(np.argmax(np.abs(of_law / grains - 1.0)))
    return _relative(name, "1", of_law[row], grains[row], SOFTENING_BAND)


def _relative(name: str, unit: str, measured: float, reference: float, band: float) -> Distance:
    return Distance(name, name, unit, float(measured), float(reference), float(measured / reference - 1.0), band)


def _scatter(name: str, squares: list[float], band: float) -> Distance:
    """The root mean square of relative errors."""
    size = float(np.sqrt(np.mean(squares)))
    return Distance(name, name, "1", size, 0.0, size, band)


MEASURED: dict[str, Callable[[FittedLaw, Path], list[Distance]]] = {
    PEAK_FILE: _start_of_shear,
    CYCLE_FILE: _compression,
    FLOW_FILE: _steady_shear,
    PRESSURE_FILE: partial(_steady_shear, name="other pressures: steady"),
    MEDIUM_FILE: partial(_followed, name="from medium"),
    LOOSE_FILE: partial(_followed, name="from loose"),
    RATE_DROP_FILE: partial(_followed, name="rate drop"),
    RATE_JUMP_FILE: partial(_followed, name="rate jump"),
    SLOWING_FILE: partial(_followed, name="fast flow slowed"),
    REVERSAL_FILE: partial(_followed, name="reversal"),
    TRIAXIAL_FILE: _triaxial,
}
# Tests that are drawn, with their titles.
DRAWN = {
    PEAK_FILE: "from dense",
    MEDIUM_FILE: "from medium",
    LOOSE_FILE: "from loose",
    TRIAXIAL_FILE: "triaxial compression",
    RATE_DROP_FILE: "rate drop",
    SLOWING_FILE: "fast flow slowed",
    REVERSAL_FILE: "reversal",
}
