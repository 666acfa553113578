"""The measured numbers as tables."""

from collections.abc import Mapping, Sequence

from benchmarks.forecasts import Forecast
from benchmarks.memory import Memory
from benchmarks.passes import PassTime
from benchmarks.race import Result
from benchmarks.report import Table
from benchmarks.roofline import Roofline
from benchmarks.sizes import Cost
from benchmarks.sweeps import SweepTimes
from benchmarks.timing import Spread
from benchmarks.two_cores import TwoCores


def machine_table(machine: Mapping[str, str]) -> Table:
    """On what it ran."""
    return Table("Machine", ("property", "value"), tuple(machine.items()))


def roofline_table(roofline: Roofline) -> Table:
    """What one core can do."""
    rows = [
        (f"triad over {size / 2**20:g} MiB", f"{rate / 1e9:.1f} GB/s") for size, rate in roofline.bandwidths.items()
    ]
    rows += [
        (f"multiply-adds in the first cache, {precision}", f"{rate / 1e9:.1f} GFLOP/s")
        for precision, rate in roofline.arithmetic_rates.items()
    ]
    return Table("Roofline of one core", ("loop", "rate"), tuple(rows))


def race_table(what: str, material: str, results: Sequence[Result]) -> Table:
    """The library against the yardstick."""
    headings = (
        *("program", "steps", "wall [s]", "million point-steps/s", "lap by lap"),
        *("over yardstick, lap by lap", "by processor time", "ratio by processor time"),
    )
    rows = tuple(
        (
            result.name,
            f"{result.steps:,}",
            f"{result.wall_time:.1f}",
            f"{result.rate / 1e6:.1f}",
            _range(result.rates, 1e-6, ".1f"),
            "" if result.ratio is None else _range(result.ratio, 1.0, ".2f"),
            f"{result.cpu_rate / 1e6:.1f}",
            "" if result.cpu_ratio is None else f"{result.cpu_ratio:.2f}",
        )
        for result in results
    )
    return Table(f"{what}, {material}", headings, rows)


def pass_table(body: str, material: str, passes: Sequence[PassTime]) -> Table:
    """Where the time goes."""
    rows = [
        (
            found.name,
            f"{found.nanoseconds:.1f}",
            f"{found.share:.0%}",
            "" if found.floor is None else f"{found.floor:.1f}",
            "" if found.fraction is None else f"{found.fraction:.0%}",
        )
        for found in passes
    ]
    rows.append(("step", f"{sum(found.nanoseconds for found in passes):.1f}", "100%", "", ""))
    headings = ("pass", "ns per point", "share", "floor of the roofline", "fraction reached")
    return Table(f"Passes of a step, one core, {body}, {material}", headings, tuple(rows))


def size_table(material: str, costs: Sequence[Cost]) -> Table:
    """Cost over size and threads."""
    alone = {cost.points: cost.nanoseconds.median for cost in costs if cost.threads == 1}
    cheapest = min(alone.values(), default=1.0)
    rows = tuple(
        (
            f"{cost.points:,}",
            str(cost.threads),
            f"{1e3 / cost.nanoseconds.median:.1f}",
            _range(cost.nanoseconds, 1.0, ".1f"),
            _range(cost.cpu_nanoseconds, 1.0, ".1f"),
            f"{alone[cost.points] / cheapest:.2f}" if cost.threads == 1 else "",
            "" if cost.gain is None else _range(cost.gain, 1.0, ".2f"),
        )
        for cost in costs
    )
    headings = (
        *("points", "threads", "million point-steps/s", "ns per point-step", "processor ns"),
        *("over the cheapest size", "over one thread, round by round"),
    )
    return Table(f"Cost over size, moving column, {material}", headings, rows)


def two_cores_table(material: str, gains: Sequence[TwoCores]) -> Table:
    """What two threads gain, and what two cores have to give."""
    rows = tuple(
        (f"{gain.points:,}", *(_range(found, 1.0, ".2f") for found in (gain.threads, gain.runs, gain.share)))
        for gain in gains
    )
    headings = ("points", "two threads over one", "two runs at once over one", "threads over runs")
    return Table(f"Two cores, moving column, {material}", headings, rows)


def domain_table(material: str, costs: Sequence[tuple[int, Cost]]) -> Table:
    """Cost over the size of the domain."""
    first = costs[0][1].cpu_nanoseconds.median
    rows = tuple(
        (
            f"{cells:,}",
            f"{cost.points:,}",
            _range(cost.nanoseconds, 1.0, ".1f"),
            _range(cost.cpu_nanoseconds, 1.0, ".1f"),
            f"{cost.cpu_nanoseconds.median / first:.3f}",
        )
        for cells, cost in costs
    )
    headings = ("cells of the domain", "points", "ns per point-step", "processor ns", "over the first, processor time")
    return Table(f"The same column in larger domains, {material}", headings, rows)


def memory_table(found: Mapping[str, Memory]) -> Table:
    """Memory per point."""
    rows = tuple(
        (
            material,
            f"{memory.points:,}",
            f"{memory.resident / 1e6:,.0f}",
            f"{memory.bytes_per_point:.0f}",
            f"{memory.bytes_per_further_point:.0f}",
        )
        for material, memory in found.items()
    )
    headings = ("law", "points", "resident [MB]", "bytes per point, all included", "bytes per further point")
    return Table("Memory", headings, rows)


def forecast_table(found: Sequence[Forecast]) -> Table:
    """Plans beside runs."""
    rows = tuple(
        (
            one.scene,
            f"{one.points:,}",
            f"{one.predicted_steps:,}",
            f"{one.steps:,}",
            f"{one.predicted_steps / one.steps:.2f}",
            f"{one.predicted_time:.1f}",
            f"{one.time:.1f}",
            f"{one.predicted_time / one.time:.2f}",
            f"{one.cpu_time:.1f}",
            f"{one.predicted_time / one.cpu_time:.2f}",
        )
        for one in found
    )
    headings = (
        *("scene", "points", "steps planned", "steps taken", "ratio"),
        *("time planned [s]", "wall time taken [s]", "ratio", "processor time taken [s]", "ratio"),
    )
    return Table("Plans and runs", headings, rows)


def sweep_table(material: str, found: SweepTimes) -> Table:
    """What a second worker gains."""
    row = (f"{found.runs}", f"{found.one:.1f}", f"{found.two:.1f}", f"{found.ratio:.2f}")
    return Table(f"Sweep, {material}", ("runs", "one worker [s]", "two workers [s]", "two over one"), (row,))


def _range(values: Spread, factor: float, digits: str) -> str:
    least, median, greatest = (
        format(factor * value, digits) for value in (values.least, values.median, values.greatest)
    )
    return f"{median} ({least} to {greatest})"
