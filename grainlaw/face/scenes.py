"""Scenes for scripts and notebooks: from tables, a file, or the name of one that comes with grainlaw."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from grainlaw.face.display import html_table, text_table
from grainlaw.materials.errors import nearest_name
from grainlaw.mpm_core.scene import model
from grainlaw.mpm_core.scene.file import read_content, with_values
from grainlaw.mpm_core.scene.shipped import scene_file, shipped_scenes

SceneSource = model.Scene | Mapping[str, Any] | str | Path
"""What a scene is made of: tables, the path of a TOML file, the name of a shipped scene, or a scene as it is."""
COLUMNS = ("scene", "laws", "domain [m]", "cell [m]", "points", "end [s]", "title")


class Scene(model.Scene):
    """A scene from nested dictionaries, the path of a TOML file, or the name of one that comes with grainlaw.

    `changes` are values by dotted key set on top: `Scene("collapse_mu_i_lc", {"grid.cell_size": 0.025})`. A file that
    exists is taken before a shipped scene of the same name. The tables may also be given one by one as keywords.
    Raises InputError, in one line with key, value and what is allowed.
    """

    def __init__(
        self, source: SceneSource | None = None, changes: Mapping[str, Any] | None = None, /, **tables: Any
    ) -> None:
        if source is None:
            super().__init__(**tables)
            return
        content, name = scene_content(source, {**(changes or {}), **tables})
        # Checked first, because its errors are one line each.
        model.Scene.from_dict(content, name)
        super().__init__(**content)
        self._source = name


def as_scene(source: SceneSource) -> model.Scene:
    """A scene as it is, or one made of tables, a file or a name. Raises InputError."""
    return source if isinstance(source, model.Scene) else Scene(source)


def scene_content(source: SceneSource, changes: Mapping[str, Any]) -> tuple[dict[str, Any], str]:
    """The tables of a scene with changes on top, and where they came from for messages. Raises InputError."""
    if isinstance(source, model.Scene):
        return with_values(source.model_dump(mode="json", exclude_none=True), changes), source.source
    if isinstance(source, Mapping):
        return with_values(source, changes), "scene"
    path = scene_file(source)
    return read_content(path, changes), str(source)


class ShippedScenes(Mapping[str, Scene]):
    """The scenes that come with grainlaw, by name; shown as a table."""

    def __getitem__(self, name: str) -> Scene:
        files = shipped_scenes()
        if name not in files:
            raise KeyError(f"no scene '{name}'; {nearest_name(name, files)}")
        scene = Scene(files[name])
        scene._source = name
        return scene

    def __iter__(self) -> Iterator[str]:
        return iter(shipped_scenes())

    def __len__(self) -> int:
        return len(shipped_scenes())

    def __repr__(self) -> str:
        return text_table(*self._table())

    def _repr_html_(self) -> str:
        return html_table(*self._table())

    def _table(self) -> tuple[list[str], list[list[str]]]:
        return list(COLUMNS), [described(name, scene) for name, scene in self.items()]


def scenes() -> ShippedScenes:
    """The scenes that come with grainlaw."""
    return ShippedScenes()


def described(name: str, scene: model.Scene) -> list[str]:
    """A row about a scene: what it is made of, and what its cost grows with, the material points and the duration."""
    laws = dict.fromkeys(scene.law(material).name for material in scene.materials)
    size = (high - low for low, high in zip(scene.grid.lower, scene.grid.upper, strict=True))
    return [
        name,
        ", ".join(laws),
        " x ".join(f"{length:g}" for length in size),
        f"{scene.grid.cell_size:g}",
        f"{_points(scene):,}",
        f"{scene.time.end:g}",
        scene.title,
    ]


def _points(scene: model.Scene) -> int:
    """The number of material points at the start."""
    return sum(len(scene.lattice(body)) for body in scene.body)
