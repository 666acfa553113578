"""Running an element test: set up the point, lead it along its path, keep some of its states."""

from collections.abc import Iterator
from typing import Any

from grainlaw.materials.element.path import LoadingPath
from grainlaw.materials.element.point import Point, point_at_rest
from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.element.settings import ElementTest
from grainlaw.materials.element.specimen import Specimen
from grainlaw.materials.tensor import isotropic

KEPT_STATES = 3000


def run_element_test(test: ElementTest, specimen: Specimen, settings: Any) -> ElementResult:
    """The history of one point of the specimen under the test.

    Raises InputError if the law does not compile and SimulationError, with the time and the strain reached, if a
    prescribed stress cannot be reached or stress or density are not finite.
    """
    path = test.path(settings)
    start = initial_point(specimen, settings)
    stride = -(-path.steps // KEPT_STATES)
    return ElementResult(
        specimen=specimen,
        test=test.name,
        settings=settings,
        steps=path.steps,
        points=(start, *_followed(specimen, path, start, stride)),
    )


def initial_point(specimen: Specimen, settings: Any) -> Point:
    """The point at rest under the isotropic initial pressure of the settings."""
    density = specimen.density(settings.initial_pressure, settings.density)
    stress = isotropic(-settings.initial_pressure)
    return point_at_rest(stress, density, specimen.law.initial_state(stress, density, specimen.parameters))


def _followed(specimen: Specimen, path: Any, start: Point, stride: int) -> Iterator[Point]:
    # Imported here, because each path needs only one of the compiler and the root finder.
    if isinstance(path, LoadingPath):
        from grainlaw.materials.element.driver import follow_path

        return follow_path(specimen, path, start, stride)
    from grainlaw.materials.element.stages import follow_stages

    return follow_stages(specimen, path, start, stride)
