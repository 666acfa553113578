"""The scene argument and the values set on top of it, shared by the commands that take a scene."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.options import assigned

if TYPE_CHECKING:
    from grainlaw.mpm_core.scene.model import Scene

SceneFile = Annotated[
    Path,
    typer.Argument(
        metavar="SCENE",
        help="Scene file, or the name of a scene of `grainlaw scenes`; a file that exists is taken first.",
        show_default=False,
    ),
]
SetValues = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="PATH=VALUE", help="Set a value of the scene, such as grid.cell_size=0.0125; repeatable."
    ),
]


def load_scene(path: Path, set_values: list[str] | None) -> "Scene":
    """The validated scene with the set values on top. Raises InputError."""
    from grainlaw.mpm_core.scene.file import value_of_text
    from grainlaw.mpm_core.scene.model import Scene
    from grainlaw.mpm_core.scene.shipped import scene_file

    values = {key: value_of_text(text) for key, text in assigned(set_values).items()}
    # A shipped scene is called by its name in messages, not by its place in the installation.
    return Scene.load(scene_file(path), values, str(path))
