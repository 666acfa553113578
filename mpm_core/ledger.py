"""Where the energy of a run is, and where it went; and what mass left with it."""

import math
from dataclasses import dataclass

from grainlaw.mpm_core.carried import Carried


@dataclass
class Ledger:
    """Energies [J and the space's amount]: potential energy relative to the start, works since the start.

    Velocities belong to the middles of steps, and so do kinetic energy, potential energy and internal work: half of the
    last step's rise and work is still to come. A balance of energies at different times would be wrong by the work of
    half a step.

    The work of the stress is counted at two places. `internal_work` is that on the strains of points, which is what a
    law stores or dissipates; `work_on_nodes` that of internal forces and gravity on the velocities of the nodes, which
    is what moves, in the middle of the last step. They differ where transfers smooth strains.

    `volume_projection` is the part of the potential energy that points gained by being moved apart. `wall_friction` is
    the part of `wall_work` that sliding dissipates, `obstacle_friction` that of `obstacle_work`. The initial elastic
    energy is NaN where a law does not state its energy.

    `outflow` is the energy of motion and of height, over the lower corner of the domain, that points took with them
    through open sides, `outflow_height` that of height alone, `outflow_elastic` the elastic energy that they took,
    `mass_left` [kg and the amount] their mass; `inflow`, `inflow_height`, `inflow_elastic` and `mass_in` are the same
    of what entered through mouths. Potential energy is that of the points still there, less that of all at the start.
    """

    kinetic: float
    initial_kinetic: float
    initial_elastic: float
    potential: float = 0.0
    internal_work: float = 0.0
    wall_work: float = 0.0
    wall_friction: float = 0.0
    obstacle_work: float = 0.0
    obstacle_friction: float = 0.0
    outflow: float = 0.0
    outflow_height: float = 0.0
    outflow_elastic: float = 0.0
    mass_left: float = 0.0
    inflow: float = 0.0
    inflow_height: float = 0.0
    inflow_elastic: float = 0.0
    mass_in: float = 0.0
    volume_projection: float = 0.0
    work_on_nodes: float = 0.0
    rise_to_come: float = 0.0
    work_to_come: float = 0.0

    def count(self, kinetic: float, risen: float, worked: float) -> None:
        """Take in a step: the new kinetic energy, the rise of the potential energy and the work of the stress."""
        self.kinetic = kinetic
        self.potential += self.rise_to_come + 0.5 * risen
        self.internal_work += self.work_to_come + 0.5 * worked
        self.rise_to_come, self.work_to_come = 0.5 * risen, 0.5 * worked

    def count_projection(self, raised: float) -> None:
        """Take in what the points rose by being moved apart [as energies]."""
        self.potential += raised
        self.volume_projection += raised

    def count_outflow(self, left: Carried) -> None:
        """Take in what points took with them that left after the last step."""
        self._count_points(left, -1.0)
        self.outflow += left.kinetic + left.potential_in_the_middle
        self.outflow_height += left.potential_in_the_middle
        self.outflow_elastic += left.elastic
        self.mass_left += left.mass

    def count_inflow(self, came: Carried) -> None:
        """Take in what points brought that entered after the last step, as if they had flown in it as they do now."""
        self._count_points(came, 1.0)
        self.inflow += came.kinetic + came.potential_in_the_middle
        self.inflow_height += came.potential_in_the_middle
        self.inflow_elastic += came.elastic
        self.mass_in += came.mass

    def _count_points(self, points: Carried, more: float) -> None:
        self.kinetic += more * points.kinetic
        self.potential += more * points.potential_in_the_middle
        self.rise_to_come += more * 0.5 * points.risen

    @property
    def numerical_dissipation(self) -> float:
        """What is left of the balance: energy that transfers and time integration took (or gave, if negative).

        By the work at the points. Where a stress that follows strain rates dissipates more there than on the nodes, it
        is negative without any motion from nowhere: `made` tells.
        """
        given = self.initial_kinetic + self.volume_projection + self.inflow
        taken = self.internal_work + self.wall_work + self.obstacle_work + self.outflow
        return given - self.kinetic - self.potential - taken

    @property
    def internal_work_on_nodes(self) -> float:
        """What internal forces took of the energy of motion of the nodes, up to the middle of the last step."""
        risen = self.potential - self.volume_projection + self.outflow_height - self.inflow_height
        return -self.work_on_nodes - risen

    @property
    def transfer_dissipation(self) -> float:
        """What transfers between points and nodes took of the energy of motion (gave, if negative)."""
        given = self.initial_kinetic + self.inflow - self.inflow_height + self.work_on_nodes
        taken = self.wall_work + self.obstacle_work + self.outflow - self.outflow_height
        return given - self.kinetic - taken

    @property
    def released(self) -> float:
        """What was there to be spent: energy of motion, and of height that was lost, but not carried away."""
        fallen = self.inflow_height - self.outflow_height - self.potential
        return self.initial_kinetic + self.inflow - self.inflow_height + max(0.0, fallen)

    @property
    def kinetic_at_end(self) -> float:
        """Kinetic energy at the end of the step, with what its second half will bring [as energies]."""
        return self.kinetic - self.rise_to_come - self.work_to_come

    def inelastic_work(self, elastic: float) -> float:
        """What of the internal work is not in the elastic energy at the end of the step: plastic and viscous work."""
        return self._not_stored(self.internal_work, elastic)

    def made(self, elastic: float) -> float:
        """Energy from nowhere, with the elastic energy at the end of the step; zero where none was made.

        In two parts, of which neither may make up for the other: what transfers gave to the motion, and what the nodes
        did not pay of the energy that points hold. That is what they store, but no more than they were given: the rest
        is made by a law whose elasticity is not conservative. Where a law does not state its elastic energy (NaN), it
        is what is missing in the balance by the work at the points.
        """
        if math.isnan(elastic):
            return max(0.0, -self.numerical_dissipation)
        given = self.internal_work - self.internal_work_on_nodes
        stored = -self._not_stored(self.internal_work_on_nodes, elastic)
        return max(0.0, -self.transfer_dissipation) + max(0.0, min(given, stored))

    def _not_stored(self, internal_work: float, elastic: float) -> float:
        stored = elastic + self.outflow_elastic - self.initial_elastic - self.inflow_elastic
        return internal_work + self.work_to_come - stored
