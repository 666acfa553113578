"""The final piles of other MPM codes that ship with this library, and what each code did differently."""

import json
from dataclasses import dataclass
from functools import cache
from typing import Any

from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.surface_table import read_surface_table
from grainlaw.validation.reference.reference_set import REFERENCE

PEERS = REFERENCE / "mpm"
PROVENANCE = PEERS / "provenance.json"


@dataclass(frozen=True)
class Peer:
    """One run of another code on the paper's column.

    time       of its pile [s]
    cell_size  of its grid [m]
    area       below its surface [m2]; the column starts with 0.27
    differs    what it did differently from the paper's column here
    """

    name: str
    code: str
    version: str
    law: str
    time: float
    cell_size: float
    area: float
    run: str
    surface: str
    differs: tuple[str, ...]

    @property
    def title(self) -> str:
        """Code and law."""
        return f"{self.code}, {self.law}"

    def observed(self, width: float) -> Observation:
        """Its surface, beside piles that are spread with a kernel of this width [m]."""
        found = read_surface_table(PEERS / f"{self.name}.csv", width)
        found.description["label"] = self.title
        return found


@cache
def peers() -> dict[str, Peer]:
    """All of them by name."""
    told: dict[str, dict[str, Any]] = json.loads(PROVENANCE.read_text(encoding="utf-8"))
    del told["all"]
    return {name: Peer(name, **{**entry, "differs": tuple(entry["differs"])}) for name, entry in told.items()}
