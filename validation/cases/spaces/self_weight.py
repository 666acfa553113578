"""Columns under their own weight in axisymmetry and three dimensions."""

from grainlaw.mpm_core.space import AXISYMMETRIC, THREE_D
from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.cases.exact.self_weight_column import GRAVITY, measurements, observed

LAWS = {
    Effort.QUICK: ("linear_elastic",),
    Effort.FULL: ("linear_elastic", "mu_i_lc", "modified_cam_clay"),
}
DURATION = {Effort.QUICK: 0.25, Effort.FULL: 2.0}
SPACES = (AXISYMMETRIC, THREE_D)


def measure(effort: Effort) -> Evidence:
    """Columns of 4 cells across and 40 up, around the axis and in a box."""
    found: list[Measurement] = []
    for space in SPACES:
        for law in LAWS[effort]:
            result = observed(law, DURATION[effort], space=space)
            found += measurements(law, result, f", {space.name}")
    return Evidence(tuple(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Columns that weigh 2 % less."""
    results = {space: observed("linear_elastic", 0.1, 0.98 * GRAVITY, space) for space in SPACES}
    return tuple(
        found
        for space, result in results.items()
        for found in measurements("linear_elastic", result, f", {space.name}")
    )


CASE = Case(
    name="self_weight",
    title="column under its own weight in axisymmetry and 3D, 40 cells",
    proves="equilibrium of stress, gravity and walls, at the axis and in a box",
    reference="vertical stress -rho_0 g (H - Z) with the initial height Z of a point; nothing moves",
    norm="largest error over points and times, over rho g H; largest displacement over H",
    mistake="gravity 2 % too small",
    measure=measure,
    control=control,
)
