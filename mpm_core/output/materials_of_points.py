"""Of which material each point of a frame is, so that pictures can tell several apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from grainlaw.mpm_core.output.fields import BODY_FIELD
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.point_image import outline_color
from grainlaw.mpm_core.output.run_folder import RunFolder


@dataclass(frozen=True)
class Materials:
    """The names of the materials of a run, and the number of the material of each of its bodies."""

    names: tuple[str, ...]
    of_bodies: NDArray[np.int64]

    def of_points(self, frame: Frame) -> NDArray[np.int64] | None:
        """The number of the material of each point, shape (points,); None where there is one, or nobody knows."""
        bodies = next((field.values for field in frame.fields if field.name == BODY_FIELD), None)
        if bodies is None or len(self.names) < 2:
            return None
        return self.of_bodies[bodies.astype(np.int64)]

    def among(self, names: tuple[str, ...]) -> "Materials":
        """The same with the numbers that the materials have among `names`."""
        numbers = np.array([names.index(name) for name in self.names], np.int64)
        return Materials(names, numbers[self.of_bodies])

    def legend(self) -> Sequence[Line2D]:
        """A line of each outline with its name; none where there is nothing to tell apart."""
        if len(self.names) < 2:
            return []
        return [Line2D([], [], color=outline_color(number), label=name) for number, name in enumerate(self.names)]


def materials_of(run: RunFolder) -> Materials:
    """The materials of a run by its scene: their names, with the laws where these are called otherwise."""
    of_bodies = [section["material"] for kind in ("body", "inflow") for section in run.scene.get(kind, [])]
    used = list(dict.fromkeys(of_bodies))
    laws = [run.scene["material"][name].get("law", name) for name in used]
    names = tuple(name if name == law else f"{name} ({law})" for name, law in zip(used, laws, strict=True))
    return Materials(names, np.array([used.index(name) for name in of_bodies], np.int64))
