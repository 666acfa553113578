"""Without a folder for compiled code everything is compiled anew, and one line says so; one to be read serves."""

import subprocess
import sys

import pytest
from stretched_law import command, write_law

# A disk on which nothing can be written, to the compiler's eyes; it holds for the superuser too.
READ_ONLY = """
import errno, sys, tempfile

def refuse(*arguments, **options):
    raise OSError(errno.EROFS, "Read-only file system")

tempfile.TemporaryFile = refuse
from grainlaw.cli.main import main
main()
"""
# One on which a folder can be written until it is full.
FULL = """
import errno
from numba.core.caching import IndexDataCacheFile

def refuse(*arguments, **options):
    raise OSError(errno.ENOSPC, "No space left on device")

IndexDataCacheFile._save_data = refuse
from grainlaw.cli.main import main
main()
"""
ELEMENT = ("element", "isotropic", "--material", "stretched", "--plugin")
LINE = "grainlaw: no folder to keep compiled code in can be written; it is compiled anew in every run"


@pytest.fixture
def law(tmp_path):
    return write_law(tmp_path / "law.py", "", "1.0")


def history(tmp_path, law, *start, **environment):
    """The numbers of an element test, what the compiler said of its cache, and what stands on stderr."""
    out = tmp_path / "history.csv"
    done = command(*start, *ELEMENT, law, "--out", out, NUMBA_DEBUG_CACHE=1, **environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return out.read_text(), done.stdout, done.stderr


def test_without_a_place_for_compiled_code_the_results_are_the_same_and_one_line_says_so(law, tmp_path):
    with_cache, saved, said = history(tmp_path, law, "-m", "grainlaw", NUMBA_CACHE_DIR=tmp_path / "cache")
    assert "data saved to" in saved
    assert said == ""
    # neither a folder of the user's, nor one beside the sources that can be written
    nowhere = {"NUMBA_CACHE_DIR": "/dev/null/cache", "XDG_CACHE_HOME": "/dev/null/cache", "HOME": "/dev/null"}
    without, log, said = history(tmp_path, law, "-c", READ_ONLY, **nowhere)
    assert without == with_cache
    assert "data saved to" not in log
    (line,) = said.splitlines()
    assert line.startswith(LINE)


def test_a_folder_that_can_only_be_read_serves_with_what_it_holds(law, tmp_path):
    environment = {"NUMBA_CACHE_DIR": tmp_path / "cache"}
    first, _, _ = history(tmp_path, law, "-m", "grainlaw", **environment)
    again, log, said = history(tmp_path, law, "-c", READ_ONLY, **environment)
    assert again == first
    assert "data loaded from" in log
    assert said == ""


def test_a_full_disk_ends_no_run(law, tmp_path):
    first, _, _ = history(tmp_path, law, "-m", "grainlaw", NUMBA_CACHE_DIR=tmp_path / "cache")
    without, _, said = history(tmp_path, law, "-c", FULL, NUMBA_CACHE_DIR=tmp_path / "other")
    assert without == first
    assert [line.startswith(LINE) for line in said.splitlines()] == [True]


def test_kernels_of_other_libraries_are_kept_as_the_compiler_does():
    program = (
        "import grainlaw.materials.compilation\nfrom numba import njit\n"
        "from numba.core.caching import FunctionCache\nimport numba.np.arraymath as other\n"
        "class Dispatcher: pass\n"
        "from numba.core import dispatcher\n"
        "print(type(dispatcher.FunctionCache(other.array_median)) is FunctionCache)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"
