"""Spoiling an input file at random: one or two things wrong in its values, its words, its bytes or its encoding."""

import json
import math
import random
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import tomli_w

# What stands in for a value: numbers that are none, too large, too small or of another sign, and other types.
STRANGE: tuple[Any, ...] = (
    *(math.nan, math.inf, -math.inf, 0, -1, 1, 0.5, 1e308, -1e308, 5e-324, 1e-12, 1e12, 10**18, 2**63 - 1),
    *("", "nan", "1e5", "sand", "ÄÖ\n\t", "../..", True, False, [], [1.0], [[]], [1.0, "a"], {}, {"kind": "mesh"}),
)
UNIT_BLUNDERS = (1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9, -1.0)
STRANGE_WORDS = (b"nan", b"inf", b"-inf", b"-1", b"0", b"1e400", b"1e-400", b"1e12", b"", b"x", b"1,5", b"9" * 30)
NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
TABLES: dict[str, tuple[Callable[[str], Any], Callable[[Any], str]]] = {
    ".toml": (tomllib.loads, tomli_w.dumps),
    ".json": (json.loads, json.dumps),
}


def spoil(path: Path, random_: random.Random) -> None:
    """Spoil a file in place, once or twice; of TOML and JSON mostly a value, of the others the bytes."""
    for _ in range(random_.choice((1, 1, 2))):
        data = path.read_bytes()
        if path.suffix not in TABLES or random_.random() < 0.2:
            path.write_bytes(spoilt_bytes(data, random_) if data else b"")
            continue
        loads, dumps = TABLES[path.suffix]
        try:
            path.write_text(dumps(spoilt_table(loads(data.decode()), random_)), encoding="utf-8")
        except (ValueError, TypeError, IndexError):
            # Spoilt before, or with what the format cannot hold.
            continue


def spoilt_table(content: Any, random_: random.Random) -> Any:
    """A copy of tables and lists in which a value is gone, renamed, scaled, wrapped, or another one."""
    content = json.loads(json.dumps(content))
    tables = [found for found in _containers(content) if len(found) > 0]
    table = random_.choice(tables)
    key = random_.choice(list(table) if isinstance(table, dict) else range(len(table)))
    value, action = table[key], random_.choice((0, 1, 2, 2, 2, 3, 4, 5, 5))
    if action == 0:
        del table[key]
    elif action == 1 and isinstance(table, dict):
        name = list(key)
        name[random_.randrange(len(name))] = random_.choice("xX_ .é")
        table["".join(name)] = table.pop(key)
    elif action == 2 and isinstance(value, int | float):
        table[key] = value * random_.choice(UNIT_BLUNDERS)
    elif action == 3:
        table[key] = random_.choice([[value, value], {"value": value}, str(value), [value] * 40])
    elif action == 4:
        table[key] = json.loads(json.dumps(random_.choice(tables)))
    else:
        table[key] = random_.choice(STRANGE)
    return content


def _containers(content: Any) -> Iterator[Any]:
    if isinstance(content, dict | list):
        yield content
        for value in content.values() if isinstance(content, dict) else content:
            yield from _containers(value)


def spoilt_bytes(data: bytes, random_: random.Random) -> bytes:
    """A file that is cut or has other bytes, lines, numbers or another encoding; numbers most often."""
    return random_.choice((_cut, _other_bytes, _more_bytes, _encoded, _other_lines, _other_number, _other_number))(
        data, random_
    )


def _cut(data: bytes, random_: random.Random) -> bytes:
    place, other = sorted((random_.randrange(len(data) + 1), random_.randrange(len(data) + 1)))
    return data[:place] + random_.choice((b"", data[other:]))


def _other_bytes(data: bytes, random_: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(random_.choice((1, 1, 2, 8))):
        changed[random_.randrange(len(data))] = random_.randrange(256)
    return bytes(changed)


def _more_bytes(data: bytes, random_: random.Random) -> bytes:
    place = random_.randrange(len(data) + 1)
    return data[:place] + random_.randbytes(random_.choice((1, 4, 100))) + data[place:]


def _encoded(data: bytes, random_: random.Random) -> bytes:
    return data.decode("latin-1").encode(random_.choice(("utf-16", "utf-8", "utf-8-sig", "utf-32")))


def _other_lines(data: bytes, random_: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    number, action = random_.randrange(len(lines)), random_.randrange(4)
    if action == 0:
        del lines[number]
    elif action == 1:
        lines.insert(random_.randrange(len(lines)), lines[number])
    elif action == 2:
        lines[number] = lines[number].swapcase()
    else:
        lines[number] = lines[number].replace(b" ", b",")
    return b"".join(lines)


def _other_number(data: bytes, random_: random.Random) -> bytes:
    numbers = list(NUMBER.finditer(data))
    if not numbers:
        return data
    found = random_.choice(numbers)
    scaled = f"{float(found[0]) * random_.choice(UNIT_BLUNDERS):.9g}".encode()
    return data[: found.start()] + random_.choice((scaled, random_.choice(STRANGE_WORDS))) + data[found.end() :]
