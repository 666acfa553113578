"""Progress of a run on stderr: a bar with the remaining time on a terminal, plain lines elsewhere."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

if TYPE_CHECKING:
    from grainlaw.mpm_core.simulation import Simulation
    from grainlaw.mpm_core.stepping.run import Progress as Callback

REFRESH_INTERVAL = 0.2
LINE_INTERVAL = 10.0


@contextmanager
def reporting(end: float) -> "Iterator[Callback]":
    """A callback for `grainlaw.mpm_core.stepping.run.run` that reports simulated time up to `end` [s]."""
    console = Console(stderr=True)
    if console.is_terminal:
        with _bar(console) as bar:
            task = bar.add_task("", total=end, state="")
            yield _every(REFRESH_INTERVAL, lambda s, dt: bar.update(task, completed=s.time, state=_state(s, dt)))
            bar.update(task, completed=end)
    else:
        yield _every(LINE_INTERVAL, lambda s, dt: typer.echo(f"{_state(s, dt)}, {s.time / end:.0%}", err=True))


def _bar(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.percentage:3.0f} %"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[state]}"),
        console=console,
    )


def _state(simulation: "Simulation", dt: float) -> str:
    return f"t = {simulation.time:.4g} s, dt = {dt:.3g} s, kinetic energy {simulation.ledger.kinetic:.3g} J/m"


def _every(interval: float, report: "Callback") -> "Callback":
    last = time.perf_counter()

    def callback(simulation: "Simulation", dt: float) -> None:
        nonlocal last
        now = time.perf_counter()
        if now - last >= interval:
            last = now
            report(simulation, dt)

    return callback
