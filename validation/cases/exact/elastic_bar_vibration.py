"""First longitudinal mode of an elastic bar between smooth walls, held at one end and free at the other."""

import math
from typing import Any

import numpy as np

from grainlaw.materials.rheology import longitudinal_wave_speed, shear_modulus
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.space import PLANE_STRAIN, Space
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.scenes import advance, block, in_order_of_generation, simulation_of

BAND = 5e-3
LENGTH, DENSITY, BULK_MODULUS, POISSON_RATIO = 1.0, 1000.0, 1e5, 0.3
# Strains of 1e-6: linear to round-off of the measurement.
STRAIN = 1e-6
PERIODS = 10
CELLS = {Effort.QUICK: (20, 40), Effort.FULL: (10, 20, 40, 80, 160)}


def wave_speed() -> float:
    """Speed of plane longitudinal waves [m/s]."""
    return longitudinal_wave_speed(BULK_MODULUS, shear_modulus(BULK_MODULUS, POISSON_RATIO), DENSITY)


def exact_frequency() -> float:
    """Of the first mode, whose wave length is four times the bar [1/s]."""
    return wave_speed() / (4.0 * LENGTH)


def axis_of_bar(space: Space) -> int:
    """Along x in plane strain, otherwise along the vertical axis."""
    return 0 if space is PLANE_STRAIN else space.up


def scene(cells: int, poisson_ratio: float, space: Space) -> dict[str, Any]:
    """A bar, `cells` long and 4 cells thick, that fills the domain across and half of it along."""
    size, axis = LENGTH / cells, axis_of_bar(space)
    bar, domain = [4.0 * size] * space.axes, [4.0 * size] * space.axes
    bar[axis], domain[axis] = LENGTH, 2.0 * LENGTH
    return {
        "space": space.name,
        "gravity": [0.0] * space.axes,
        "grid": {"cell_size": size, "upper": domain},
        "time": {"end": PERIODS / exact_frequency()},
        "transfer": {"time_constant": 1e6},
        "material": {"linear_elastic": {"bulk_modulus": BULK_MODULUS, "poisson_ratio": poisson_ratio}},
        "body": [{"material": "linear_elastic", "shape": block([0.0] * space.axes, bar), "density": DENSITY}],
    }


def vibration(
    cells: int, poisson_ratio: float = POISSON_RATIO, space: Space = PLANE_STRAIN
) -> tuple[np.ndarray, np.ndarray]:
    """Amplitude of the first mode's velocity over time, 40 values in a period [s, m/s]."""
    content, axis = scene(cells, poisson_ratio, space), axis_of_bar(space)
    simulation = simulation_of(content)
    body = simulation.bodies[0]
    mode = np.sin(0.5 * math.pi * in_order_of_generation(body, body.positions[axis]) / LENGTH)
    body.velocity[axis] = STRAIN * wave_speed() * np.sin(0.5 * math.pi * body.positions[axis] / LENGTH)
    times, amplitudes = [0.0], [STRAIN * wave_speed()]

    def observe(present: Simulation) -> None:
        times.append(present.time)
        amplitudes.append(2.0 * float(np.mean(mode * in_order_of_generation(body, body.velocity[axis]))))

    advance(simulation, content["time"]["end"], observe, intervals=40 * PERIODS)
    return np.array(times), np.array(amplitudes)


def frequency(times: np.ndarray, amplitudes: np.ndarray) -> float:
    """From the first and the last passage through zero [1/s]."""
    before = np.nonzero(np.sign(amplitudes[:-1]) != np.sign(amplitudes[1:]))[0]
    share = amplitudes[before] / (amplitudes[before] - amplitudes[before + 1])
    passages = times[before] + share * (times[before + 1] - times[before])
    return 0.5 * (len(passages) - 1) / float(passages[-1] - passages[0])


def measured(
    cells: int, poisson_ratio: float = POISSON_RATIO, space: Space = PLANE_STRAIN, label: str = ""
) -> Measurement:
    """The frequency on one grid."""
    found = frequency(*vibration(cells, poisson_ratio, space))
    return relative_error(f"frequency, {cells} cells{label}", "1/s", found, exact_frequency(), BAND)


def measure(effort: Effort) -> Evidence:
    """Grids of several sizes."""
    counts = CELLS[effort]
    found = tuple(measured(cells) for cells in counts)
    sizes, errors = tuple(LENGTH / cells for cells in counts), tuple(m.error for m in found)
    order = Convergence("frequency", "cell size [m]", sizes, errors, least_order=1.8)
    times, amplitudes = vibration(counts[-1])
    exact = STRAIN * wave_speed() * np.cos(2.0 * math.pi * exact_frequency() * times)
    figure = Figure(
        f"Amplitude of the first mode, {counts[-1]} cells",
        "time [s]",
        "velocity [m/s]",
        (curve("exact", times, exact, "reference"), curve("measured", times[::2], amplitudes[::2])),
    )
    kept = float(np.abs(amplitudes[-40:]).max() / amplitudes[0])
    return Evidence(found, (order,), (figure,), (f"after {PERIODS} periods {kept:.4f} of the amplitude is left",))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Another Poisson's ratio at the same bulk modulus, as if the bar were free to expand sideways."""
    return (measured(20, poisson_ratio=0.35),)


CASE = Case(
    name="elastic_bar_vibration",
    title="longitudinal vibration of an elastic bar",
    proves="inertia, stiffness and the place of a free surface: a wave runs at its speed and turns round at the end",
    reference="f = c/(4 L), c = sqrt((K + 4/3 G)/rho)",
    norm="relative error of the frequency over ten periods",
    mistake="nu = 0.35 instead of 0.3",
    measure=measure,
    control=control,
)
