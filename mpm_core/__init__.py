"""The Material Point Method: points, grid, transfer, boundary, step, scene, output."""

from mpm_core.run import run
from mpm_core.scene import Scene
from mpm_core.simulation import Simulation

__all__ = ["Scene", "Simulation", "run"]
