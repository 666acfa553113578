"""The values in a file of parameters, without what a calibration says about them."""

from pathlib import Path
from typing import Any

from grainlaw.materials.toml_file import read_toml

# The table of a file of parameters that holds no parameter (`grainlaw.materials.calibration.parameter_file`).
CALIBRATION = "calibration"


def read_values(path: Path) -> dict[str, Any]:
    """Values by name. Raises InputError if the file cannot be read."""
    values = read_toml(path, "parameter file")
    return {name: value for name, value in values.items() if name != CALIBRATION or not isinstance(value, dict)}
