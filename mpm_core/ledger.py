"""Where the energy of a run is, and where it went; and what mass left with it."""

from dataclasses import dataclass

from grainlaw.mpm_core.open_sides import Departed


@dataclass
class Ledger:
    """Energies [J and the space's amount]: potential energy relative to the start, works since the start.

    Velocities belong to the middles of steps, and so do kinetic energy, potential energy and internal work: half of the
    last step's rise and work is still to come. A balance of energies at different times would be wrong by the work of
    half a step.

    `volume_projection` is the part of the potential energy that points gained by being moved apart. `wall_friction` is
    the part of `wall_work` that sliding dissipates, `obstacle_friction` that of `obstacle_work`. The initial elastic
    energy is NaN where a law does not state its energy.

    `outflow` is the energy of motion and of height, over the lower corner of the domain, that points took with them
    through open sides, `outflow_elastic` the elastic energy that they took, `mass_left` [kg and the amount] their mass.
    Potential energy is that of the points still there, less that of all at the start.
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
    outflow_elastic: float = 0.0
    mass_left: float = 0.0
    volume_projection: float = 0.0
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

    def count_outflow(self, left: Departed) -> None:
        """Take in what points took with them that left after the last step."""
        # Where they were in the middle of the step, where the other energies are counted.
        potential = left.potential - 0.5 * left.risen
        self.kinetic -= left.kinetic
        self.potential -= potential
        self.rise_to_come -= 0.5 * left.risen
        self.outflow += left.kinetic + potential
        self.outflow_elastic += left.elastic
        self.mass_left += left.mass

    @property
    def numerical_dissipation(self) -> float:
        """What is left of the balance: energy that transfers and time integration took (or gave, if negative)."""
        given = self.initial_kinetic + self.volume_projection
        taken = self.internal_work + self.wall_work + self.obstacle_work + self.outflow
        return given - self.kinetic - self.potential - taken

    @property
    def kinetic_at_end(self) -> float:
        """Kinetic energy at the end of the step, with what its second half will bring [as energies]."""
        return self.kinetic - self.rise_to_come - self.work_to_come

    def inelastic_work(self, elastic: float) -> float:
        """What of the internal work is not in the elastic energy at the end of the step: plastic and viscous work."""
        return self.internal_work + self.work_to_come - (elastic + self.outflow_elastic - self.initial_elastic)
