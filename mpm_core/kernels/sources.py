"""The mark of the core's compiled code: it changes whenever a file that kernels are made from changes.

That is every file of the rooms below, the numbering of rows, spaces, and all of `materials`.
"""

from pathlib import Path

from grainlaw.materials.compilation import mark_of_sources

CORE = Path(__file__).parent.parent
# Everything that is compiled stands in one of these rooms; a test keeps it so.
KERNEL_ROOMS = ("kernels", "grid", "obstacles", "parallel")
_FILES = [path for room in KERNEL_ROOMS for path in (CORE / room).rglob("*.py")]
CORE_MARK = mark_of_sources([CORE / "layout.py", CORE / "space.py", *_FILES])
