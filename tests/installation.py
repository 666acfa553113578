"""grainlaw as a stranger has it: a source distribution, the wheel built from it, and an environment that holds it.

The libraries below it (numpy, numba, ...), pip and setuptools come from the environment that runs the tests, through a
path file, and pip builds with that setuptools instead of downloading one: no test needs a network.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

from documentation import ROOT

# What a clone holds that a distribution is made of, and the tests, which must stay out of it.
SOURCES = (
    "materials", "plugins", "mpm_core", "validation", "scenes", "grainlaw", "tests", "pyproject.toml", "MANIFEST.in",
    "README.md", "LICENSE", "CITATION.cff", "CONTRIBUTING.md", "CHANGELOG.md",
)  # fmt: skip
# pip reads 0 as "no isolation": the option that it stands for is a negative one.
PIP_SETTINGS = {"PIP_NO_BUILD_ISOLATION": "0", "PIP_NO_DEPS": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}


@dataclass(frozen=True)
class Installation:
    """The commands of an environment that holds grainlaw, what it was installed from, and a copy of a clone."""

    binaries: Path
    sdist: Path
    wheel: Path
    sources: Path

    @property
    def python(self) -> Path:
        """The interpreter of the environment."""
        return self.binaries / "python"

    def run(self, *command: object, folder: Path, code: int | None = 0) -> "subprocess.CompletedProcess[str]":
        """Run a command of the environment in a folder; fail, with its words, on another exit code."""
        program, *arguments = map(str, command)
        done = subprocess.run(
            [self.binaries / program, *arguments],
            cwd=folder,
            env={**os.environ, "NUMBA_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert code in (None, done.returncode), f"{command}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
        return done


def installed_once(folder: Path) -> Installation:
    """The installation in a folder, made by the first process that asks for it."""
    import fcntl

    folder.mkdir(exist_ok=True)
    found = Installation(folder / "venv" / "bin", folder / "sdist", folder / "wheel", folder / "sources")
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "finished").exists():
            _make(folder, found)
            (folder / "finished").touch()
    (sdist,), (wheel,) = found.sdist.iterdir(), found.wheel.iterdir()
    return Installation(found.binaries, sdist, wheel, found.sources)


def build_wheel(sources: Path, folder: Path) -> Path:
    """Build the wheel of a folder or source distribution into another folder, without a network."""
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--wheel-dir", folder, sources],
        check=True,
        env={**os.environ, **PIP_SETTINGS},
        cwd=folder.parent,
    )
    (wheel,) = folder.iterdir()
    return wheel


def _make(folder: Path, planned: Installation) -> None:
    sources = planned.sources
    sources.mkdir()
    for name in SOURCES:
        if (ROOT / name).is_dir():
            leave_out = shutil.ignore_patterns("__pycache__", "*.egg-info")
            shutil.copytree(ROOT / name, sources / name, symlinks=True, ignore=leave_out)
        else:
            shutil.copy(ROOT / name, sources / name)
    planned.sdist.mkdir()
    build = f"import setuptools.build_meta as backend; backend.build_sdist({str(planned.sdist)!r})"
    subprocess.run([sys.executable, "-c", build], cwd=sources, check=True, capture_output=True)
    (sdist,) = planned.sdist.iterdir()
    wheel = build_wheel(sdist, planned.wheel)

    venv = planned.binaries.parent
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", venv], check=True)
    own = Path(sysconfig.get_path("purelib", "venv", {"base": str(venv), "platbase": str(venv)}))
    outer = [path for path in sys.path if Path(path).name == own.name]
    (own / "libraries_of_the_tests.pth").write_text("\n".join(outer) + "\n")
    pip = planned.binaries / "pip"
    pip.write_text(f'#!/bin/sh\nexec "{planned.python}" -m pip "$@"\n')
    pip.chmod(0o755)
    subprocess.run([pip, "install", "--quiet", wheel], check=True, env={**os.environ, **PIP_SETTINGS}, cwd=folder)
