"""Errors over processor time, and the settings that nothing beats."""

from collections.abc import Mapping

from validation.speed_error.setting import Outcome, Setting


def error(outcome: Outcome, reference: Outcome) -> float:
    """The largest relative difference of the observables."""
    exact = reference.observables
    return max(abs(value / exact[name] - 1.0) for name, value in outcome.observables.items())


def pareto_front(found: Mapping[Setting, Outcome | None], reference: Setting) -> list[tuple[Setting, float, float]]:
    """(setting, processor time [s], error) of the settings that no cheaper one is as good as, cheap ones first."""
    exact = found[reference]
    assert exact is not None
    costs = sorted(
        (outcome.cpu_time, error(outcome, exact), setting)
        for setting, outcome in found.items()
        if outcome is not None and setting != reference
    )
    front: list[tuple[Setting, float, float]] = []
    for cost, size, setting in costs:
        if not front or size < front[-1][2]:
            front.append((setting, cost, size))
    return front
