"""Two elastic spheres collide in free space: momentum is exact, energy comes back."""

from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.cases.exact.two_discs import collision, evidence, measurements

SCENE = "two_spheres"


def measure(effort: Effort) -> Evidence:
    """The shipped scene."""
    rows = collision({}, SCENE)
    return evidence(measurements("", rows), rows)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A transfer that drops the velocities below the grid's resolution."""
    return measurements("", collision({"transfer.scheme": "apic"}, SCENE))


CASE = Case(
    name="two_spheres",
    title="collision of two elastic spheres in 3D",
    proves="transfers in three dimensions conserve momentum to round-off and take little energy",
    reference="conservation of momentum and energy (R 0.2 m, E 1000 Pa, nu 0.3, rho 1000 kg/m3, v 0.1 m/s each way)",
    norm="change over the momentum of a sphere; missing share of the initial energy",
    mistake="pure APIC, which drops what the grid does not resolve in each step",
    measure=measure,
    control=control,
)
