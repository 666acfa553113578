"""The tests whose data can be fitted: what their first column may be, and the law's answer at its values.

The element tests with a driven strain follow the strains of the data from row to row, so that unloading is a matter of
the data. `steady-shear` holds the normal stress on the plane of shear and shears at each inertial number until nothing
changes any more, as a plane shear cell does; `shear-start` follows the strains of the data at one inertial number;
`shear-history` follows strains over time, so that the rate, too, is a matter of the data.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, Parameter, SimulationError, inertial_number
from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.driver import follow_path
from grainlaw.materials.element.path import LoadingPath
from grainlaw.materials.element.point import Point, point_at_rest
from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.element.run import initial_point
from grainlaw.materials.element.settings import (
    GrainDensity,
    GrainDiameter,
    InitialDensity,
    InitialPressure,
    StrainedSettings,
    StrainRate,
)
from grainlaw.materials.element.shear import SHEAR
from grainlaw.materials.element.specimen import Specimen
from grainlaw.materials.errors import nearest_name
from grainlaw.materials.tensor import SymmetricTensor, isotropic

Array = NDArray[np.float64]

NORMAL = SymmetricTensor(0.0, -1.0, 0.0, 0.0, 0.0, 0.0)
# Of tau/(normal stress), over the second half of the strain at one inertial number.
STEADY = 1e-4
# Of a number of steps.
ROUND_OFF = 1e-6

HeldNormalStress = Annotated[float, Parameter("Pa", "held compressive stress on the plane of shear", "(0, inf)")]
StrainStep = Annotated[float, Parameter("1", "largest strain of the driven component in one step", "(0, inf)")]


class StrainedDataSettings(NamedTuple):
    """Settings of a test whose driven strain follows the data."""

    initial_pressure: InitialPressure = 100e3
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0
    strain_rate: StrainRate = 0.01
    strain_step: StrainStep = 1e-3


class SteadyShearSettings(NamedTuple):
    """Settings of steady shear at held normal stress."""

    held_normal_stress: HeldNormalStress = 1e3
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0
    grain_diameter: GrainDiameter = 0.005
    strain_to_steady: Annotated[
        float, Parameter("1", "strain eps_xy at each inertial number, to become steady", "(0, inf)")
    ] = 10.0
    strain_step: StrainStep = 5e-3


class ShearStartSettings(NamedTuple):
    """Settings of the start of shear at held normal stress."""

    held_normal_stress: HeldNormalStress = 1e3
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0
    grain_diameter: GrainDiameter = 0.005
    held_inertial_number: Annotated[
        float, Parameter("1", "I of the shear, with gamma_dot = sqrt(1/2 D_d:D_d)", "(0, inf)")
    ] = 0.01
    strain_step: StrainStep = 2e-4


class ShearHistorySettings(NamedTuple):
    """Settings of shear at held normal stress, with the strain of the data over time."""

    held_normal_stress: HeldNormalStress = 1e3
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0
    strain_step: StrainStep = 5e-4


AnyShearSettings = SteadyShearSettings | ShearStartSettings | ShearHistorySettings


@dataclass(frozen=True)
class Control:
    """A column that drives a test: SI unit, one-line doc, and the driven quantity of the law that belongs to it."""

    unit: str
    doc: str
    driven: Callable[[Array], Array]


@dataclass(frozen=True)
class Experiment:
    """A test whose data can be fitted.

    controls  the columns that may drive it, by name; a data file has one of them
    settings  NamedTuple class whose fields are annotated with `Parameter`, all with defaults
    history   (specimen, settings, driven values of shape (rows,)) -> the start and the point at each value
    follows   if the control is time, the columns of which a data file has one more, by name: what is driven over time;
              the history is then given times and values, shape (rows, 2)
    """

    name: str
    summary: str
    controls: Mapping[str, Control]
    settings: type[Any]
    history: Callable[[Specimen, Any, Array], ElementResult]
    follows: Mapping[str, Control] = field(default_factory=dict)


def _as_it_is(values: Array) -> Array:
    return values


LOGARITHMIC = "axial strain -ln(l/l0), compression-positive"
AXIAL = {
    "axial_strain": Control("1", LOGARITHMIC, _as_it_is),
    "nominal_axial_strain": Control(
        "1", "axial strain 1 - l/l0, compression-positive", lambda strain: -np.log1p(-strain)
    ),
}
VOLUMETRIC = {"volumetric_strain": Control("1", "volumetric strain -ln(V/V0), compression-positive", _as_it_is)}
SHEARED = {
    "engineering_shear_strain": Control("1", "gamma = 2 eps_xy", lambda strain: 0.5 * strain),
    "shear_strain": Control("1", "tensor component eps_xy", _as_it_is),
}
TIMED = {"time": Control("s", "time since the start, rising from row to row", _as_it_is)}
# The same halving as `own_inertial_number_constant`: gamma_dot is half of the engineering rate.
NUMBERED = {
    "engineering_inertial_number": Control(
        "1",
        "I with the engineering rate dv_x/dy and p the normal stress on the plane of shear",
        lambda number: 0.5 * number,
    ),
    "inertial_number": Control(
        "1", "I with gamma_dot = sqrt(1/2 D_d:D_d) and p the normal stress on the plane of shear", _as_it_is
    ),
}


def _strained(name: str, controls: Mapping[str, Control]) -> Experiment:
    test = get_element_test(name)

    def history(specimen: Specimen, settings: StrainedDataSettings, strains: Array) -> ElementResult:
        changes = np.diff(strains, prepend=0.0)
        substeps = max(1, math.ceil(float(np.max(np.abs(changes))) / settings.strain_step))
        dt = max(float(np.max(np.abs(changes))), 1e-300) / substeps / settings.strain_rate
        common = {
            name: getattr(settings, name) for name in ("initial_pressure", "density", "grain_density", "strain_rate")
        }
        of_test = StrainedSettings(**common, final_strain=dt * settings.strain_rate, time_step=dt)
        of_one_step = test.path(of_test)
        assert isinstance(of_one_step, LoadingPath)
        path = replace(of_one_step, rates=np.repeat(changes / (substeps * dt), substeps))
        start = initial_point(specimen, of_test)
        points = (start, *follow_path(specimen, path, start, substeps))
        return ElementResult(specimen, test.name, of_test, path.steps, points)

    return Experiment(test.name, test.summary, controls, StrainedDataSettings, history)


def steady_shear(specimen: Specimen, settings: SteadyShearSettings, numbers: Array) -> ElementResult:
    """The steady state at each inertial number, one after the other. Raises SimulationError where it is not steady."""
    start, unit_number = _pressed(specimen, settings), _number_of_unit_rate(settings)
    half = math.ceil(0.5 * settings.strain_to_steady / settings.strain_step)
    points = [start]
    for number in numbers:
        rate = float(number) / unit_number
        path = _at_normal_stress(settings, 0.5 * settings.strain_to_steady / half / rate, np.full(2 * half, rate))
        halfway, end = follow_path(specimen, path, points[-1], half)
        _check_steady(specimen, settings, halfway, end, float(number))
        points.append(end)
    return ElementResult(specimen, "steady-shear", settings, 2 * half * len(numbers), points)


def shear_start(specimen: Specimen, settings: ShearStartSettings, strains: Array) -> ElementResult:
    """The point at each strain, sheared from an isotropic state at one inertial number."""
    rate = settings.held_inertial_number / _number_of_unit_rate(settings)
    changes = np.diff(strains, prepend=0.0)
    return _sheared(specimen, settings, "shear-start", np.abs(changes) / rate, changes)


def shear_history(specimen: Specimen, settings: ShearHistorySettings, driven: Array) -> ElementResult:
    """The point at each time, sheared from an isotropic state along strains over time, (rows, 2)."""
    durations, changes = np.diff(driven, axis=0, prepend=np.zeros((1, 2))).T
    return _sheared(specimen, settings, "shear-history", durations, changes)


def _sheared(
    specimen: Specimen,
    settings: ShearStartSettings | ShearHistorySettings,
    test: str,
    durations: Array,
    changes: Array,
) -> ElementResult:
    """Shear at held normal stress from an isotropic state by changes of strain, each within its own duration [s]."""
    points, steps = [_pressed(specimen, settings)], 0
    for duration, change in zip(durations.tolist(), changes.tolist(), strict=True):
        if duration == 0.0:
            points.append(points[-1])
            continue
        count = max(1, math.ceil(abs(change) / settings.strain_step - ROUND_OFF))
        path = _at_normal_stress(settings, duration / count, np.full(count, change / duration))
        points += follow_path(specimen, path, points[-1], count)
        steps += count
    times = np.concatenate([[0.0], np.cumsum(durations)]).tolist()
    points = [point._replace(time=time) for point, time in zip(points, times, strict=True)]
    return ElementResult(specimen, test, settings, steps, tuple(points))


def _pressed(specimen: Specimen, settings: AnyShearSettings) -> Point:
    """The isotropic point at the held normal stress."""
    stress = isotropic(-settings.held_normal_stress)
    density = specimen.density(settings.held_normal_stress, settings.density)
    return point_at_rest(stress, density, specimen.law.initial_state(stress, density, specimen.parameters))


def _number_of_unit_rate(settings: SteadyShearSettings | ShearStartSettings) -> float:
    """The inertial number of the unit rate at the held normal stress."""
    return inertial_number(1.0, settings.held_normal_stress, settings.grain_diameter, settings.grain_density)


def _at_normal_stress(settings: AnyShearSettings, dt: float, rates: Array) -> LoadingPath:
    return LoadingPath(
        dt=dt,
        rates=rates,
        direction=SHEAR,
        free=NORMAL,
        held=NORMAL,
        target=settings.held_normal_stress,
        held_name="normal stress",
    )


def _check_steady(specimen: Specimen, settings: SteadyShearSettings, halfway: Point, end: Point, number: float) -> None:
    change = abs(end.stress.xy - halfway.stress.xy) / settings.held_normal_stress
    if not change <= STEADY:
        raise SimulationError(
            f"{specimen.law.name}: shear at I = {number:g} is not steady after eps_xy = {settings.strain_to_steady:g} "
            f"(the friction still changes by {change:.2g}); state a larger strain_to_steady in the data file"
        )


EXPERIMENTS = {
    found.name: found
    for found in (
        _strained("triaxial-drained", AXIAL),
        _strained("triaxial-undrained", AXIAL),
        _strained("biaxial", AXIAL),
        _strained("oedometer", AXIAL),
        _strained("isotropic", VOLUMETRIC),
        _strained("simple-shear", SHEARED),
        Experiment("steady-shear", "steady shear at held normal stress", NUMBERED, SteadyShearSettings, steady_shear),
        Experiment(
            "shear-start",
            "the start of shear at held normal stress and inertial number",
            SHEARED,
            ShearStartSettings,
            shear_start,
        ),
        Experiment(
            "shear-history",
            "shear at held normal stress, with strains over time",
            TIMED,
            ShearHistorySettings,
            shear_history,
            SHEARED,
        ),
    )
}


def get_experiment(name: str) -> Experiment:
    """The experiment of that name. Raises InputError with the nearest valid name."""
    if name not in EXPERIMENTS:
        raise InputError(f"unknown test '{name}'; {nearest_name(name, EXPERIMENTS)}")
    return EXPERIMENTS[name]
