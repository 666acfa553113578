"""The two ways in which a request can fail, and the warning about one that may not mean what it says."""

from collections.abc import Iterable
from difflib import get_close_matches


class InputError(Exception):
    """The request is wrong: the message says what, what is allowed and the nearest valid name."""


class SimulationError(Exception):
    """The request was right but the computation went wrong: the message says when, where and what is left."""


class InputWarning(UserWarning):
    """The request can be done as it stands, but is seldom meant so: the message says what to write instead."""


def nearest_name(name: str, valid: Iterable[str]) -> str:
    """A closing hint for an error message: the nearest valid name, or the list of all valid names."""
    choices = sorted(valid)
    close = get_close_matches(name, choices, n=1, cutoff=0.5)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"valid names: {', '.join(choices) or 'none'}"
