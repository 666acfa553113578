"""On what a benchmark ran: processor, memory, versions, and how busy the machine was."""

import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

import numba
import numpy as np

from grainlaw.mpm_core.parallel.threads import cores

ROOT = Path(__file__).resolve().parents[1]


def machine_description() -> dict[str, str]:
    """What a reader needs to know to compare figures; the load is that of the last minute, before the benchmark."""
    return {
        "processor": _processor(),
        "cores": str(cores()),
        "memory": f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB",
        "load before": f"{os.getloadavg()[0]:.1f}",
        "system": f"{platform.system()} {platform.machine()}",
        "versions": f"Python {platform.python_version()}, numba {numba.__version__}, numpy {np.__version__}",
        "grainlaw": f"{version('grainlaw')}, commit {_commit()}",
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown"
    keys = ("model name", "cpu family", "model\t", "cache size")
    found = [next((line.partition(":")[2].strip() for line in lines if line.startswith(key)), "") for key in keys]
    return f"{found[0]}, family {found[1]} model {found[2]}, cache {found[3]}"


def _commit() -> str:
    command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"
