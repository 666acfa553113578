"""A process of its own that goes through files, so that nobody else hangs or dies of a damaged one.

A line of JSON asks for a file: its kind, its path and the processor time that each of its parts may take [s]; the
answer is an empty line. A part that takes longer, or on which the library crashes, ends the process without an answer.
What can be read of a file is not judged here.
"""

import json
import math
import resource
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import h5py

# Whatever a library or the conversion of a value raises has come to an end.
FINITE = Exception


def walk_hdf5(path: str, seconds: float) -> None:
    """Touch all that a reader may touch, but the numbers of datasets: groups, links, attributes, indices of chunks."""
    limit_processor_time(seconds)
    with h5py.File(path) as file:
        _walk_group(file, set(), seconds)


def walk_vtk(path: str, seconds: float) -> None:
    """Read the file."""
    import pyvista

    limit_processor_time(seconds)
    with pyvista.vtk_verbosity("off"):
        pyvista.read(path)


def _walk_group(group: h5py.Group, seen: set[tuple[int, int]], seconds: float) -> None:
    """Go through a group, but through nothing twice, whatever links lead to it."""
    _touch_attributes(group)
    for name in _names(group):
        limit_processor_time(seconds)
        with suppress(FINITE):
            found = group[name]
            place = h5py.h5o.get_info(found.id)
            if (place.fileno, place.addr) in seen:
                continue
            seen.add((place.fileno, place.addr))
            if isinstance(found, h5py.Group):
                _walk_group(found, seen, seconds)
            else:
                _touch_attributes(found)
                if isinstance(found, h5py.Dataset) and found.chunks is not None:
                    found.id.chunk_iter(lambda _: None)


def _touch_attributes(found: h5py.HLObject) -> None:
    for name in _names(found.attrs):
        with suppress(FINITE):
            found.attrs[name]


def _names(mapping: Any) -> Iterator[str]:
    with suppress(FINITE):
        yield from list(mapping)


def limit_processor_time(seconds: float) -> None:
    """End this process `seconds` of processor time from now."""
    _, highest = resource.getrlimit(resource.RLIMIT_CPU)
    wanted = math.ceil(time.process_time() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (wanted if highest < 0 else min(wanted, highest), highest))


def main() -> None:
    """Answer until nobody asks any more."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    walks = {"HDF5": walk_hdf5, "VTK": walk_vtk}
    # Libraries print what they think of a file; the answer is the only thing that goes out.
    answers, sys.stdout = sys.stdout, sys.stderr
    for line in sys.stdin:
        kind, path, seconds = json.loads(line)
        with suppress(FINITE):
            walks[kind](path, seconds)
        print(file=answers, flush=True)


if __name__ == "__main__":
    main()
