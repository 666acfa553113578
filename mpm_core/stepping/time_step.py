"""What bounds a step: waves on the grid, stiffness that contact brings, and the strain of a step.

Stability. Stress is updated with the new velocities, so an oscillation at omega is stable while omega dt <= 2. Of all
arrangements of points, none is stiffer than a single one: the Rayleigh quotient of the grid, a sum over points in
numerator and denominator, cannot exceed that of its worst term. The gradient of one point, over the second moment
D = h^2/4 of quadratic splines, gives omega^2 = C/(rho D) with the largest stiffness C = e:d(sigma)/d(eps):e against
the strains e that the space has, so that

    dt <= 2/omega = h/sqrt(C/rho) for quadratic splines.

C exceeds rho c^2, which waves feel: against in-plane dilation it is 2 K + 2/3 G, for a fluid twice rho c^2, and against
dilation in three axes, or around an axis, too, three times. The ratio is taken from the law once. Cubic splines (D =
h^2/3) have room to spare.

Walls and the axis. A point alone next to a wall, or to the axis, is stiffer than that, as hardly any mass goes with it.
Where it is taken to be closest (`shape_functions`), omega^2 reaches 4.7 times the bound next to walls. In the corner of
axis and wall it reaches 5.9 times for a fluid, 6.1 for nu = 0.2 and 6.8 for nu = 0; with a ratio C/(rho c^2) of at
least 1.27 around an axis (nu = 0.12) it stays below 6.25. So it holds at 0.4 of the stable step, the default. In
filled cells, also disordered ones, omega^2 stays below 0.8 of the bound up to walls and axis.

Viscosity. A stress that follows the rate of strain damps an oscillation at a rate lambda = C'/(rho D), with the largest
viscosity C' = e:d(sigma)/d(rate of eps):e, at most twice the viscosity nu rho against plane waves. Such a stress is of
the velocities before the step: stable while (omega dt)^2 + 2 lambda dt <= 4, or dt <= h/S with

    S = 2 nu/h + sqrt((2 nu/h)^2 + C/rho).

Contact. A law whose stiffness comes with pressure has none where the point is open. What it will have when a step has
closed the gap and compressed it by `LARGEST_STRAIN` counts from the start.

Strain. An explicit step takes the velocity gradient of its start for the whole step, which is wrong by half of the
strain of the step. Adaptive steps strain no point by more than `LARGEST_STRAIN` in volume.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.errors import numbers_of
from grainlaw.materials.law import Law
from grainlaw.materials.tensor import SymmetricTensor, contraction, isotropic, scaled, trace
from grainlaw.mpm_core.body import Body, tensor_of
from grainlaw.mpm_core.space import Space

# Of volume, in one adaptive step.
LARGEST_STRAIN = 0.02
# Of stiffness over rho c^2, where material can be next to an axis.
LEAST_RATIO_AROUND_AXIS = 1.27
# The smallest step, over the first one, unless the scene says otherwise.
SMALLEST_SHARE = 1e-4

_PROBE_STRAIN, _PROBE_DURATION = 1e-6, 1e-3
_PLANE_DILATION = SymmetricTensor(math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0, 0.0, 0.0)
_DILATION = isotropic(math.sqrt(1.0 / 3.0))
_SHEAR = SymmetricTensor(math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0, 0.0, 0.0)


def largest_stiffness_ratio(space: Space) -> float:
    """Directions of stretch: no isotropic elasticity, nor viscosity, is stiffer than a fluid, over its rho c^2."""
    return 3.0 if space.hoop else float(space.axes)


class _Probe(NamedTuple):
    """A point of a law: stress [Pa], density [kg/m3], state."""

    stress: SymmetricTensor
    density: float
    state: Any


class SignalBounds(NamedTuple):
    """What a body's waves are to the grid.

    wave_factor      by how much the grid is stiffer than a plane wave, in speed: sqrt(C/(rho c^2))
    contact_speed    sound speed after a point has closed [m/s], 0 where an open point has it too
    viscous_factor   at most by how much the grid damps more than a plane wave is damped
    """

    wave_factor: float
    contact_speed: float
    viscous_factor: float

    def speed(self, reported: float, fastest_point: float, viscous_speed: float) -> float:
        """The signal speed [m/s] that bounds the step.

        From the largest c + |v| and the largest |v| of the points, and their largest nu/h.
        """
        waves = self.wave_factor * max(reported, fastest_point + self.contact_speed)
        diffusion = self.viscous_factor * viscous_speed
        return diffusion + math.hypot(diffusion, waves) if diffusion > 0.0 else waves


def signal_bounds(body: Body) -> SignalBounds:
    """The bounds of a body's law for its bulk density at the start. Raises InputError where its functions fail."""
    with numbers_of(body.law.name):
        return _probed(body.law, body.parameters, body.initial_density, body.space)


def _probed(law: Law, parameters: Any, density: float, space: Space) -> SignalBounds:
    start = _Probe(isotropic(0.0), density, law.initial_state(isotropic(0.0), density, parameters))
    closed = _moved(law, parameters, start, isotropic(-LARGEST_STRAIN / 3.0))
    open_speed, closed_speed = law.sound_speed(*start, parameters), law.sound_speed(*closed, parameters)
    contact_speed = closed_speed if closed_speed > open_speed else 0.0
    modulus = closed.density * closed_speed * closed_speed
    most = largest_stiffness_ratio(space)
    if not modulus > 0.0:
        return SignalBounds(math.sqrt(most), contact_speed, most)
    dilation = _PLANE_DILATION if most == 2.0 else _DILATION
    largest = max(
        _stiffness(law, parameters, closed, scaled(mode, sign)) for mode in (dilation, _SHEAR) for sign in (1.0, -1.0)
    )
    least = LEAST_RATIO_AROUND_AXIS if space.hoop else 1.0
    ratio = min(max(largest / modulus, least), most)
    return SignalBounds(math.sqrt(ratio), contact_speed, most)


def _moved(law: Law, parameters: Any, start: _Probe, strain: SymmetricTensor) -> _Probe:
    density = start.density * math.exp(-trace(strain))
    rate = scaled(strain, 1.0 / _PROBE_DURATION)
    stress, state = law.update(start.stress, rate, density, start.state, parameters, _PROBE_DURATION)
    return _Probe(stress, density, state)


def _stiffness(law: Law, parameters: Any, start: _Probe, direction: SymmetricTensor) -> float:
    """Stiffness against a small strain in a direction of unit norm [Pa]."""
    still = _moved(law, parameters, start, isotropic(0.0)).stress
    end = _moved(law, parameters, start, scaled(direction, _PROBE_STRAIN)).stress
    return (contraction(end, direction) - contraction(still, direction)) / _PROBE_STRAIN


def what_sets_the_step(body: Body, reason: Callable[[Body], NDArray[np.float64]]) -> tuple[int, str]:
    """The point where a reason for small steps is strongest, and what it contributes to the bounds, in words."""
    point = int(np.argmax(reason(body)))
    sound, speed, rate = sound_speeds(body)[point], body.speed[point], strain_rates(body)[point]
    words = f"sound speed {sound:.3g} m/s, speed {speed:.3g} m/s, volumetric strain rate {rate:.3g} 1/s"
    diffusivity = largest_diffusivity(body)
    return point, words + (f", viscosity over density up to {diffusivity:.3g} m2/s" if diffusivity > 0.0 else "")


def strain_rates(body: Body) -> NDArray[np.float64]:
    """Absolute rate of volumetric strain of each point [1/s]."""
    return np.abs(body.volumetric_rate)


def signal_speeds(body: Body) -> NDArray[np.float64]:
    """Sound speed and speed of each point [m/s], in plain Python."""
    speeds: NDArray[np.float64] = sound_speeds(body) + body.speed
    return speeds


def sound_speeds(body: Body) -> NDArray[np.float64]:
    """Sound speed of each point [m/s], in plain Python."""
    rows = np.vstack([body.stress, body.density, body.states])
    found, components = np.empty(body.count), len(body.layout.stress_names)
    for number, point in enumerate(rows.T.tolist()):
        stress, density, state = tensor_of(point[:components]), point[components], point[components + 1 :]
        found[number] = body.law.sound_speed(stress, density, body.law.state(*state), body.parameters)
    return found


def largest_diffusivity(body: Body) -> float:
    """The largest viscosity over density of the points [m2/s], in plain Python; zero for a law without viscosity."""
    law, largest = body.law, 0.0
    if law.viscosity is None or not law.viscosity_bounds_step:
        return largest
    components = len(body.layout.stress_names)
    rows = np.vstack([body.stress, body.strain_rate, body.density, body.states])
    for point in np.unique(rows, axis=1).T.tolist():
        stress, rate = tensor_of(point[:components]), tensor_of(point[components : 2 * components])
        density, *state = point[2 * components :]
        largest = max(largest, law.viscosity(stress, rate, density, law.state(*state), body.parameters) / density)
    return largest
