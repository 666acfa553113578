"""How two parameters of a law stand to one another, for its `inconsistency`: what is wrong, or nothing."""

from typing import Any


def not_smaller(parameters: Any, name: str, than: str) -> str:
    """What is wrong where a parameter is smaller than another; empty where it is not."""
    value, least = _values(parameters, name, than)
    return "" if value >= least else f"{name} = {value:g} must not be smaller than {than} = {least:g}"


def not_larger(parameters: Any, name: str, than: str) -> str:
    """What is wrong where a parameter is larger than another; empty where it is not."""
    value, largest = _values(parameters, name, than)
    return "" if value <= largest else f"{name} = {value:g} must not be larger than {than} = {largest:g}"


def larger(parameters: Any, name: str, than: str) -> str:
    """What is wrong where a parameter is not larger than another; empty where it is."""
    value, exceeded = _values(parameters, name, than)
    return "" if value > exceeded else f"{name} = {value:g} must be larger than {than} = {exceeded:g}"


def _values(parameters: Any, *names: str) -> tuple[float, ...]:
    return tuple(float(getattr(parameters, name)) for name in names)
