"""What is measured of a Newtonian flow along walls that starts from rest: its profile at two times."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from grainlaw.validation.case import Convergence, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.scenes import advance, simulation_of

BAND, LEAST_ORDER = 2e-2, 1.8
Profiles = dict[str, tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class ViscousFlow:
    """A flow along an axis, between the ends of the other axis.

    scene        its scene from the number of cells across and the viscosity [Pa s]
    exact        the velocity [m/s] at coordinates across [m] and a time [s]
    times        when the profile is measured [s], by name
    across       the axis across the flow; the other one is along it
    width        of the flow: coordinates across go from 0 to it [m]
    fastest      the coordinate of the largest velocity [m]
    place        what the coordinate across is, and where the flow is, for the figure
    """

    scene: Callable[[int, float], dict[str, Any]]
    exact: Callable[[Any, float], Any]
    times: dict[str, float]
    across: int
    width: float
    fastest: float
    place: tuple[str, str]

    def profiles(self, cells: int, viscosity: float) -> Profiles:
        """Coordinates across [m] and velocities along the flow [m/s] of the points at each of the times."""
        simulation = simulation_of(self.scene(cells, viscosity))
        body, found = simulation.bodies[0], {}
        for name, time in self.times.items():
            advance(simulation, time)
            found[name] = body.positions[self.across].copy(), body.velocity[1 - self.across].copy()
        return found

    def error(self, name: str, profile: tuple[np.ndarray, np.ndarray]) -> float:
        """Largest error of the points' velocity over the largest velocity at that time."""
        coordinate, velocity = profile
        largest = float(self.exact(self.fastest, self.times[name]))
        return float(np.abs(velocity - self.exact(coordinate, self.times[name])).max()) / largest

    def measurements(self, found: Profiles) -> tuple[Measurement, ...]:
        """The profile at both times."""
        return tuple(
            upper_bound(
                f"t = {self.times[name]:g} s: largest error of the profile", "1", self.error(name, profile), BAND
            )
            for name, profile in found.items()
        )

    def evidence(self, results: dict[int, Profiles]) -> Evidence:
        """The profiles on the finest grid, and the order over grids by their number of cells."""
        finest = results[max(results)]
        return Evidence(self.measurements(finest), self._convergence(results), (self._figure(finest),))

    def _convergence(self, results: dict[int, Profiles]) -> tuple[Convergence, ...]:
        sizes = tuple(self.width / cells for cells in results)
        if len(sizes) < 2:
            return ()
        return tuple(
            Convergence(
                f"profile at {time:g} s",
                "cell size",
                sizes,
                tuple(self.error(name, found[name]) for found in results.values()),
                LEAST_ORDER,
            )
            for name, time in self.times.items()
        )

    def _figure(self, finest: Profiles) -> Figure:
        everywhere, curves = np.linspace(0.0, self.width, 60), []
        for name, (coordinate, velocity) in finest.items():
            time, order = self.times[name], np.argsort(coordinate)[:: max(1, len(coordinate) // 40)]
            curves.append(curve(f"exact, {time:g} s", self.exact(everywhere, time), everywhere, "reference"))
            curves.append(curve(f"measured, {time:g} s", velocity[order], coordinate[order]))
        coordinate_name, where = self.place
        return Figure(f"Velocity {where}", "velocity [m/s]", f"{coordinate_name} [m]", tuple(curves))
