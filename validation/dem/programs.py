"""Start LIGGGHTS and YADE: time limit, log, and their failures as one clear line."""

import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from grainlaw.materials.errors import InputError, SimulationError

POLL_INTERVAL = 0.5


@dataclass(frozen=True)
class Program:
    """A DEM code: its executable, the Debian package that brings it, and how it is started on a deck."""

    name: str
    executable: str
    package: str
    arguments: tuple[str, ...]
    version_pattern: str

    def command(self, deck: str) -> list[str]:
        """The command line that runs `deck`; raises InputError if the code is not installed."""
        found = shutil.which(self.executable)
        if found is None:
            raise InputError(
                f"{self.name} is not installed: no '{self.executable}' on the path; install the Debian package "
                f"'{self.package}' (apt-get update && apt-get install -y --no-install-recommends {self.package})"
            )
        return [found, *self.arguments, deck]


LIGGGHTS = Program("LIGGGHTS", "liggghts", "liggghts", ("-log", "none", "-in"), r"Version LIGGGHTS-PUBLIC ([\d.]+)")
YADE = Program("YADE", "yade", "yade", ("-n", "-x", "-j1"), r"Welcome to Yade (\S+)")
PROGRAMS = {"liggghts": LIGGGHTS, "yade": YADE}

# What a code prints when it fails, and what that means for a case of ours.
KNOWN_FAILURES = (
    (r"Lost atoms: original \d+ current \d+", "grains left the box: the time step is too long or the box too small"),
    (r"Youngs? modulus.*5e6|youngsModulus >= 5e6", "LIGGGHTS takes no Young's modulus below 5e6 Pa"),
    (r"ERROR.*", "LIGGGHTS refused the deck"),
    (r"^\w*Error: .*", "the YADE script failed"),
    (r"FATAL.*", "YADE stopped"),
)


@cache
def installed_version(program: Program) -> str:
    """The version a code prints of itself, 'unknown' if it prints none; raises InputError if it is missing."""
    executable = program.command("")[0]
    # LIGGGHTS would leave its log in the working directory.
    flags = ["--version"] if program is YADE else ["-log", "none", "-help"]
    answer = subprocess.run(
        [executable, *flags], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=60, check=False
    )
    text = answer.stdout + answer.stderr
    found = re.search(program.version_pattern, text) or re.search(r"[Vv]ersion:?\s+(\S+)", text)
    return found.group(1).rstrip(",") if found else "unknown"


@dataclass(frozen=True)
class Cost:
    """Wall time and processor time of a run [s]."""

    wall: float
    cpu: float


def run_program(
    program: Program, folder: Path, deck: str, time_limit: float, report: Callable[[str], None] = lambda _: None
) -> Cost:
    """Run `deck` in `folder` with its output in `log.txt`; return what it cost.

    `report` is given the last line of the log now and then; whatever it raises ends the code and all that it started.
    Raises SimulationError with the cause if the code fails or takes longer than `time_limit` [s], InputError if it is
    not installed.
    """
    command = program.command(deck)
    log = folder / "log.txt"
    start, used = time.monotonic(), _processor_time()
    with log.open("wb") as output:
        # A session of its own: signals of the terminal reach it through this process only, and it ends as a whole.
        process = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            while process.poll() is None:
                if time.monotonic() - start > time_limit:
                    raise SimulationError(f"{program.name} took longer than {time_limit:.0f} s; see {log}")
                time.sleep(POLL_INTERVAL)
                report(_last_line(log))
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
    text = log.read_text(encoding="utf-8", errors="replace")
    cause = failure(text)
    if process.returncode != 0 or cause:
        raise SimulationError(f"{program.name}: {cause or f'exit code {process.returncode}'}; see {log}")
    return Cost(time.monotonic() - start, _processor_time() - used)


def _processor_time() -> float:
    """Of all child processes that have ended [s]."""
    times = os.times()
    return times.children_user + times.children_system


def failure(log: str) -> str:
    """The cause of a failure that a log tells of, in one line; empty if it tells of none."""
    for pattern, meaning in KNOWN_FAILURES:
        found = re.search(pattern, log, re.MULTILINE)
        if found:
            return f"{meaning} ({found.group(0).strip()})"
    return ""


def _last_line(log: Path) -> str:
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 400))
        lines = file.read().decode("utf-8", errors="replace").split("\n")
    return next((line.strip() for line in reversed(lines[:-1]) if line.strip()), "")
