"""Settings for a stated accuracy: cells, points, step, precision, transfer: a scene need not choose them.

A law states with what resolution it kept to an accuracy (`Law.resolutions`): by how much runout, height of the pile and
height of the centre of mass of column collapses differ from finer grids, in single precision (docs/accuracy.md). Where
a law states none, a scene that asks for it is refused.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError

from grainlaw.materials import InputError, Resolution, get_material
from grainlaw.mpm_core.scene.shapes import AnyShape
from grainlaw.mpm_core.space import PLANE_STRAIN

# How much finer than wanted cells may become to divide the domain.
FINEST_SHARE = 0.5
# What is left to a scene whose accuracy is refused.
INSTEAD = "state grid.cell_size and time.safety instead"


ACCURACIES = ("10%", "3%", "1%")


def with_settings_for_accuracy(content: Any) -> Any:
    """The tables of a scene, with what it leaves open of the settings filled in where `accuracy` asks for it.

    Raises ValueError in another space than plane strain, for a law or its parameters that are wrong, for an accuracy
    that no measurement confirms with a law of the scene or with bodies as slender as these, where its cells would be
    finer than the grains, and where no cell size divides the domain. What is not well-formed is left to the validation
    of the scene.
    """
    if not isinstance(content, Mapping) or content.get("accuracy") not in ACCURACIES:
        return content
    if content.get("space", PLANE_STRAIN.name) != PLANE_STRAIN.name:
        raise ValueError(
            f"accuracy = '{content['accuracy']}' was measured in plane strain, in no other space; {INSTEAD}"
        )
    if content.get("inflow"):
        raise ValueError(f"accuracy = '{content['accuracy']}' was measured without an inflow; {INSTEAD}")
    grid, time = content.get("grid"), content.get("time")
    boxes, materials = _boxes(content.get("body"), grid), _materials(content)
    if not isinstance(grid, Mapping) or not isinstance(time, Mapping) or not boxes or not materials:
        return content
    stated = {name: _resolutions(name, table) for name, table in materials.items()}
    resolution = _strictest(content["accuracy"], stated)
    _refuse_slender_bodies(content["accuracy"], boxes, resolution)
    cell_size = grid.get("cell_size")
    if not cell_size:
        cell_size = _cell_size(grid, _largest_cell(boxes, resolution))
        _refuse_cells_finer_than_grains(content["accuracy"], cell_size, materials.values())
    return {
        "precision": "single",
        **content,
        "grid": {**grid, "cell_size": cell_size},
        "time": {"safety": resolution.safety, **time},
        "body": [_with_points(body, resolution.points_per_cell) for body in content["body"]],
    }


def _materials(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The tables of the materials of a scene by name, as far as they are well-formed."""
    materials = content.get("material")
    found = materials.items() if isinstance(materials, Mapping) else ()
    return {name: table for name, table in found if isinstance(table, Mapping)}


def _resolutions(name: str, table: Mapping[str, Any]) -> Mapping[str, Resolution]:
    """What the law of a material states for its parameters. Raises ValueError for what is wrong with either."""
    where = f"material.{name}"
    try:
        law = get_material(str(table.get("law", name)))
    except InputError as error:
        raise ValueError(f"{where}: {error}") from None
    try:
        return law.resolutions(law.checked({key: value for key, value in table.items() if key != "law"}, where))
    except InputError as error:
        raise ValueError(str(error)) from None


def _strictest(accuracy: str, stated: Mapping[str, Mapping[str, Resolution]]) -> Resolution:
    """The resolution that serves all materials."""
    chosen = []
    for material, reached in stated.items():
        if accuracy not in reached:
            allowed = f"allowed: {', '.join(reached)}" if reached else INSTEAD
            raise ValueError(
                f"accuracy = '{accuracy}' is confirmed by no measurement with material.{material} and its parameters; "
                f"{allowed}"
            )
        chosen.append(reached[accuracy])
    return Resolution(
        max(found.cells_across for found in chosen),
        max(found.points_per_cell for found in chosen),
        min(found.safety for found in chosen),
        max(found.cells_along for found in chosen),
        min(found.slenderness for found in chosen),
    )


def _refuse_slender_bodies(accuracy: str, boxes: Iterable[tuple[float, float]], resolution: Resolution) -> None:
    """Bodies higher over their width than those with which the accuracy was measured."""
    slenderest = max(height / width for width, height in boxes)
    if slenderest > resolution.slenderness * (1.0 + 1e-9):
        raise ValueError(
            f"accuracy = '{accuracy}' was measured with bodies of these materials up to {resolution.slenderness:g} "
            f"times as high as wide, not {slenderest:.3g} times; {INSTEAD}"
        )


def _refuse_cells_finer_than_grains(accuracy: str, cell_size: float, materials: Iterable[Mapping[str, Any]]) -> None:
    """Bodies so few grains wide were not tried."""
    diameters = [table.get("grain_diameter") for table in materials]
    largest = max((float(found) for found in diameters if isinstance(found, int | float)), default=0.0)
    if cell_size < largest * (1.0 - 1e-9):
        raise ValueError(
            f"accuracy = '{accuracy}' takes cells of {cell_size:.3g} m, finer than the grains of "
            f"{largest:g} m, with which it was not tried; {INSTEAD}"
        )


def _with_points(body: Mapping[str, Any], points_per_cell: int) -> dict[str, Any]:
    """A table of a body, with so many points per cell where it does not state any."""
    return {**body, "points_per_cell": body.get("points_per_cell") or points_per_cell}


def _boxes(bodies: Any, grid: Any) -> list[tuple[float, float]]:
    """Width and height of the bodies' bounding boxes [m]; none if a shape is not well-formed."""
    try:
        return [_box(body, grid) for body in bodies]
    except (ValidationError, AttributeError, KeyError, TypeError, ValueError):
        return []


def _box(body: Mapping[str, Any], grid: Any) -> tuple[float, float]:
    lower, upper = TypeAdapter(AnyShape).validate_python(body["shape"]).bounds()
    if body.get("clip") is True:
        lower = tuple(map(max, lower, grid.get("lower", (0.0, 0.0))))
        upper = tuple(map(min, upper, grid["upper"]))
    return float(upper[0] - lower[0]), float(upper[1] - lower[1])


def _largest_cell(boxes: Iterable[tuple[float, float]], resolution: Resolution) -> float:
    """The cell size [m] that has all bodies resolved."""
    return min(
        min(min(box) / resolution.cells_across, math.sqrt(math.prod(box)) / resolution.cells_along) for box in boxes
    )


def _cell_size(grid: Mapping[str, Any], largest: float) -> float:
    """The largest cell size [m] up to `largest` of which both edges of the domain are whole multiples."""
    lower, upper = grid.get("lower", (0.0, 0.0)), grid["upper"]
    across, up = (float(upper[axis] - lower[axis]) for axis in (0, 1))
    fewest = math.ceil(across / largest * (1.0 - 1e-9))
    for count in range(fewest, math.floor(fewest / FINEST_SHARE) + 1):
        rows = up * count / across
        if abs(rows - round(rows)) < 1e-9 * rows and round(rows) > 0:
            return across / count
    raise ValueError(
        f"accuracy: no cells between {FINEST_SHARE * largest:g} and {largest:g} m divide the domain of {across:g} m "
        f"by {up:g} m; change grid.upper or state grid.cell_size"
    )
