"""The obstacles of a run for ParaView: their outlines at the times of frames, listed in `obstacles.pvd`.

One that moves has a file for each frame, `obstacle_NAME_NNNNNN.vtp`; one that does not has a single one, listed at each
time at which it is there.
"""

from pathlib import Path

from grainlaw.mpm_core.obstacles.outline import outline_of
from grainlaw.mpm_core.output.frame_series import FrameFile, read_collection, write_collection
from grainlaw.mpm_core.output.vtp import ObstacleFrame, read_vtp, write_vtp
from grainlaw.mpm_core.simulation import Simulation

OBSTACLES_NAME = "obstacles.pvd"


class ObstacleSeries:
    """Writes the outlines of the obstacles of one run into its folder."""

    def __init__(self, folder: Path, simulation: Simulation) -> None:
        """Continue the series that the folder holds, or start an empty one."""
        self.folder = folder
        self.simulation = simulation
        self.files = list(read_collection(folder, OBSTACLES_NAME)) if (folder / OBSTACLES_NAME).exists() else []

    def write(self, frame: int) -> None:
        """Write the obstacles that are there now, at frame number `frame`."""
        time, grid = self.simulation.time, self.simulation.grid
        for obstacle in self.simulation.obstacles.present:
            if not obstacle.is_there(time):
                continue
            number = f"_{frame:06d}" if obstacle.motion.moves else ""
            path = self.folder / f"obstacle_{obstacle.name}{number}.vtp"
            if obstacle.motion.moves or not path.exists():
                write_vtp(path, ObstacleFrame(time, obstacle.hollow, outline_of(obstacle, grid.lower, grid.upper)))
            self.files.append(FrameFile(time, path))
        write_collection(self.folder / OBSTACLES_NAME, self.files)

    def drop_after(self, time: float) -> None:
        """Forget and remove what is later than `time` [s], that of the checkpoint from which the run resumes."""
        if not self.files:
            return
        self.files = [file for file in self.files if file.time <= time]
        write_collection(self.folder / OBSTACLES_NAME, self.files)
        kept = {file.path for file in self.files}
        for path in self.folder.glob("obstacle_*.vtp"):
            if path not in kept:
                path.unlink()


def obstacles_at(folder: Path, time: float) -> list[ObstacleFrame]:
    """The obstacles of a run's folder at the time of a frame [s]; none in a run without.

    Raises InputError for files that are missing or cannot be read.
    """
    if not (folder / OBSTACLES_NAME).exists():
        return []
    return [read_vtp(file.path) for file in read_collection(folder, OBSTACLES_NAME) if file.time == time]
