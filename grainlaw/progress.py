"""Progress of a run: a bar with the remaining time on a terminal and in a notebook, plain lines elsewhere."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

if TYPE_CHECKING:
    from grainlaw.mpm_core.simulation import Simulation
    from grainlaw.mpm_core.stepping.run import Progress as Callback

REFRESH_INTERVAL = 0.2
LINE_INTERVAL = 10.0


# Of a bar, so that a line fits on 80 columns.
BAR_WIDTH = 16
COMPILING = "compiling, once per law"


@contextmanager
def shown_progress(end: float, lines_otherwise: bool = False) -> "Iterator[Callback | None]":
    """A callback for `grainlaw.mpm_core.stepping.run.run` that shows the simulated time up to `end` [s].

    Where there is neither a notebook nor a terminal to show a bar on, None, or with `lines_otherwise` a callback that
    writes a line to stderr now and then. All say when kernels have to be compiled first.
    """
    from grainlaw.mpm_core.stepping.compilation import noticed_compilation

    console = Console(stderr=True)
    if _in_notebook():
        shown = _notebook_bar()
        with noticed_compilation(lambda: shown(0.0, COMPILING)):
            yield _every(REFRESH_INTERVAL, lambda s, dt: shown(s.time / end, _state(s, dt)))
        shown(1.0, "")
    elif console.is_terminal:
        with progress_bar(console) as bar:
            task = bar.add_task("", total=end, state="")
            with noticed_compilation(lambda: bar.update(task, state=COMPILING)):
                yield _every(REFRESH_INTERVAL, lambda s, dt: bar.update(task, completed=s.time, state=_state(s, dt)))
            bar.update(task, completed=end)
    elif lines_otherwise:
        with noticed_compilation(say_that_it_compiles):
            yield _every(LINE_INTERVAL, lambda s, dt: print(_line(s, dt, end), file=sys.stderr))
    else:
        yield None


@contextmanager
def shown_runs(total: int) -> Iterator[Callable[[str, str], None]]:
    """A function (name, reason) to call as each of so many runs is there; the reason why it failed may be empty.

    It moves a bar on a terminal and in a notebook, and writes lines to stderr elsewhere.
    """
    console, done, failed = Console(stderr=True), 0, 0

    def state() -> str:
        return f"{done} of {total} runs" + (f", {failed} failed" if failed else "")

    def counting(show: Callable[[str, str], None]) -> Callable[[str, str], None]:
        def count(name: str, reason: str) -> None:
            nonlocal done, failed
            done, failed = done + 1, failed + bool(reason)
            show(name, reason)

        return count

    if _in_notebook():
        shown = _notebook_bar()
        yield counting(lambda name, reason: shown(done / total, state()))
    elif console.is_terminal:
        with progress_bar(console) as bar:
            task = bar.add_task("", total=total, state=state())
            yield counting(lambda name, reason: bar.update(task, completed=done, state=state()))
    else:
        yield counting(lambda name, reason: print(f"{name}: {reason or 'finished'} ({state()})", file=sys.stderr))


def say_that_it_compiles() -> None:
    """One line for those who wait."""
    print("compiling kernels; the next run with these laws finds them on disk", file=sys.stderr)


def progress_bar(console: Console) -> Progress:
    """A bar with what has passed, what is left and the field `state` of its task."""
    return Progress(
        TextColumn("{task.percentage:3.0f} %"),
        BarColumn(bar_width=BAR_WIDTH),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[state]}"),
        console=console,
    )


def _in_notebook() -> bool:
    """Whether a kernel runs this process; a terminal's IPython has none."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and getattr(ipython.get_ipython(), "kernel", None) is not None


def _notebook_bar() -> Any:
    """A function (share, text) that shows a bar below the running cell.

    It is plain HTML: rich's own bar needs ipywidgets, here and where the notebook is looked at.
    """
    from IPython.display import HTML, display

    started = time.perf_counter()

    def bar(share: float, text: str) -> Any:
        elapsed = time.perf_counter() - started
        left = f", {elapsed * (1.0 - share) / share:.0f} s left" if 0.0 < share < 1.0 else ""
        return HTML(f'<progress value="{share:.3f}"></progress> {share:.0%}, {elapsed:.0f} s{left} {text}')

    handle = display(bar(0.0, ""), display_id=True)
    return lambda share, text: handle.update(bar(share, text))


def _state(simulation: "Simulation", dt: float) -> str:
    return f"t = {simulation.time:.4g} s, dt = {dt:.2g} s"


def _line(simulation: "Simulation", dt: float, end: float) -> str:
    kinetic = f"kinetic energy {simulation.ledger.kinetic:.3g} J{simulation.space.amount}"
    return f"{_state(simulation, dt)}, {kinetic}, {simulation.time / end:.0%}"


def _every(interval: float, report: "Callback") -> "Callback":
    last = time.perf_counter()

    def callback(simulation: "Simulation", dt: float) -> None:
        nonlocal last
        now = time.perf_counter()
        if now - last >= interval:
            last = now
            report(simulation, dt)

    return callback
