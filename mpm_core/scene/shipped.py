"""The scenes that come with grainlaw, by name."""

from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.materials.errors import nearest_name

# Of the package, or of the checkout that the package's folder links to.
FOLDER = Path(__file__).resolve().parents[2] / "scenes"


def shipped_scenes() -> dict[str, Path]:
    """The files of the shipped scenes by name."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}


def scene_file(source: str | Path) -> Path:
    """The file of a scene, given by its path or, where there is no such file, by the name of a shipped one.

    Raises InputError, with the nearest name, where it is neither.
    """
    path, shipped = Path(source), shipped_scenes()
    if path.exists():
        return path
    if str(source) in shipped:
        return shipped[str(source)]
    hint = nearest_name(path.stem, shipped)
    raise InputError(f"{path}: No such file, and no scene of that name comes with grainlaw; {hint}")
