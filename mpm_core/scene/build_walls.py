"""The sides of a scene's domain as a run has them: walls, open sides and periodic ones."""

from grainlaw.mpm_core.kernels.walls import Wall, WallKind
from grainlaw.mpm_core.scene.model import Scene


def build_walls(scene: Scene) -> list[Wall]:
    """The walls of a scene, axis by axis, the lower side first."""
    walls = []
    for axis, sides in enumerate(scene.in_space.sides):
        for side in sides:
            section = scene.boundary.of(side)
            if section.kind not in ("periodic", "open"):
                kind, is_lower = WallKind[section.kind.upper()], side == sides[0]
                walls.append(Wall(axis, is_lower, kind, section.coefficient, scene.wall_velocity(side)))
    return walls


def open_sides(scene: Scene) -> list[tuple[bool, bool]]:
    """Along each axis, whether its lower and its upper side are open."""
    kinds = ([scene.boundary.kind_of(side) for side in pair] for pair in scene.in_space.sides)
    return [(below == "open", above == "open") for below, above in kinds]


def periodic_axes(scene: Scene) -> list[int]:
    """The axes whose two sides are joined."""
    kinds = (scene.boundary.of(lower).kind for lower, _ in scene.in_space.sides)
    return [axis for axis, kind in enumerate(kinds) if kind == "periodic"]
