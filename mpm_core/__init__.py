"""The Material Point Method: points, grid, transfer, boundary, step, scene, output."""

if __name__ == "mpm_core":
    raise ImportError("import grainlaw.mpm_core, not mpm_core")

from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.stepping.run import run

__all__ = ["Scene", "Simulation", "run"]
