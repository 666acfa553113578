"""Without a folder for compiled code everything is compiled anew, and one line says so; one to be read serves."""

import errno
import os
import time

import pytest
from numba import njit
from numba.core import config
from numba.core.caching import FunctionCache
from stretched_law import command, write_law

from grainlaw.materials import kernel_cache
from grainlaw.materials.law_file import import_law_file

# A disk on which nothing can be written, to the compiler's eyes; it holds for the superuser too.
READ_ONLY = """
import errno, tempfile
from numba.core.caching import IndexDataCacheFile

def refuse(*arguments, **options):
    raise OSError(errno.EROFS, "Read-only file system")

tempfile.TemporaryFile = IndexDataCacheFile._open_for_write = refuse
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
    # a law that no cache can know from an earlier test
    return write_law(tmp_path / "law.py", f"# {tmp_path} {time.time()}", "1.0")


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


def twice(x):
    return 2 * x


def test_a_kernel_without_any_folder_is_compiled_all_the_same(tmp_path, monkeypatch, capsys):
    def refuse(*arguments, **options):
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(os, "makedirs", refuse)
    monkeypatch.setattr(config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null/cache")
    kernel_cache._say_that_nothing_is_kept.cache_clear()
    path = tmp_path / "alone.py"
    path.write_text("def twice(x):\n    return 2 * x\n")
    function = import_law_file(path).twice
    with pytest.raises(RuntimeError, match="no locator"):
        FunctionCache(function)
    kernel = njit(function)
    kernel._cache = kernel_cache.KernelCache(function)
    assert kernel(2) == 4
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(LINE)


@pytest.mark.parametrize(("module", "kind"), [("grainlaw.made_up", kernel_cache.KernelCache), ("other", FunctionCache)])
def test_kernels_of_other_libraries_are_kept_as_the_compiler_does(module, kind, monkeypatch):
    kernel_cache.use_kernel_cache()
    monkeypatch.setattr(twice, "__module__", module)
    assert type(njit(cache=True)(twice)._cache) is kind


def test_code_of_another_compiler_is_another_entry(tmp_path, monkeypatch):
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    keys = []
    for version in ("1", "2"):
        monkeypatch.setattr(kernel_cache, "SETTINGS", (version,))
        kernel = njit(twice)
        kernel._cache = kernel_cache.KernelCache(twice)
        kernel(1)
        keys.append(kernel.stats.cache_misses[next(iter(kernel.stats.cache_misses))])
    assert keys == [1, 1]
    kernel = njit(twice)
    kernel._cache = kernel_cache.KernelCache(twice)
    kernel(1)
    assert list(kernel.stats.cache_hits.values()) == [1]
