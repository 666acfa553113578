"""Bytes and lines of a file that may be packed by gzip and may start with a byte-order mark."""

import gzip
import zlib
from pathlib import Path

from grainlaw.materials import InputError

GZIP_SIGNATURE = b"\x1f\x8b"
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
PACKED_ENDING = ".gz"


def unpacked_name(path: Path) -> Path:
    """The name without the ending of gzip."""
    return path.with_suffix("") if path.suffix == PACKED_ENDING else path


def is_packed(path: Path) -> bool:
    """Whether a file starts as gzip does, whatever its name."""
    with path.open("rb") as file:
        return file.read(len(GZIP_SIGNATURE)) == GZIP_SIGNATURE


def read_start(path: Path, count: int) -> bytes:
    """The first bytes of a file, unpacked, without a byte-order mark. Raises InputError for a damaged gzip file."""
    try:
        with gzip.open(path) if is_packed(path) else path.open("rb") as file:
            return bytes(file.read(count)).removeprefix(BYTE_ORDER_MARK)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"{path} cannot be read: {error}") from None


def read_text(path: Path) -> list[str]:
    """Lines of a text file. Raises InputError if it is empty, damaged or no text."""
    try:
        content = gzip.decompress(path.read_bytes()) if is_packed(path) else path.read_bytes()
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError(f"{path} is no text file") from None
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"{path} cannot be read: {error}") from None
    if not any(line.strip() for line in lines):
        raise InputError(f"{path} is empty")
    return lines
