"""The report as one self-contained HTML page."""

from collections.abc import Sequence
from importlib.metadata import version

from jinja2 import Environment, PackageLoader

from grainlaw.validation.report.plots import convergence_image, figure_image
from grainlaw.validation.result import CaseResult


def page(results: Sequence[CaseResult]) -> str:
    """A page with a table of all cases, and for each its reference, numbers, control, orders and plots."""
    environment = Environment(loader=PackageLoader("grainlaw.validation.report"), autoescape=True, trim_blocks=True)
    environment.filters["significant"] = significant
    images = {result.case.name: _images(result) for result in results}
    return environment.get_template("page.html").render(
        results=results,
        images=images,
        effort=str(results[0].effort),
        passed=sum(result.passed for result in results),
        wall_time=sum(result.wall_time for result in results),
        version=version("grainlaw"),
    )


def significant(value: float | None, digits: int = 4) -> str:
    """A number for a table; nothing for None."""
    return "" if value is None else f"{value:.{digits}g}"


def _images(result: CaseResult) -> list[str]:
    evidence = result.evidence
    return [*map(figure_image, evidence.figures), *map(convergence_image, evidence.convergence)]
