"""Settings for a stated accuracy: cells, points, step, precision, transfer: a scene need not choose them.

`grainlaw validate speed_error` measured how runout, height of the pile and height of the centre of mass of column
collapses differ from their mean on finer grids, over cell size, step, transfer and shape functions. Here stands, for
each law and accuracy, a setting that kept to it with the finer grids that were tried, on columns on which it was chosen
as well as on one on which it was not, in single precision. Where no grid did, there is no entry: a scene that asks for
it is refused.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError

from grainlaw.mpm_core.scene.shapes import AnyShape

# How much finer than wanted cells may become to divide the domain.
FINEST_SHARE = 0.5
# Time constant of the transfer over the cell size [s/m] with which piles of mu(I)-LC converge, as long as its waves
# take to cross two or three cells, and squat ones of overconsolidated clay repeat.
SHORT_BLEND_TIME = 0.1
# What is left to a scene whose accuracy is refused.
INSTEAD = "state grid.cell_size and time.safety instead"


@dataclass(frozen=True)
class Preset:
    """What a scene is run with.

    cells_across     cells across the narrowest body, at least
    points_per_cell  material points per cell
    safety           fraction of the stable step
    cells_along      cells along the edge of a square as large as the smallest body, at least
    memory           `transfer.time_constant` over the cell size [s/m]; None for that of the scene
    slenderness      height over width of a body, at most
    """

    cells_across: int
    points_per_cell: int
    safety: float
    cells_along: int = 1
    memory: float | None = None
    slenderness: float = math.inf


PRESETS: dict[str, dict[str, Preset]] = {
    "mu_i_lc": {
        "10%": Preset(8, 25, 0.4, cells_along=15, memory=SHORT_BLEND_TIME),
        "3%": Preset(32, 25, 0.4, cells_along=68, memory=SHORT_BLEND_TIME),
        "1%": Preset(48, 25, 0.4, cells_along=96, memory=SHORT_BLEND_TIME),
    },
    "modified_cam_clay, overconsolidation_ratio 1": {
        "10%": Preset(48, 4, 0.4),
        # The runout of more slender columns scatters by more between grids however fine.
        "3%": Preset(64, 16, 0.4, cells_along=80, slenderness=1.5),
    },
    # More slender columns fall in one of two ways, and leave other piles.
    "modified_cam_clay, overconsolidation_ratio 4": {
        "10%": Preset(64, 25, 0.4, cells_along=80, memory=SHORT_BLEND_TIME, slenderness=1.5)
    },
}
ACCURACIES = ("10%", "3%", "1%")


def with_settings_for_accuracy(content: Any) -> Any:
    """The tables of a scene, with what it leaves open of the settings filled in where `accuracy` asks for it.

    Raises ValueError for an accuracy that was not reached with a law of the scene or with bodies as slender as these,
    where its cells would be finer than the grains, and where no cell size divides the domain. What is not well-formed
    is left to the validation of the scene.
    """
    if not isinstance(content, Mapping) or content.get("accuracy") not in ACCURACIES:
        return content
    grid, time = content.get("grid"), content.get("time")
    boxes, materials = _boxes(content.get("body")), _materials(content)
    if not isinstance(grid, Mapping) or not isinstance(time, Mapping) or not boxes or not materials:
        return content
    preset = _strictest(content["accuracy"], [_kind(*one) for one in materials.items()])
    _refuse_slender_bodies(content["accuracy"], boxes, preset)
    cell_size = grid.get("cell_size")
    if not cell_size:
        cell_size = _cell_size(grid, _largest_cell(boxes, preset))
        _refuse_cells_finer_than_grains(content["accuracy"], cell_size, materials.values())
    return {
        "precision": "single",
        **content,
        "grid": {**grid, "cell_size": cell_size},
        "time": {"safety": preset.safety, **time},
        "transfer": _with_memory(content.get("transfer", {}), preset, cell_size),
        "body": [_with_points(body, preset.points_per_cell) for body in content["body"]],
    }


def _materials(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The tables of the materials of a scene by name, as far as they are well-formed."""
    materials = content.get("material")
    found = materials.items() if isinstance(materials, Mapping) else ()
    return {name: table for name, table in found if isinstance(table, Mapping)}


def _kind(name: str, table: Mapping[str, Any]) -> str:
    """The name of a material's law, and of clay how it is consolidated.

    Overconsolidated clay softens as it fails, so that its runout depends on the cells in another way.
    """
    law, ratio = str(table.get("law", name)), table.get("overconsolidation_ratio")
    return f"{law}, overconsolidation_ratio {ratio:g}" if isinstance(ratio, int | float) else law


def _strictest(accuracy: str, kinds: Iterable[str]) -> Preset:
    """The preset that serves all materials."""
    presets = []
    for kind in kinds:
        reached = PRESETS.get(kind, {})
        if accuracy not in reached:
            allowed = f"allowed: {', '.join(reached)}" if reached else INSTEAD
            raise ValueError(f"accuracy = '{accuracy}' was not reached on any grid with {kind}; {allowed}")
        presets.append(reached[accuracy])
    return Preset(
        max(found.cells_across for found in presets),
        max(found.points_per_cell for found in presets),
        min(found.safety for found in presets),
        max(found.cells_along for found in presets),
        min((found.memory for found in presets if found.memory is not None), default=None),
        min(found.slenderness for found in presets),
    )


def _refuse_slender_bodies(accuracy: str, boxes: Iterable[tuple[float, float]], preset: Preset) -> None:
    """Bodies higher over their width than those with which the accuracy was reached."""
    slenderest = max(height / width for width, height in boxes)
    if slenderest > preset.slenderness * (1.0 + 1e-9):
        raise ValueError(
            f"accuracy = '{accuracy}' was reached with bodies of these materials up to {preset.slenderness:g} times as "
            f"high as wide, not {slenderest:.3g} times; {INSTEAD}"
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


def _with_memory(transfer: Any, preset: Preset, cell_size: Any) -> Any:
    """The table of the transfer, with a time constant that follows the cell size where the preset has one."""
    if preset.memory is None or not isinstance(transfer, Mapping) or not isinstance(cell_size, int | float):
        return transfer
    return {"time_constant": preset.memory * cell_size, **transfer}


def _with_points(body: Mapping[str, Any], points_per_cell: int) -> dict[str, Any]:
    """A table of a body, with so many points per cell where it does not state any."""
    return {**body, "points_per_cell": body.get("points_per_cell") or points_per_cell}


def _boxes(bodies: Any) -> list[tuple[float, float]]:
    """Width and height of the bodies' bounding boxes [m]; none if a shape is not well-formed."""
    try:
        shapes = [TypeAdapter(AnyShape).validate_python(body["shape"]) for body in bodies]
        corners = [shape.bounds() for shape in shapes]
        return [(float(upper[0] - lower[0]), float(upper[1] - lower[1])) for lower, upper in corners]
    except (ValidationError, KeyError, TypeError, ValueError):
        return []


def _largest_cell(boxes: Iterable[tuple[float, float]], preset: Preset) -> float:
    """The cell size [m] that has all bodies resolved."""
    return min(min(min(box) / preset.cells_across, math.sqrt(math.prod(box)) / preset.cells_along) for box in boxes)


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
