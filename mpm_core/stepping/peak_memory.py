"""The greatest memory that this process has held, and what there is of it."""

import os
import sys

try:
    import resource
except ImportError:  # Windows has no such module.
    resource = None  # type: ignore[assignment]

# Linux counts kilobytes, macOS bytes.
UNIT = 1 if sys.platform == "darwin" else 1024
# More than any machine has.
UNKNOWN_MEMORY = 2**48


def peak_memory() -> int:
    """The greatest memory of this process so far [bytes]; 0 where the system does not tell."""
    return 0 if resource is None else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * UNIT


def physical_memory() -> int:
    """The memory of this machine [bytes]; `UNKNOWN_MEMORY` where the system does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return UNKNOWN_MEMORY
