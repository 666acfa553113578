"""Runs beside other codes as rows of text."""

from collections.abc import Sequence

from grainlaw.validation.grains.distance import Distance
from grainlaw.validation.mpm.piles import PileDistance
from grainlaw.validation.report.grain_tables import percent
from grainlaw.validation.report.page import Table

COLUMNS = ("run", "code", "t [s]", "verdict", "E_A", "half width [m]", "theirs", "top [m]", "theirs", "decided by")


def pile_table(found: Sequence[PileDistance], title: str) -> Table:
    """One row for each run and each code."""
    area, *others = found[0].distances
    bands = ", ".join(f"{one.symbol} {percent(one.band or 0.0)}" for one in (area, *others))
    note = (
        "E_A: area between the two surfaces over the mean of the areas below them; half width where the surface is as "
        f"high as the kernel is wide. Indistinguishable: {bands}; acceptable: twice that."
    )
    return Table(title, note, COLUMNS, tuple(_row(one) for one in found))


def _row(found: PileDistance) -> tuple[str, ...]:
    area, half_width, top = found.distances
    return (
        found.run,
        found.code,
        f"{found.time:g}",
        found.verdict,
        percent(area.distance),
        *_lengths(half_width),
        *_lengths(top),
        found.decisive.symbol,
    )


def _lengths(found: Distance) -> tuple[str, str]:
    return f"{found.measured:.3f} ({100.0 * found.distance:+.1f} %)", f"{found.reference:.3f}"
