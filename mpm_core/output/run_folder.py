"""A run's folder opened for reading, finished or still running."""

import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.frame_series import FrameFile, read_collection
from grainlaw.mpm_core.output.history import read_history
from grainlaw.mpm_core.output.quantities import read_field_documentation
from grainlaw.mpm_core.output.summary import RunSummary, read_summary
from grainlaw.mpm_core.output.vtu import read_vtu
from grainlaw.mpm_core.space import PLANE_STRAIN, SPACES, Space

SCENE_NAME = "scene.toml"
# Columns of the history that every picture of a run needs.
DRAWN = ("t", "runout", "height", "center_of_mass_height")


@dataclass(frozen=True)
class RunFolder:
    """What a run left in `path`; each part is read when it is first asked for.

    Raises InputError if `path` is not a folder, and on access if the part is missing or broken.
    """

    path: Path

    def __post_init__(self) -> None:
        if not self.path.is_dir():
            raise InputError(f"run folder {self.path} does not exist")

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The tables of the scene that was run; empty where it is missing."""
        path = self.path / SCENE_NAME
        if not path.is_file():
            return {}
        try:
            return tomllib.loads(path.read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{path} cannot be read: {error}") from error

    @property
    def space(self) -> Space:
        """The space of the scene that was run."""
        return SPACES.get(str(self.scene.get("space")), PLANE_STRAIN)

    @cached_property
    def frame_files(self) -> tuple[FrameFile, ...]:
        """Time and path of each frame; at least one."""
        files = read_collection(self.path)
        if not files:
            raise InputError(f"{self.path} holds no frame yet")
        return files

    @cached_property
    def frame_times(self) -> NDArray[np.float64]:
        """Times [s] of the frames, shape (frames,)."""
        return np.array([file.time for file in self.frame_files])

    @cached_property
    def first_with_points(self) -> int:
        """The number of the first frame that holds points, before which nothing had entered; 0 where none does."""
        filled = (index for index in range(len(self.frame_files)) if len(self.load_frame(index).positions) > 0)
        return next(filled, 0)

    @cached_property
    def history(self) -> NDArray[Any]:
        """The history as a structured array of shape (rows,); at least one row."""
        history = read_history(self.path)
        if not len(history):
            raise InputError(f"the history of {self.path} holds no row yet")
        for name in DRAWN:
            if name not in (history.dtype.names or ()):
                raise InputError(f"the history of {self.path} has no column '{name}'")
        return history

    @cached_property
    def summary(self) -> RunSummary:
        """The summary of a finished run."""
        return read_summary(self.path)

    def load_frame(self, index: int) -> Frame:
        """Frame number `index`; negative numbers count from the last frame.

        Raises InputError if there is no such frame or its file is missing or broken.
        """
        count = len(self.frame_files)
        if not -count <= index < count:
            raise InputError(f"no frame {index} in {self.path}: allowed are 0 to {count - 1}")
        return read_vtu(self.frame_files[index].path, read_field_documentation(self.path))
