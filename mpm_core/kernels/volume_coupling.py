"""Coupling the volumes of points: those of one cell are brought to one pressure.

Each point integrates its own volume from its own velocity gradient. In a flow these integrals drift: the pressures of
the points of one cell scatter by as much as they amount to, and some points open for good. No force on the grid shows
any of it. What is loose grains therefore takes on, while it shears, a compressive strain

    eps = s (<p> - p)/E                       pressure smoothing, for a point that carries pressure,
    eps = s ln(<rho>/rho) >= 0                closing, for a point that carries none,

    s = x/(1 + x),  x = SMOOTHING_RATE dt gamma_dot/(gamma_dot + QUIET_RATE),

in every fourth step, dt being the time of four. <.> is gathered from the nodes: the averages of p and of the density,
weighted with volume. E is the mean of the stiffness rho c^2 at p and at <p>: where stiffness grows with pressure, a
point of little pressure does not leap, and where it is the same the strains of a cell add up to nothing.

The law sees the strain like any other. It changes no more than the share of volume that pressures stand for. Nothing
happens at rest, and nothing to material that carries tension, where stress belongs to the single point.
"""

from grainlaw.materials.single_precision import adaptable

# The shear rate [1/s] below which material counts as at rest.
QUIET_RATE = 0.1
# The rate [1/s] at which differences go while the material shears.
SMOOTHING_RATE = 200.0
# Volumes are coupled in one step of so many, for the time of all of them: they drift apart over hundreds of steps.
STEPS_PER_COUPLING = 4

# The largest strain by which one step smooths pressures.
LARGEST_SMOOTHING = 0.1


@adaptable
def smoothing_share(shear_rate, duration):  # type: ignore[no-untyped-def]
    """The share s of a difference that goes in a time [s]."""
    share = SMOOTHING_RATE * duration * shear_rate
    return share / (shear_rate + QUIET_RATE + share)


@adaptable
def smoothing_strain(pressure, mean_pressure, stiffness, share):  # type: ignore[no-untyped-def]
    """The compressive strain of a step towards the mean pressure; `stiffness` is E [Pa]."""
    if stiffness <= 0.0 or mean_pressure <= 0.0:
        return 0.0
    strain = share * (mean_pressure - pressure) / stiffness
    return min(max(strain, -LARGEST_SMOOTHING), LARGEST_SMOOTHING)


@adaptable
def closing_strain(density, mean_density, share):  # type: ignore[no-untyped-def]
    """The compressive strain of a step towards the density around, bounded by 2 for points that are far apart."""
    return share * 2.0 * max(0.0, mean_density - density) / (mean_density + density)
