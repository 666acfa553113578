"""Every shipped law in every space: its checks, its element tests, a box that rests and a column that falls apart."""

import math
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from grainlaw.materials import InputError, SimulationError, get_material, registry
from grainlaw.materials.conformance.subject import Subject
from grainlaw.materials.conformance.suite import QUICK, examine
from grainlaw.materials.element.catalogue import ELEMENT_TESTS
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.output.observables import shape_of
from grainlaw.mpm_core.space import SPACES, Space
from grainlaw.validation.box import CELLS, LARGEST_CHANGE, SIDE, box, height_change
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.hard.step_limit import recklessly
from grainlaw.validation.cases.hard.survival import Lead, Trial, in_stable_steps, survival, trial
from grainlaw.validation.scenes import simulation_of

# In cells of the box.
DOMAIN_WIDTH = 15
FLOOR_FRICTION = 0.5
# The strain is the default one, in fewer steps.
ELEMENT_STEPS = {"constant-pressure-shear": 1e-4}
ELEMENT_STEP = 1e-2
LAWS = {Effort.QUICK: ("mu_i_lc",), Effort.FULL: tuple(sorted(registry().laws))}


def subject_of(law: str) -> Subject:
    """The law with its set `paper`, or else its first."""
    sets = get_material(law).parameter_sets
    return Subject(get_material(law), "paper" if "paper" in sets else next(iter(sets)), QUICK)


def failed_checks(law: str) -> int:
    """How many checks of `grainlaw check` fail, without that of the box at the ends of the bounds."""
    return sum(outcome.verdict == "FAIL" for _, outcome in examine(get_material(law), QUICK))


def failed_element_tests(law: str) -> int:
    """How many element tests stop or return what is not finite."""
    failed = 0
    for name, test in ELEMENT_TESTS.items():
        try:
            step = ELEMENT_STEPS.get(name, ELEMENT_STEP)
            result = run_element_test(test, *prepared(law, None, {"time_step": step}, test))
        except (InputError, SimulationError, ArithmeticError):
            failed += 1
        else:
            failed += not np.isfinite(result.stress).all()
    return failed


def column(subject: Subject, space: Space) -> dict[str, Any]:
    """The box of the law without the walls around it, on a rough floor, for the time of a free fall from its top."""
    scene = box(subject, subject.parameters, space)
    gravity = -scene["gravity"][-1]
    upper = [DOMAIN_WIDTH * SIDE / CELLS] * (space.axes - 1)
    return {
        **scene,
        "grid": {**scene["grid"], "upper": [*upper, scene["grid"]["upper"][-1]]},
        "boundary": {"bottom": {"kind": "friction", "coefficient": FLOOR_FRICTION}},
        "time": {"end": math.sqrt(2.0 * SIDE / gravity)},
    }


def collapsed(subject: Subject, space: Space, lead: Lead = in_stable_steps) -> tuple[Trial, float]:
    """The column of a law, and the fall of its centre of mass over its height at the start."""
    scene = column(subject, space)
    simulation = simulation_of(scene)
    before = shape_of(simulation).center_of_mass_height
    found = trial(simulation, scene["time"]["end"], lead)
    return found, 1.0 - found.shape.center_of_mass_height / before


HEADINGS = (
    "law",
    "checks failed",
    "element tests failed",
    "space",
    "box: change of height",
    "column: fallen",
    "energy made",
)


def measured(law: str) -> tuple[list[Measurement], list[tuple[str, ...]]]:
    """All of one law, and its rows of the table, one for each space."""
    subject, checks, tests = subject_of(law), failed_checks(law), failed_element_tests(law)
    found = [
        upper_bound(f"{law}: checks that fail", "1", checks, 0.0),
        upper_bound(f"{law}: element tests that fail", "1", tests, 0.0),
    ]
    rows: list[tuple[str, ...]] = []
    for space in SPACES.values():
        change = height_change(subject, subject.parameters, space)
        collapse, fallen = collapsed(subject, space)
        found.append(upper_bound(f"{law}, {space.name}: change of height of a box", "1", change, LARGEST_CHANGE))
        found += survival(f"{law}, {space.name}", collapse)
        way = f"{fallen:.1%}" if collapse.missing == 0.0 else f"{fallen:.1%}, then stops"
        rows.append((law, f"{checks}", f"{tests}", space.name, f"{abs(change):.1e}", way, f"{collapse.created:.1e}"))
    return found, rows


def table(rows: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """The lines of a table whose columns are as wide as what stands in them."""
    widths = [max(map(len, column)) for column in zip(HEADINGS, *rows, strict=True)]
    padded = [[cell.ljust(width) for cell, width in zip(row, widths, strict=True)] for row in (HEADINGS, *rows)]
    heading, *body = (f"| {' | '.join(row)} |" for row in padded)
    return heading, f"| {' | '.join('-' * width for width in widths)} |", *body


def measure(effort: Effort) -> Evidence:
    """Every law; at quick effort one."""
    found, rows = [], []
    with warnings.catch_warnings():
        # The uppermost points of Cam Clay start with little pressure, as in any geostatic scene.
        warnings.simplefilter("ignore", InputWarning)
        for law in LAWS[effort]:
            of_law, of_spaces = measured(law)
            found += of_law
            rows += of_spaces
    return Evidence(tuple(found), notes=table(rows))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Columns in steps that a run would refuse."""
    law = LAWS[Effort.QUICK][0]
    return tuple(
        found
        for space in SPACES.values()
        for found in survival(f"{law}, {space.name}", collapsed(subject_of(law), space, recklessly)[0])
    )


CASE = Case(
    name="every_law",
    title="every shipped law in every space",
    proves="no law is tied to one space: checks, element tests, a box at rest and a column that falls apart",
    reference="no check and no element test fails; a box of the law keeps its height; a column reaches its end with "
    "finite values and creates no energy",
    norm="counts; change of height; energy created over energy released",
    mistake="steps ten times the stable one, past the refusal",
    measure=measure,
    control=control,
)
