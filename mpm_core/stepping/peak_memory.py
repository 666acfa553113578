"""The greatest memory that this process has held."""

import sys

try:
    import resource
except ImportError:  # Windows has no such module.
    resource = None  # type: ignore[assignment]

# Linux counts kilobytes, macOS bytes.
UNIT = 1 if sys.platform == "darwin" else 1024


def peak_memory() -> int:
    """The greatest memory of this process so far [bytes]; 0 where the system does not tell."""
    return 0 if resource is None else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * UNIT
