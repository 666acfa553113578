"""What a run of a periodic cell leaves: its cost and its reduced table."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Reduced:
    """Steps made, mobile grains, and the name of the CSV file with the reduced data."""

    steps: int
    grains: int
    table: str
