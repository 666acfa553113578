"""The table of a sweep, one row per run: `sweep.csv` for a text editor, `sweep.parquet` for programs."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from grainlaw.materials import atomic
from grainlaw.mpm_core.output.summary import RunSummary, read_summary
from grainlaw.mpm_core.space import Space
from grainlaw.studies.batch import Outcome
from grainlaw.studies.design import Design

CSV_NAME, PARQUET_NAME = "sweep.csv", "sweep.parquet"
FINISHED, FAILED = "finished", "failed"


@dataclass(frozen=True)
class Quantity:
    """A column from the summary of a run: its name, and its unit in a space, where "J" and "kg" are per something."""

    name: str
    unit: str

    def of(self, summary: RunSummary) -> Any:
        """Its value."""
        return getattr(summary.final if self.name in type(summary.final).model_fields else summary, self.name)

    def unit_in(self, space: Space) -> str:
        """Its unit in a space; empty for a pure number."""
        return self.unit + space.amount if self.unit in {"J", "kg"} else self.unit


# What a run led to.
RESULTS = (
    Quantity("runout", "m"),
    Quantity("height", "m"),
    Quantity("center_of_mass_height", "m"),
    Quantity("kinetic_energy", "J"),
    Quantity("mass_left", "kg"),
)
# What it was, and what it cost.
CIRCUMSTANCES = (
    Quantity("simulated_time", "s"),
    Quantity("energy_balance_error", ""),
    Quantity("points", ""),
    Quantity("steps", ""),
    Quantity("wall_time", "s"),
)


def swept(design: Design, outcomes: Sequence[Outcome], space: Space) -> pa.Table:
    """Run, keys varied, verdict, reason, and the summary of each run; nulls where it failed.

    Keys are called as in the scene; the unit of the other columns is in the metadata of their fields.
    """
    summaries = [None if outcome.reason else read_summary(outcome.folder) for outcome in outcomes]
    columns = [("run", "", pa.array([outcome.name for outcome in outcomes]))]
    columns += [(key, "", _values([row[n] for row in design.rows])) for n, key in enumerate(design.keys)]
    columns += [
        ("verdict", "", pa.array([FAILED if outcome.reason else FINISHED for outcome in outcomes])),
        ("reason", "", pa.array([outcome.reason for outcome in outcomes])),
    ]
    for quantity in (*RESULTS, *CIRCUMSTANCES):
        found = [None if summary is None else quantity.of(summary) for summary in summaries]
        columns.append((quantity.name, quantity.unit_in(space), pa.array(found)))
    fields = [pa.field(name, array.type, metadata={"unit": unit} if unit else None) for name, unit, array in columns]
    return pa.Table.from_arrays([array for _, _, array in columns], schema=pa.schema(fields))


def units(table: pa.Table) -> dict[str, str]:
    """The unit of each column that has one, by name."""
    return {field.name: field.metadata[b"unit"].decode() for field in table.schema if field.metadata}


def write_tables(table: pa.Table, folder: Path) -> list[Path]:
    """Write both files; the heads of the CSV file hold the units. Returns their paths."""
    known = units(table)
    heads = [f"{name} [{known[name]}]" if name in known else name for name in table.column_names]
    with atomic.replacing(folder / CSV_NAME) as partial:
        pyarrow.csv.write_csv(table.rename_columns(heads), partial)
    with atomic.replacing(folder / PARQUET_NAME) as partial:
        pyarrow.parquet.write_table(table, partial)
    return [folder / CSV_NAME, folder / PARQUET_NAME]


def _values(values: Sequence[Any]) -> pa.Array:
    """Values of a key: numbers, truth values or texts; texts for anything else, and for a mixture."""
    kinds = {
        bool if isinstance(value, bool) else float if isinstance(value, int | float) else type(value)
        for value in values
    }
    if kinds in ({float}, {bool}, {str}):
        return pa.array(values)
    return pa.array([str(value) for value in values])
