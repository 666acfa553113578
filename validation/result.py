"""Running cases, and what comes of them."""

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from grainlaw.materials import InputError, SimulationError
from grainlaw.validation.case import Case, Effort, Evidence, Measurement

NO_EVIDENCE = Evidence(())


@dataclass(frozen=True)
class CaseResult:
    """A case, its evidence and that of its control; `failure` says what kept it from being measured."""

    case: Case
    effort: Effort
    evidence: Evidence
    control: tuple[Measurement, ...]
    wall_time: float
    failure: str = ""

    @property
    def within_bands(self) -> bool:
        """Whether all measurements lie in their bands and all orders are reached."""
        evidence = self.evidence
        measured = bool(evidence.measurements) and all(found.within_band for found in evidence.measurements)
        return measured and all(found.reaches_order for found in evidence.convergence)

    @property
    def control_fails(self) -> bool:
        """Whether the negative control leaves a band, as it has to."""
        return any(not found.within_band for found in self.control)

    @property
    def passed(self) -> bool:
        """The verdict."""
        return not self.failure and self.within_bands and self.control_fails

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the case failed; empty if it passed."""
        if self.failure:
            return (self.failure,)
        reasons = [
            f"{found.name}: error {found.error:.3g}, band {found.band:.3g}"
            for found in self.evidence.measurements
            if not found.within_band
        ]
        reasons += [
            f"{found.name}: order {found.fitted_order:.2f}, wanted {found.least_order:g}"
            for found in self.evidence.convergence
            if not found.reaches_order
        ]
        if not self.control_fails:
            reasons.append(f"the negative control ({self.case.mistake}) stays within the band")
        return tuple(reasons)

    @property
    def worst(self) -> Measurement | None:
        """The measurement that uses most of its band."""
        found = self.evidence.measurements
        return max(found, key=share_of_band) if found else None

    @property
    def worst_of_control(self) -> Measurement | None:
        """The measurement of the control that exceeds its band most."""
        return max(self.control, key=share_of_band) if self.control else None


def share_of_band(found: Measurement) -> float:
    """Error over band; infinite where the error is not a number or the band has no width."""
    return found.error / found.band if found.band > 0.0 and not math.isnan(found.error) else math.inf


def run_case(case: Case, effort: Effort) -> CaseResult:
    """Measure a case and its control; a computation that breaks down is a failure of the case."""
    started = time.perf_counter()
    evidence, failure = NO_EVIDENCE, ""
    control: tuple[Measurement, ...] = ()
    try:
        evidence = case.measure(effort)
        control = case.control(effort)
    except (InputError, SimulationError, ArithmeticError) as error:
        failure = str(error)
    return CaseResult(case, effort, evidence, control, time.perf_counter() - started, failure)


def run_cases(
    cases: Iterable[Case], effort: Effort, announce: Callable[[Case], None] = lambda case: None
) -> list[CaseResult]:
    """Measure cases one after the other; `announce(case)` is called before each."""
    results = []
    for case in cases:
        announce(case)
        results.append(run_case(case, effort))
    return results
