"""Simple shear at constant pressure (the paper's numerical test) and at constant volume."""

from typing import Annotated, NamedTuple

import numpy as np

from grainlaw.materials.declarations import Parameter
from grainlaw.materials.element.path import LoadingPath, constant_rate, steps_of
from grainlaw.materials.element.settings import (
    ElementTest,
    GrainDensity,
    GrainDiameter,
    InitialDensity,
    InitialPressure,
    StrainedSettings,
    TimeStep,
)
from grainlaw.materials.rheology import inertial_number
from grainlaw.materials.tensor import SymmetricTensor, isotropic

SHEAR = SymmetricTensor(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)


class ConstantPressureShearSettings(NamedTuple):
    """Settings of the paper's test: the inertial number is held, ramped linearly and held again."""

    initial_pressure: InitialPressure = 1000.0
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0
    grain_diameter: GrainDiameter = 0.005
    slow_inertial_number: Annotated[float, Parameter("1", "inertial number I of the first stage", "(0, inf)")] = 0.001
    fast_inertial_number: Annotated[float, Parameter("1", "inertial number I of the last stage", "(0, inf)")] = 0.1
    slow_duration: Annotated[float, Parameter("s", "duration of the first stage", "[0, inf)")] = 2.0
    ramp_duration: Annotated[float, Parameter("s", "duration of the linear ramp", "(0, inf)")] = 2.0
    fast_duration: Annotated[float, Parameter("s", "duration of the last stage", "[0, inf)")] = 2.0
    time_step: TimeStep = 1e-5


def constant_pressure_shear(settings: ConstantPressureShearSettings) -> LoadingPath:
    """D_xy = gamma_dot = I sqrt(p/rho_p)/d_p, with the isotropic rate by which p stays constant."""
    ramp_end = settings.slow_duration + settings.ramp_duration
    steps = steps_of(ramp_end + settings.fast_duration, settings.time_step)
    inertial_numbers = np.interp(
        settings.time_step * np.arange(1, steps + 1),
        [settings.slow_duration, ramp_end],
        [settings.slow_inertial_number, settings.fast_inertial_number],
    )
    unit_rate = inertial_number(1.0, settings.initial_pressure, settings.grain_diameter, settings.grain_density)
    return LoadingPath(
        dt=settings.time_step,
        rates=inertial_numbers / unit_rate,
        direction=SHEAR,
        free=isotropic(-1.0 / 3.0),
        held=isotropic(-1.0 / 3.0),
        target=settings.initial_pressure,
        held_name="pressure",
    )


def simple_shear(settings: StrainedSettings) -> LoadingPath:
    """D_xy alone, at constant volume; the engineering shear strain is twice the driven one."""
    rates = constant_rate(settings.final_strain, settings.strain_rate, settings.time_step)
    return LoadingPath(settings.time_step, rates, SHEAR)


SHEAR_TESTS = (
    ElementTest(
        "constant-pressure-shear",
        "simple shear at held pressure, inertial number 0.001 ramped to 0.1 (the paper's test)",
        ConstantPressureShearSettings,
        constant_pressure_shear,
    ),
    ElementTest("simple-shear", "simple shear at constant volume", StrainedSettings, simple_shear),
)
