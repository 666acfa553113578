"""Coupling the volumes of points with one another and with the volume of the cells that they fill.

Each point integrates its own volume from its own velocity gradient. In a flow these integrals drift: the pressures of
the points of one cell scatter by as much as they amount to, some points open for good, and points crowd without their
densities knowing. No force on the grid shows any of it. What is loose grains therefore takes on, while it shears,

    eps = s (<p> - p)/E                       pressure smoothing: a compressive strain for a point with stress,
    eps = s ln(<rho>/rho) >= 0                closing: for a point without stress,
    eps += OVERFILL_COMPRESSION gamma_dot dt <e>    for both, where points crowd (or are sparse inside the material),
    u = -SHIFTING gamma_dot sum w_i e_i (x_i - x_p)     particle shifting: a velocity down the gradient of overfill, if
                                              the scene says so,

    s = x/(1 + x),  x = SMOOTHING dt/tau gamma_dot/(gamma_dot + QUIET_RATE),  E = rho c^2 (p + <p>)/(2 p),

in every fourth step, dt being the time of four.

<.> is gathered from the nodes: the averages of p and of the density, weighted with volume, and the overfill

    e_i = V_i/(h^2 f_i) - 1, zero where the volume fraction V_i/(h^2 f_i) of the node is below NEARLY_FULL,

of the volume V_i that points bring to a node over the part f_i of its cell that lies in the domain. Nodes at a free
surface are less than full, which is no error. E stands for the stiffness at the mean of both pressures, where stiffness
grows with pressure, and keeps a point of little pressure from leaping.

The law sees the strain like any other. It changes no more than the share of volume that pressures stand for; crowded
points are compressed, and the momentum equation answers with a flow that moves them apart. Nothing happens at rest, and
nothing to material that carries tension, where stress belongs to the single point.
"""

from numba.extending import register_jitable

from grainlaw.materials.single_precision import adaptable

# The shear rate [1/s] below which material counts as at rest.
QUIET_RATE = 0.1

# The rate of pressure smoothing and of closing over that of the FLIP blend time.
SMOOTHING = 2.0

# The share of overfill that a unit of shear strain takes away, and the rate of shifting over that of shear.
OVERFILL_COMPRESSION = 0.4
SHIFTING = 12.0
# Volumes are coupled in one step of so many, for the time of all of them: they drift apart over hundreds of steps.
STEPS_PER_COUPLING = 4

# The volume fraction above which a node is taken to lie inside the material.
NEARLY_FULL = 0.9

# The largest strain by which one step smooths pressures.
LARGEST_SMOOTHING = 0.1


@register_jitable
def overfill_of(volume, node_volume):  # type: ignore[no-untyped-def]
    """The overfill e of a node from the volume that points brought and its own in the domain [m2]."""
    fraction = volume / node_volume
    return fraction - 1.0 if fraction > NEARLY_FULL else 0.0


@adaptable
def smoothing_share(shear_rate, exchange):  # type: ignore[no-untyped-def]
    """The share s of a difference that goes in a step; `exchange` is dt over the FLIP blend time."""
    share = SMOOTHING * exchange * shear_rate
    return share / (shear_rate + QUIET_RATE + share)


@adaptable
def smoothing_strain(pressure, mean_pressure, stiffness, share):  # type: ignore[no-untyped-def]
    """The compressive strain of a step towards the mean pressure; `stiffness` is rho c^2 [Pa] of the point."""
    if stiffness <= 0.0 or pressure <= 0.0 or mean_pressure <= 0.0:
        return 0.0
    strain = share * (mean_pressure - pressure) * 2.0 * pressure / ((pressure + mean_pressure) * stiffness)
    return min(max(strain, -LARGEST_SMOOTHING), LARGEST_SMOOTHING)


@adaptable
def closing_strain(density, mean_density, share):  # type: ignore[no-untyped-def]
    """The compressive strain of a step towards the density around, bounded by 2 for points that are far apart."""
    return share * 2.0 * max(0.0, mean_density - density) / (mean_density + density)


@register_jitable
def shifting_rate(shear_rate, dt):  # type: ignore[no-untyped-def]
    """The rate of a shifting step, but less than one per step [1/s]: no point then leaps past its neighbours."""
    rate = STEPS_PER_COUPLING * SHIFTING * shear_rate
    return rate / (1.0 + rate * dt)
