"""`python -m benchmarks`: measure everything in one run on one machine, print it and store it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from benchmarks.columns import cell_size_for, moving_column
from benchmarks.cylinders import moving_cylinder
from benchmarks.forecasts import QUICK_SCENES, forecasts
from benchmarks.forecasts import SCENES as FORECAST_SCENES
from benchmarks.machine import machine_description
from benchmarks.memory import memory_per_point
from benchmarks.passes import pass_times
from benchmarks.race import THREE_D, race
from benchmarks.report import Table, print_table, write
from benchmarks.roofline import Roofline, measured_roofline
from benchmarks.sizes import cost_over_domain, cost_over_size
from benchmarks.sweeps import gain_of_a_second_worker
from benchmarks.tables import (
    domain_table,
    forecast_table,
    machine_table,
    memory_table,
    pass_table,
    race_table,
    roofline_table,
    size_table,
    sweep_table,
    two_cores_table,
)
from benchmarks.two_cores import gain_of_two_cores
from grainlaw.mpm_core.parallel.threads import cores
from grainlaw.validation.cases.collapses.column import SCENES


class Part(StrEnum):
    """What can be measured by itself."""

    PASSES = "passes"
    PASSES_3D = "passes-3d"
    YARDSTICK = "yardstick"
    YARDSTICK_3D = "yardstick-3d"
    SIZES = "sizes"
    CORES = "cores"
    DOMAIN = "domain"
    MEMORY = "memory"
    PLANS = "plans"
    SWEEP = "sweep"


class Precision(StrEnum):
    """Of nodes and points."""

    DOUBLE = "double"
    SINGLE = "single"


@dataclass(frozen=True)
class Effort:
    """How large and how long: cell size [m] and end [s] of the races, points of the other parts, rounds; precision.

    `sweep` is cell size [m], end [s] and number of values of each of two keys.
    """

    cell_size: float
    end: float
    cell_size_3d: float
    end_3d: float
    sizes: tuple[float, ...]
    rounds: int
    pass_steps: int
    working_sets: tuple[int, ...]
    scenes: Mapping[str, Mapping[str, Any]]
    sweep: tuple[float, float, int]
    precision: str = "double"


FULL = Effort(
    cell_size=0.00625,
    end=1.5,
    cell_size_3d=0.0125,
    end_3d=0.4,
    sizes=(1e4, 1e5, 4e5, 1.6e6, 4e6),
    rounds=5,
    pass_steps=300,
    working_sets=(2**18, 2**20, 2**22, 2**24, 2**26, 3 * 2**28),
    scenes=FORECAST_SCENES,
    sweep=(0.025, 1.5, 8),
)
QUICK = Effort(
    cell_size=0.05,
    end=0.02,
    cell_size_3d=0.05,
    end_3d=0.02,
    sizes=(1e3, 4e3),
    rounds=1,
    pass_steps=20,
    working_sets=(2**18, 2**24),
    scenes=QUICK_SCENES,
    sweep=(0.05, 0.02, 2),
)


@dataclass
class Record:
    """What has been measured, as numbers and as tables."""

    numbers: dict[str, Any] = field(default_factory=dict)
    tables: list[Table] = field(default_factory=list)

    def add(self, part: str, numbers: Any, table: Table) -> None:
        """Keep a result and print its table."""
        self.numbers.setdefault(part, {})[table.title] = numbers
        self.tables.append(table)
        print_table(table)


def main(
    parts: Annotated[
        list[Part] | None, typer.Argument(metavar="[PART]...", help="What to measure; default: all.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="So small that the numbers mean nothing.")] = False,
    end: Annotated[float | None, typer.Option("--end", help="End of the races with the yardsticks [s].")] = None,
    cell_size: Annotated[
        float | None, typer.Option("--cell-size", help="In plane strain, of the race and the passes [m].")
    ] = None,
    material: Annotated[list[str] | None, typer.Option("--material", help=f"Of {', '.join(SCENES)}.")] = None,
    precision: Annotated[
        Precision, typer.Option("--precision", help="Of the library; the race runs in both.")
    ] = Precision.DOUBLE,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder of the results.")] = Path("runs/bench"),
) -> None:
    """Time the library: pass by pass against the roofline, against the yardstick, over size, domain and memory."""
    chosen = QUICK if quick else FULL
    size, last = cell_size or chosen.cell_size, end or chosen.end
    effort = replace(chosen, cell_size=size, end=last, end_3d=end or chosen.end_3d, precision=precision.value)
    materials = material or list(SCENES)
    record = Record()
    machine = machine_description()
    record.add("machine", machine, machine_table(machine))
    roofline = measured_roofline(effort.working_sets)
    record.add("roofline", roofline, roofline_table(roofline))
    for part in parts or list(Part):
        MEASURES[part](record, materials, effort, roofline)
        write(out, record.numbers, record.tables)
    for path in write(out, record.numbers, record.tables):
        typer.echo(f"  {path}")


def _passes(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    for material in materials:
        column = moving_column(material, effort.cell_size, precision=effort.precision)
        found = pass_times(column, effort.pass_steps, roofline)
        record.add("passes", found, pass_table("column", material, found))


def _passes_3d(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    for material in materials:
        cylinder = moving_cylinder(material, effort.cell_size_3d, precision=effort.precision)
        found = pass_times(cylinder, effort.pass_steps, roofline)
        record.add("passes-3d", found, pass_table("cylinder", material, found))


def _yardstick(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    for material in materials:
        found = race(material, effort.cell_size, effort.end, _threads())
        record.add("yardstick", found, race_table("The paper's collapse", material, found))


def _yardstick_3d(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    for material in materials:
        found = race(material, effort.cell_size_3d, effort.end_3d, _threads(), THREE_D)
        record.add("yardstick-3d", found, race_table("Collapse of a cylinder", material, found))


def _sizes(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    for material in materials:
        cell_sizes = [cell_size_for(points) for points in effort.sizes]
        found = cost_over_size(material, cell_sizes, _threads(), effort.rounds, effort.precision)
        record.add("sizes", found, size_table(material, found))


def _two_cores(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    if cores() < 2:
        return
    cell_sizes = [effort.cell_size, *(cell_size_for(points) for points in effort.sizes[1:-1])]
    for material in materials:
        found = [gain_of_two_cores(material, size, 3 * effort.rounds, effort.precision) for size in cell_sizes]
        record.add("cores", found, two_cores_table(material, found))


def _domain(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    found = cost_over_domain(materials[0], effort.cell_size, (1, 10), 3 * effort.rounds, effort.precision)
    record.add("domain", found, domain_table(materials[0], found))


def _memory(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    largest, smallest = cell_size_for(effort.sizes[-1]), cell_size_for(effort.sizes[0])
    found = {material: memory_per_point(material, largest, smallest, effort.precision) for material in materials}
    record.add("memory", found, memory_table(found))


def _plans(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    found = forecasts(effort.scenes)
    record.add("plans", found, forecast_table(found))


def _sweep(record: Record, materials: list[str], effort: Effort, roofline: Roofline) -> None:
    if cores() < 2:
        return
    found = gain_of_a_second_worker(SCENES[materials[0]], *effort.sweep)
    record.add("sweep", found, sweep_table(materials[0], found))


def _threads() -> list[int]:
    return [1, 2] if cores() > 1 else [1]


MEASURES: dict[Part, Callable[[Record, list[str], Effort, Roofline], None]] = {
    Part.PASSES: _passes,
    Part.PASSES_3D: _passes_3d,
    Part.YARDSTICK: _yardstick,
    Part.YARDSTICK_3D: _yardstick_3d,
    Part.SIZES: _sizes,
    Part.CORES: _two_cores,
    Part.DOMAIN: _domain,
    Part.MEMORY: _memory,
    Part.PLANS: _plans,
    Part.SWEEP: _sweep,
}

if __name__ == "__main__":
    typer.run(main)
