"""JUnit XML of a validation run, as continuous integration reads it."""

from collections.abc import Sequence
from xml.etree import ElementTree

from grainlaw.validation.result import CaseResult


def junit(results: Sequence[CaseResult]) -> str:
    """One test suite; each case is a test case, and what left its band the failure's text."""
    failures = sum(not result.passed for result in results)
    suite = ElementTree.Element(
        "testsuite",
        name="grainlaw validate",
        tests=str(len(results)),
        failures=str(failures),
        errors="0",
        time=f"{sum(result.wall_time for result in results):.3f}",
    )
    for result in results:
        case = ElementTree.SubElement(
            suite, "testcase", classname="grainlaw.validate", name=result.case.name, time=f"{result.wall_time:.3f}"
        )
        if not result.passed:
            failure = ElementTree.SubElement(case, "failure", message=result.reasons[0])
            failure.text = "\n".join(result.reasons)
    ElementTree.indent(suite)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"
