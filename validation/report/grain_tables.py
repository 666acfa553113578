"""The tables of the report as rows of text, one source for the page, Markdown and the terminal."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from grainlaw.validation.dem.catalogue import CASES
from grainlaw.validation.dem.coverage import missing_runs, present_runs, seeds_told
from grainlaw.validation.dem.judging.element_verdicts import ElementVerdict
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.judgement import Judgement
from grainlaw.validation.dem.judging.laws_against_grains import Report
from grainlaw.validation.dem.runs import runs_of
from grainlaw.validation.grains.distance import MEASURES, PROFILE_BAND, Distance, Verdict
from grainlaw.validation.reference.reference_set import REFERENCE, Ensemble, Scatter
from grainlaw.validation.report.page import Table

BANDS = (PROFILE_BAND, *(measure.band for measure in MEASURES))
# Marks of what is not within its band.
BEYOND = {Verdict.ACCEPTABLE: "~", Verdict.DIFFERS: "!"}
SYMBOLS = ("E_A", *(measure.symbol for measure in MEASURES))


def scatter_table(found: Sequence[Scatter]) -> Table:
    """How far DEM runs are from one another."""
    rows = []
    for one in sorted(found, key=lambda entry: (entry.kind != "seed against seed", entry.kind, entry.case)):
        cells = [f"{percent(one.mean(number))} ({percent(one.largest(number))})" for number in range(len(SYMBOLS))]
        rows.append((one.kind, one.case.removeprefix("collapse-"), str(len(one.pairs)), *cells))
    note = "Distances between two runs of the same column at rest: mean over the pairs, in brackets the largest."
    return Table("Scatter of the grains themselves", note, ("what", "column", "pairs", *SYMBOLS), tuple(rows))


def verdict_table(ensemble: Ensemble, judgements: Sequence[Judgement]) -> Table:
    """Laws on one column of the reference set."""
    title = f"{ensemble.kind.capitalize()} a = {ensemble.aspect_ratio:g}, {ensemble.floor} floor"
    return comparison_table(ensemble, judgements, title)


def comparison_table(ensemble: Ensemble, judgements: Sequence[Judgement], title: str = "Runs against grains") -> Table:
    """Runs against those of an ensemble."""
    bands = ", ".join(f"{symbol} {percent(band)}" for symbol, band in zip(SYMBOLS, BANDS, strict=True) if band)
    note = (
        f"{len(ensemble.runs)} runs of grains: {', '.join(run.label for run in ensemble.runs)}. "
        f"E_A: mean over them, in brackets nearest and farthest; the others relative to their mean. "
        f"Indistinguishable: {bands}; acceptable: twice that."
    )
    columns = ("law", "verdict", "deposit alone", *SYMBOLS, "largest E_A(t)", "decided by")
    return Table(title, note, columns, tuple(_verdict_row(found) for found in judgements))


def _verdict_row(judged: Judgement) -> tuple[str, ...]:
    found = judged.comparison
    if found is None:
        return (judged.name, judged.verdict, *[""] * (len(SYMBOLS) + 2), judged.failure)
    nearest, farthest = found.nearest[-1], found.farthest[-1]
    area = f"{percent(found.distances[0].distance)} ({percent(nearest)} to {percent(farthest)})"
    others = [_relative(one) for one in found.distances[1:]]
    at = found.times[found.profiles.argmax()]
    return (
        judged.name,
        judged.verdict,
        found.deposit,
        area,
        *others,
        f"{percent(found.profiles.max())} at {at:.2f} s",
        found.decisive.symbol,
    )


def profile_table(judgements: Sequence[Judgement]) -> Table:
    """E_A at each output time, one column for each law."""
    known = [(found.name, found.comparison) for found in judgements if found.comparison is not None]
    rows = [
        (f"{time:.2f}", *(percent(float(np.interp(time, found.times, found.profiles))) for _, found in known))
        for time in (known[0][1].times if known else ())
    ]
    note = "Mean over the runs of grains; the laws' t50 and the rest stand in the table above."
    return Table("E_A at each output time", note, ("t [s]", *(name for name, _ in known)), tuple(rows))


def coverage_table(reference: Path = REFERENCE) -> Table:
    """What the reference set is made of, and what it lacks."""
    present = present_runs(reference)
    rows = []
    for case in CASES:
        there = seeds_told([run for run in runs_of(case) if run.name in present])
        rows.append((case.name, case.purpose, there, seeds_told(missing_runs(case, reference)) or "nothing"))
    note = "Codes with the seeds of their packings; grainlaw dem run CASE makes what is missing."
    return Table("Runs of grains", note, ("case", "what it is", "there", "missing"), tuple(rows))


def summary_table(report: Report) -> Table:
    """One row for each law, one column for each aspect ratio."""
    rows = []
    for law in report.laws:
        judged = [found for found in report.judgements if found.name == law.judged.title]
        counted = sum(found.verdict is Verdict.INDISTINGUISHABLE for found in judged)
        deposits = [found.comparison.deposit for found in judged if found.comparison is not None]
        piles = sum(found is Verdict.INDISTINGUISHABLE for found in deposits)
        rows.append(
            (
                law.judged.title,
                *(found.verdict for found in judged),
                f"{counted} of {len(judged)} ({piles})",
                law.judged.limits,
            )
        )
    rows += [(title, *[""] * (len(report.columns) + 1), reason) for title, reason in report.unfitted.items()]
    columns = ("law", *(ensemble.title for ensemble in report.columns), "indistinguishable", "limits")
    note = "Each verdict is that of the worst of E_A, w, H and t50; in brackets: counted without t50."
    return Table("Verdicts", note, columns, tuple(rows))


def element_table(found: Sequence[ElementVerdict]) -> Table:
    """One row for what an element test measures, one column for each law."""
    # In the order of a law that says something in all tests.
    fullest_first = sorted(found, key=lambda verdict: -len(verdict.distances))
    bands = {one.name: one.band for verdict in fullest_first for one in verdict.distances}
    by_law = [{one.name: one for one in verdict.distances} for verdict in found]
    rows = [
        (name, "" if band is None else percent(band), *(_marked(law.get(name)) for law in by_law))
        for name, band in bands.items()
    ]
    within = [sum(one.verdict is Verdict.INDISTINGUISHABLE for one in verdict.distances) for verdict in found]
    rows.append(
        ("within", "", *(f"{count} of {len(verdict.distances)}" for count, verdict in zip(within, found, strict=True)))
    )
    failures = "".join(f" {verdict.title}: {failure}." for verdict in found for failure in verdict.failures)
    note = (
        "Relative to the grains; root mean squares but for peaks, the friction after them, and dilation. "
        f"{BEYOND[Verdict.ACCEPTABLE]}: beyond the band; {BEYOND[Verdict.DIFFERS]}: beyond twice the band.{failures}"
    )
    return Table("Element tests", note, ("what", "band", *(verdict.title for verdict in found)), tuple(rows))


def _marked(found: Distance | None) -> str:
    if found is None or found.verdict is None:
        return ""
    return f"{_relative(found)} {BEYOND.get(found.verdict, '')}".rstrip()


def parameter_table(laws: Sequence[FittedLaw]) -> Table:
    """What was fitted to what."""
    rows = []
    for law in laws:
        rows += [
            (
                law.judged.title,
                found.name,
                found.unit,
                f"{found.value:.4g}",
                f"{found.lower:.4g} to {found.upper:.4g}",
                "" if found.determined else "not determined",
            )
            for found in law.estimates
        ]
    note = "Fitted to plane shear and isotropic compression of the same grains, used unchanged in every collapse."
    return Table("Parameters", note, ("law", "parameter", "unit", "value", "95 % interval", ""), tuple(rows))


def variant_table(title: str, note: str, judgements: Sequence[Judgement]) -> Table:
    """Controls or limits."""
    rows = [
        (row[0], found.variant.says if found.variant else "", *row[1:])
        for found, row in ((found, _verdict_row(found)) for found in judgements)
    ]
    columns = ("changed", "what it shows", "verdict", "deposit alone", *SYMBOLS, "largest E_A(t)", "decided by")
    return Table(title, note, columns, tuple(rows))


def cost_table(report: Report) -> Table:
    """What both sides cost on each column."""
    rows = []
    for ensemble in report.columns:
        for code in sorted({str(run.description.get("code", "")) for run in ensemble.runs}):
            runs = [run.description for run in ensemble.runs if run.description.get("code") == code]
            seconds = sum(run.get("cpu_time") or run.get("wall_time") or math.nan for run in runs) / len(runs)
            work = sum((run.get("grains") or math.nan) * (run.get("steps") or math.nan) for run in runs) / len(runs)
            rows.append((ensemble.title, code, *_cost(seconds, work), "", ""))
        for judged in report.of_column(ensemble):
            if judged.observation is not None and judged.comparison is not None:
                cost = judged.observation.description
                area = judged.comparison.distances[0].distance
                cells = _cost(float(cost["cpu_time"]), float(cost["points"]) * float(cost["steps"]))
                rows.append((ensemble.title, judged.name, *cells, percent(area), judged.verdict))
    note = (
        "Seconds of one core. Grains: CPU time where a run told it, else wall time on a machine that also did other "
        "work; the whole width and a depth of four grains, or the whole cylinder, without the settling. Laws: CPU "
        "time, half of the column, or a radian."
    )
    columns = ("column", "what", "s", "million grain- or point-steps", "million/s", "E_A", "verdict")
    return Table("Cost", note, columns, tuple(rows))


def _cost(seconds: float, work: float) -> tuple[str, str, str]:
    return f"{seconds:.1f}", f"{work / 1e6:.0f}", f"{work / 1e6 / seconds:.2f}"


def _relative(found: Distance) -> str:
    return "" if math.isnan(found.distance) else f"{100.0 * found.distance:+.1f} %"


def percent(value: float) -> str:
    """A share in percent; nothing for NaN."""
    return "" if math.isnan(value) else f"{100.0 * value:.1f} %"
