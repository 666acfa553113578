"""The two ways in which a request can fail, and the warning about one that may not mean what it says."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches


class OneLineError(Exception):
    """An error whose message is one line, whatever file names and texts of others it quotes."""

    def __str__(self) -> str:
        """Return the message with spaces for line breaks."""
        return " ".join(super().__str__().splitlines())


class InputError(OneLineError):
    """The request is wrong: the message says what, what is allowed and the nearest valid name."""


class SimulationError(OneLineError):
    """The request was right but the computation went wrong: the message says when, where and what is left."""


class InputWarning(UserWarning):
    """The request can be done as it stands, but is seldom meant so: the message says what to write instead."""


@contextmanager
def numbers_of(law: str) -> Iterator[None]:
    """Around calls of a law's functions in plain Python, where compiled code would go on with infinity or NaN.

    Raises InputError, in one line with the law's name, for a division by zero, an overflow or a root of what is none.
    """
    try:
        yield
    except (ArithmeticError, ValueError) as error:
        raise InputError(f"{law} has no stress or sound speed with these parameters at the start: {error}") from error


def nearest_name(name: str, valid: Iterable[str]) -> str:
    """A closing hint for an error message: the nearest valid name, or the list of all valid names."""
    choices = sorted(valid)
    close = get_close_matches(name, choices, n=1, cutoff=0.5)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"valid names: {', '.join(choices) or 'none'}"
