"""The folder of a validation run: results.json, junit.xml and one self-contained page."""

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from grainlaw.validation.case import Case, Convergence, Evidence, Measurement
from grainlaw.validation.report.case_content import content
from grainlaw.validation.report.junit import junit
from grainlaw.validation.report.page import FAIL, OUTSIDE, PASS, WITHIN, Page, Picture, Section, Table
from grainlaw.validation.report.plots import convergence_image, figure_image
from grainlaw.validation.report.write import as_json, write_texts
from grainlaw.validation.result import CaseResult

RULE = (
    "A case passes if every number lies within its band, every required order is reached, and its negative control "
    "(the same problem with one deliberate mistake) leaves the band."
)


def write_report(folder: Path, results: Sequence[CaseResult]) -> list[Path]:
    """Write results.json, junit.xml and report.html; returns their paths."""
    texts = {
        "results.json": as_json(content(results)),
        "junit.xml": junit(results),
        "report.html": case_page(results).html(),
    }
    return write_texts(folder, texts)


def case_page(results: Sequence[CaseResult]) -> Page:
    """A table of all cases, and for each its reference, numbers, control, orders and plots."""
    passed = sum(result.passed for result in results)
    spent = sum(result.wall_time for result in results)
    columns = ("case", "verdict", "decisive measurement", "error", "band", "control's error", "order")
    summary = Table("All cases", "", columns, tuple(_summary_row(result) for result in results))
    return Page(
        title=f"grainlaw {version('grainlaw')}: {passed} of {len(results)} validation cases pass",
        introduction=(f"Effort: {results[0].effort}; {spent:.0f} s. {RULE}",),
        sections=(Section(summary.title, tables=(summary,)), *(_section(result) for result in results)),
        command=f"grainlaw validate {' '.join(result.case.name for result in results)} --out DIR",
    )


def measurement_table(
    measurements: Sequence[Measurement], control: Sequence[Measurement] = (), note: str = ""
) -> Table:
    """Each number against its reference and band, the control's at the end."""
    columns = ("measurement", "unit", "measured", "reference", "error", "band", "")
    rows = [_measurement_row(found, found.name, OUTSIDE) for found in measurements]
    rows += [_measurement_row(found, f"control: {found.name}", "outside") for found in control]
    return Table("Measurements", note, columns, tuple(rows))


def pictures(case: Case, evidence: Evidence) -> tuple[Picture, ...]:
    """All figures of a case."""
    drawn = [(figure_image(figure), figure.title) for figure in evidence.figures]
    drawn += [(convergence_image(found), found.name) for found in evidence.convergence]
    return tuple(Picture(image, f"{case.title}: {title}.") for image, title in drawn)


def _summary_row(result: CaseResult) -> tuple[str, ...]:
    worst, control = result.worst, result.worst_of_control
    return (
        result.case.name,
        PASS if result.passed else FAIL,
        worst.name if worst else result.failure,
        significant(worst.error, 3) if worst else "",
        significant(worst.band, 3) if worst else "",
        significant(control.error, 3) if control else "",
        ", ".join(f"{found.fitted_order:.2f}" for found in result.evidence.convergence),
    )


def _section(result: CaseResult) -> Section:
    case, evidence = result.case, result.evidence
    statements = (
        ("verdict", PASS if result.passed else FAIL),
        ("proves", case.proves),
        ("reference", case.reference),
        ("error", case.norm),
        ("control's mistake", case.mistake),
        *(("fails", reason) for reason in result.reasons),
        *(("note", note) for note in evidence.notes),
    )
    tables = [Table(case.name, "", (), statements), measurement_table(evidence.measurements, result.control)]
    tables += [_order_table(found) for found in evidence.convergence]
    command = f"grainlaw validate {case.name} --out DIR"
    return Section(case.name, (case.title,), tuple(tables), pictures(case, evidence), command)


def _measurement_row(found: Measurement, name: str, outside: str) -> tuple[str, ...]:
    return (
        name,
        found.unit,
        significant(found.measured, 7),
        significant(found.reference, 7),
        significant(found.error, 3),
        significant(found.band, 3),
        WITHIN if found.within_band else outside,
    )


def _order_table(found: Convergence) -> Table:
    wanted = "" if found.least_order is None else f" (required: {found.least_order:g})"
    rows = (
        ("size", *(significant(size) for size in found.sizes)),
        ("error", *(significant(error, 3) for error in found.errors)),
        ("order", "", *(f"{order:.2f}" for order in found.orders)),
    )
    note = f"Over {found.against}: fitted order {found.fitted_order:.2f}{wanted}."
    return Table(found.name, note, (), rows)


def significant(value: float | None, digits: int = 4) -> str:
    """A number for a table; nothing for None."""
    return "" if value is None else f"{value:.{digits}g}"
