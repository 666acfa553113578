"""What is shown while a run goes on: bars that fit their line, and that kernels have to be compiled first."""

import io
import subprocess
import sys

import pytest
from numba import njit
from rich.console import Console

from grainlaw.mpm_core.stepping.compilation import noticed_compilation
from grainlaw.progress import COMPILING, progress_bar, shown_runs

LONGEST_STATE = "t = 1.234e-05 s, dt = 1.2e-05 s"
LONGEST_COUNT = "9999 of 9999 runs, 9999 failed"


@pytest.mark.parametrize("state", [LONGEST_STATE, LONGEST_COUNT, COMPILING])
def test_a_bar_fits_80_columns(state):
    console = Console(file=io.StringIO(), width=80, force_terminal=True, color_system=None)
    bar = progress_bar(console)
    bar.add_task("", total=1.0, completed=1.0, state=state)
    with console.capture() as printed:
        console.print(bar.get_renderable())
    (line,) = printed.get().splitlines()
    assert line.rstrip().endswith(state)
    assert len(line) <= 80


def test_runs_are_counted_on_a_terminal(monkeypatch):
    console = Console(file=io.StringIO(), width=80, force_terminal=True, color_system=None)
    monkeypatch.setattr("grainlaw.progress.Console", lambda stderr: console)
    with shown_runs(3) as count:
        for name, reason in (("00", ""), ("01", "it failed"), ("02", "")):
            count(name, reason)
    last = console.file.getvalue().splitlines()[-2]
    assert "100 %" in last
    assert "3 of 3 runs, 1 failed" in last


def test_the_first_compilation_is_noticed_and_all_are_measured():
    kernels, noticed = [njit(lambda x: x + 1), njit(lambda x: x + 2)], []
    with noticed_compilation(lambda: noticed.append(1)) as compilation:
        assert compilation.seconds == 0.0
        assert [kernel(1) for kernel in kernels] == [2, 3]
        spent = compilation.seconds
        assert kernels[0](1) == 2
    assert noticed == [1]
    assert spent == compilation.seconds > 0.0
    with noticed_compilation(lambda: noticed.append(2)) as again:
        assert kernels[0](2) == 3
    assert noticed == [1]
    assert again.seconds == 0.0


# A kernel that is compiled where a run would compile its own, without a terminal.
COMPILE = """
import sys
from numba import njit
from grainlaw.progress import shown_progress
with shown_progress(1.0, lines_otherwise=True):
    for kernel in (njit(lambda x: x + 1), njit(lambda x: x + 2)):
        kernel(*map(int, sys.argv[1:]))
"""


def test_without_a_terminal_one_line_says_that_kernels_are_compiled():
    done = subprocess.run([sys.executable, "-c", COMPILE, "1"], capture_output=True, text=True, check=True)
    assert done.stderr == "compiling kernels; the next run with these laws finds them on disk\n"
