"""Reading TOML files, with or without a byte-order mark."""

import tomllib
from pathlib import Path
from typing import Any

from grainlaw.materials.errors import InputError


def read_toml(path: Path, what: str) -> dict[str, Any]:
    """The tables of a file; `what` it is stands in messages. Raises InputError if it cannot be read."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{what} {path} cannot be read: {error}") from error
