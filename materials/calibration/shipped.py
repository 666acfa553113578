"""The element-test data that come with grainlaw, by name."""

from pathlib import Path

FOLDER = Path(__file__).parent / "data"


def data_file(source: Path) -> Path:
    """A file as it is or, where there is none, that of the shipped data of this name."""
    shipped = {path.stem: path for path in FOLDER.glob("*.csv")}
    return source if source.exists() else shipped.get(str(source), source)
