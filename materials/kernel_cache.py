"""Where compiled kernels are kept on disk: as the compiler does it, but never at the price of a run.

Without a folder that can be written, the compiler refuses to make a kernel that it shall keep. Ours are then compiled
anew in every process, and one line says so. A folder that can only be read serves with what it holds.
"""

import os
import sys
from collections.abc import Callable
from functools import cache
from typing import Any

import llvmlite
import numpy as np
from numba.core import caching, config, dispatcher

OWN = "grainlaw"
# What code depends on besides sources, signature, processor and version of the compiler, which are in its key already.
SETTINGS = (
    llvmlite.__version__,
    np.__version__,
    *(getattr(config, name) for name in ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK")),
)


class _ToRead:
    """A place for compiled code that is there, whether or not it can be written."""

    def ensure_cache_path(self) -> None:
        path = self.get_cache_path()  # type: ignore[attr-defined]
        if not os.path.isdir(path):
            raise FileNotFoundError(path)


class _UserProvided(_ToRead, caching.UserProvidedCacheLocator):
    pass


class _InTree(_ToRead, caching.InTreeCacheLocator):
    pass


class _UserWide(_ToRead, caching.UserWideCacheLocator):
    pass


class _Kept(caching.CompileResultCacheImpl):
    # Where it can be written comes first.
    _locator_classes = [*caching.CacheImpl._locator_classes, _UserProvided, _InTree, _UserWide]  # noqa: RUF012


class KernelCache(caching.FunctionCache):
    """The disk cache of a kernel of ours; none where there is no place for it."""

    _impl_class = _Kept

    def __init__(self, py_func: Callable[..., Any]) -> None:
        try:
            super().__init__(py_func)
        except RuntimeError:
            self._cache_path = None
            self.disable()
            _say_that_nothing_is_kept()

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return (*super()._index_key(sig, codegen), SETTINGS)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel; where that fails, for instance on a full disk, do without."""
        try:
            super().save_overload(sig, data)
        except OSError:
            _say_that_nothing_is_kept()


@cache
def _say_that_nothing_is_kept() -> None:
    print(
        f"{OWN}: no folder to keep compiled code in can be written; it is compiled anew in every run "
        "(NUMBA_CACHE_DIR names a folder for it)",
        file=sys.stderr,
    )


def _cache_of(py_func: Callable[..., Any]) -> caching.FunctionCache:
    is_own = (py_func.__module__ or "").partition(".")[0] == OWN
    return KernelCache(py_func) if is_own else caching.FunctionCache(py_func)


def use_kernel_cache() -> None:
    """Have the compiler keep our kernels as above; those of other libraries stay as they are."""
    dispatcher.FunctionCache = _cache_of  # type: ignore[attr-defined]
