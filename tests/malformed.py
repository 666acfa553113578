"""What reading spoilt inputs comes to.

`python tests/malformed.py COUNT [SEED]` tries many and prints each kind of fault with the first input that showed it.
"""

import random
import re
import signal
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from inputs_to_spoil import subjects
from spoiling import spoil

from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.errors import InputWarning

LONGEST = 10.0  # s of processor time, to refuse or to read an input
LONGEST_LINE = 1000
FAULTS = ("fault", "not one line")


class Trial(NamedTuple):
    """What an input came to: `refused` in a line, `read`, or one of `FAULTS` with its traceback or its message."""

    outcome: str
    text: str


def attempt(read: Callable[[Path], object], path: Path) -> Trial:
    """Read an input; a refusal is one line, what is read says nothing but warnings of ours."""
    with warnings.catch_warnings(), time_limit():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", InputWarning)
        try:
            read(path)
        except (InputError, SimulationError) as error:
            line = str(error)
            fits = line and "\n" not in line and len(line) < LONGEST_LINE
            return Trial("refused" if fits else "not one line", line)
        except Exception:
            return Trial("fault", traceback.format_exc())
    return Trial("read", "")


@contextmanager
def time_limit() -> Iterator[None]:
    """Raise TimeoutError in the block after `LONGEST` seconds of this process, however busy the machine is."""

    def end(*_: object) -> None:
        raise TimeoutError(f"longer than {LONGEST:g} s")

    before = signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def trials(count: int, seed: int, folder: Path) -> Iterator[tuple[str, Path, Trial]]:
    """Spoilt inputs of every kind in turn: what each is, where it lies, and what it came to."""
    kinds = list(subjects().items())
    for number in range(count):
        random_ = random.Random(f"{seed} {number}")
        kind, subject = kinds[number % len(kinds)]
        name, write = random_.choice(list(subject.good.items()))
        own = folder / str(number)
        own.mkdir()
        path = write(own)
        spoil(path, random_)
        yield f"{kind}: {name}", path, attempt(subject.read, path)


def main() -> None:
    """Try many; of each place in the code where an input failed, print the first."""
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    outcomes: Counter[str] = Counter()
    places: Counter[str] = Counter()
    for name, path, trial in trials(count, seed, Path(tempfile.mkdtemp(prefix="malformed-"))):
        outcomes[f"{name.split(':')[0]} {trial.outcome}"] += 1
        if trial.outcome in FAULTS:
            own = re.findall(r'File ".*/((?:materials|plugins|mpm_core|validation)/.*)", line (\d+)', trial.text)
            place = ":".join(own[-1]) if own else trial.text[:80]
            if not places[place]:
                print(f"{name}, {place}: {trial.text.strip().splitlines()[-1][:200]}\n    {path}", flush=True)
            places[place] += 1
    print(dict(outcomes), dict(places), sep="\n")


if __name__ == "__main__":
    main()
