"""HDF5 files on a disk that may become full.

The library may crash the process when its own writes fail, at once or at its end. It is therefore given a file object
to write to, which never fails; what the disk says is raised when the library is done with the file.
"""

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import h5py

from grainlaw.materials import InputError

USER_BLOCK = 512  # bytes, the least that HDF5 leaves to others
SEAL = b"grainlaw, SHA-256 of what follows the first 512 bytes:\n"


@contextmanager
def new_hdf5(path: Path, **options: Any) -> Iterator[h5py.File]:
    """A new file, open for writing. Raises OSError at the end if not all could be written."""
    with path.open("w+b", buffering=0) as raw:
        shield = _Shield(raw)
        try:
            with h5py.File(shield, "w", **options) as file:
                yield file
        except Exception:
            # What the library misses may be what was left out.
            if shield.error is None:
                raise
    if shield.error is not None:
        raise shield.error


@contextmanager
def changed_hdf5(path: Path) -> Iterator[h5py.File]:
    """A file, open for changes, which reach the disk together at the end.

    What lies behind its old end is written first, so that the file is as it was if there is no space for that.
    Raises OSError for a file that cannot be read or written. No lock is asked for: a viewer may have the file open.
    """
    with path.open("rb", buffering=0) as raw:
        changes = _Changes(raw)
        with h5py.File(changes, "r+") as file:
            yield file
    with path.open("r+b", buffering=0) as raw:
        changes.put_into(raw)


@contextmanager
def sealed_hdf5(path: Path) -> Iterator[h5py.File]:
    """A new file like `new_hdf5`, with the digest of all else in its user block, by which damage is told."""
    with new_hdf5(path, userblock_size=USER_BLOCK) as file:
        yield file
    with path.open("r+b", buffering=0) as raw:
        seal = SEAL + _digest(raw)
        raw.seek(0)
        raw.write(seal)


def is_sealed(path: Path) -> bool:
    """Whether a file holds a digest. Raises InputError where that is not the digest of the file."""
    with path.open("rb") as raw:
        start = raw.read(USER_BLOCK)
        if not start.startswith(SEAL):
            return False
        if not start.startswith(SEAL + _digest(raw)):
            raise InputError(f"{path} is damaged: it is not as it was written")
        return True


def _digest(raw: IO[bytes]) -> bytes:
    """Of all that follows the user block."""
    raw.seek(USER_BLOCK)
    return hashlib.file_digest(raw, "sha256").digest()  # type: ignore[arg-type]


class _Shield:
    """A file whose writes do not fail: after the first failure they are left out."""

    def __init__(self, raw: IO[bytes]) -> None:
        self._raw = raw
        self.error: OSError | None = None

    def write(self, data: Any) -> int:
        if self.error is None:
            try:
                _write_all(self._raw, memoryview(data))
            except OSError as error:
                self.error = error
        return len(data)

    def truncate(self, size: int) -> int:
        if self.error is None:
            try:
                self._raw.truncate(size)
            except OSError as error:
                self.error = error
        return size

    def read(self, count: int) -> bytes:
        return self._raw.read(count)

    def readinto(self, buffer: Any) -> int:
        return int(self._raw.readinto(buffer))  # type: ignore[attr-defined]

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        return self._raw.seek(offset, whence)

    def tell(self) -> int:
        return self._raw.tell()

    def flush(self) -> None:
        """Nothing is held back."""


class _Changes:
    """A file as it will be, with the changes kept in memory."""

    def __init__(self, raw: IO[bytes]) -> None:
        self._raw = raw
        self._old_size = self._size = raw.seek(0, os.SEEK_END)
        self._position = 0
        self._writes: list[tuple[int, bytes]] = []

    def put_into(self, raw: IO[bytes]) -> None:
        """Write all changes into the file, what lies behind its old end first. Raises OSError."""
        try:
            for start, data in self._writes:
                skipped = max(0, self._old_size - start)
                if skipped < len(data):
                    raw.seek(start + skipped)
                    _write_all(raw, memoryview(data)[skipped:])
            os.fsync(raw.fileno())
        except OSError:
            raw.truncate(self._old_size)
            raise
        for start, data in self._writes:
            if start < self._old_size:
                raw.seek(start)
                _write_all(raw, memoryview(data)[: self._old_size - start])
        raw.truncate(self._size)
        os.fsync(raw.fileno())

    def write(self, data: Any) -> int:
        self._writes.append((self._position, bytes(data)))
        self._position += len(data)
        self._size = max(self._size, self._position)
        return len(data)

    def read(self, count: int) -> bytes:
        buffer = bytearray(count)
        self.readinto(buffer)
        return bytes(buffer)

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        first, last = self._position, self._position + len(view)
        self._raw.seek(first)
        found = self._raw.readinto(view)  # type: ignore[attr-defined]
        view[found:] = bytes(len(view) - found)
        for start, data in self._writes:
            low, high = max(first, start), min(last, start + len(data))
            if low < high:
                view[low - first : high - first] = data[low - start : high - start]
        self._position = last
        return len(view)

    def truncate(self, size: int) -> int:
        self._size = size
        return size

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        self._position = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._position, os.SEEK_END: self._size}[whence]
        return self._position

    def tell(self) -> int:
        return self._position

    def flush(self) -> None:
        """Nothing is held back but what the end writes."""


def _write_all(raw: IO[bytes], data: memoryview) -> None:
    """Write to an unbuffered file, which may take less than it is given."""
    while len(data):
        data = data[raw.write(data) :]
