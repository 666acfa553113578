"""What a check says about a law."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from grainlaw.materials.conformance.subject import Subject

Verdict = Literal["pass", "FAIL", "skipped"]


@dataclass(frozen=True)
class Outcome:
    """A verdict and one line of reason."""

    verdict: Verdict
    reason: str


@dataclass(frozen=True)
class Check:
    """A check: its name, what it proves in one line, and the measurement."""

    name: str
    proves: str
    measure: Callable[[Subject], Outcome]


def judged(passed: bool, reason: str) -> Outcome:
    """Pass or fail, with the measured number as the reason."""
    return Outcome("pass" if passed else "FAIL", reason)
