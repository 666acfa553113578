"""Files that are either complete or absent: written beside the final name, then renamed onto it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a path to write to; on success it becomes `path` in one step, on failure `path` is left as it was.

    The path that is written to lies in the same folder and ends like `path`, so that library writers that choose the
    format by the ending can be given it. What a killed process leaves there is overwritten by the next writer.
    """
    partial = path.with_name(f".partial-{path.name}")
    try:
        yield partial
        _flush_to_disk(partial)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def write_bytes(path: Path, content: bytes) -> None:
    """Write `content` to `path`, complete or not at all."""
    with replacing(path) as partial:
        partial.write_bytes(content)


def write_text(path: Path, content: str) -> None:
    """Write `content` to `path` in UTF-8 with plain line feeds, complete or not at all."""
    write_bytes(path, content.encode())


def _flush_to_disk(path: Path) -> None:
    """Wait until the content is on the disk: a rename may otherwise reach it before the content does."""
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
