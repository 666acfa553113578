"""A simulation that a script leads from time to time and looks into."""

from typing import TYPE_CHECKING

from grainlaw.face.scenes import SceneSource, as_scene
from grainlaw.mpm_core import simulation
from grainlaw.mpm_core.output.fields import make_frame
from grainlaw.mpm_core.output.frame import Frame

if TYPE_CHECKING:
    from pyvista import PolyData


class Simulation(simulation.Simulation):
    """Bodies, grid and walls of a scene, and the clock; nothing is written.

    The scene is tables, the path of a TOML file, the name of a shipped scene, or a scene as it is. What a program may
    set besides it: `body_force`, which acts besides gravity, and `held_nodes`, where the material is held.
    Raises InputError for a scene that cannot be built and for a law that does not compile.
    """

    def __init__(self, scene: SceneSource, threads: int = 1) -> None:
        super().__init__(as_scene(scene), threads)

    def __repr__(self) -> str:
        points = sum(body.count for body in self.bodies)
        laws = ", ".join(dict.fromkeys(body.law.name for body in self.bodies))
        return f"Simulation({self.scene.source!r}): t = {self.time:g} s, step {self.steps}, {points} points of {laws}"

    def frame(self) -> Frame:
        """The present points with the scene's fields, in the order in which they were generated."""
        return make_frame(self.time, self.steps, self.bodies, self.fields)

    def to_pyvista(self) -> "PolyData":
        """The same as points of pyvista, with a point array for each field."""
        from grainlaw.face.point_cloud import point_cloud

        return point_cloud(self.frame())
