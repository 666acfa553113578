"""What the space of a scene asks of its tables: numbers of components, shapes, points per cell; and its defaults."""

from collections.abc import Iterator, Mapping
from typing import Any, get_args, get_origin

from grainlaw.materials.faults import not_among
from grainlaw.mpm_core.scene.shapes import SHAPES
from grainlaw.mpm_core.space import PLANE_STRAIN, SPACES, Space

POINTS_PER_CELL = {2: (1, 4, 9, 16, 25, 36), 3: (1, 8, 27, 64)}
STANDARD_GRAVITY = 9.81


def fitted_to_space(content: Any) -> Any:
    """The tables of a scene, with the defaults of its space where it is not plane strain, whose the model has.

    Raises ValueError for a vector that has not as many components as the space has axes, and for shapes and points per
    cell of other spaces. What is not well-formed is left to the validation of the scene.
    """
    space = _space(content)
    if space is None:
        return content
    for key, value in _vectors(content):
        if isinstance(value, list | tuple) and len(value) != space.axes:
            names = ", ".join(space.axis_names)
            raise ValueError(f"{key} = {value!r:.60}: space = '{space.name}' takes {space.axes} components, {names}")
    for kind in ("body", "inflow"):
        for number, section in _sections(content, kind):
            _refuse_points(space, f"{kind}.{number}", section)
    for number, body in _sections(content, "body"):
        _refuse_shape(space, f"body.{number}", body)
    return content if space is PLANE_STRAIN else _with_defaults(content, space)


def _space(content: Any) -> Space | None:
    if not isinstance(content, Mapping):
        return None
    name = content.get("space", PLANE_STRAIN.name)
    return SPACES.get(name) if isinstance(name, str) else None


def _table(content: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    table = content.get(name)
    return table if isinstance(table, Mapping) else {}


def _sections(content: Mapping[str, Any], kind: str) -> Iterator[tuple[int, Mapping[str, Any]]]:
    sections = content.get(kind)
    for number, section in enumerate(sections if isinstance(sections, list | tuple) else ()):
        if isinstance(section, Mapping):
            yield number, section


def _vectors(content: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Keys and values of the vectors that are a scene's, whatever its shapes are."""
    yield "gravity", content.get("gravity")
    grid = _table(content, "grid")
    yield from ((f"grid.{name}", grid.get(name)) for name in ("lower", "upper"))
    for kind in ("body", "inflow"):
        yield from (
            (f"{kind}.{number}.velocity", section.get("velocity")) for number, section in _sections(content, kind)
        )


def _refuse_points(space: Space, key: str, section: Mapping[str, Any]) -> None:
    points = section.get("points_per_cell")
    allowed = POINTS_PER_CELL[space.axes]
    if type(points) is int and points not in allowed:
        *first, last = map(str, allowed)
        raise ValueError(f"{key}.points_per_cell = {points}: allowed: {', '.join(first)} or {last}")


def _refuse_shape(space: Space, key: str, body: Mapping[str, Any]) -> None:
    shape = _table(body, "shape")
    kind = shape.get("kind")
    if not isinstance(kind, str):
        return
    if kind not in SHAPES[space.axes]:
        known = ", ".join(f"'{name}'" for name in SHAPES[space.axes])
        raise ValueError(not_among(f"{key}.shape.kind", kind, f'{known} in space = "{space.name}"'))
    for name, field in SHAPES[space.axes][kind].model_fields.items():
        value, components = shape.get(name), get_args(field.annotation)
        is_vector = get_origin(field.annotation) is tuple
        if is_vector and isinstance(value, list | tuple) and len(value) != len(components):
            raise ValueError(f"{key}.shape.{name} = {value!r:.60}: takes {', '.join(space.axis_names)}")


def _with_defaults(content: Mapping[str, Any], space: Space) -> dict[str, Any]:
    nowhere = (0.0,) * space.axes
    filled = {"gravity": (*nowhere[:-1], -STANDARD_GRAVITY), **content}
    if isinstance(content.get("grid"), Mapping):
        filled["grid"] = {"lower": nowhere, **content["grid"]}
    if space.axes == 3 and isinstance(content.get("boundary", {}), Mapping):
        filled["boundary"] = {"front": "free_slip", "back": "free_slip", **content.get("boundary", {})}
    if isinstance(content.get("body"), list | tuple):
        defaults: dict[str, Any] = {"velocity": nowhere}
        if space.axes == 3:
            defaults["points_per_cell"] = 8
        filled["body"] = [
            {**defaults, **body, "initial_stress": _without_ratio(body)} if isinstance(body, Mapping) else body
            for body in content["body"]
        ]
    if space.axes == 3 and isinstance(content.get("inflow"), list | tuple):
        filled["inflow"] = [
            {"points_per_cell": 8, **inflow} if isinstance(inflow, Mapping) else inflow for inflow in content["inflow"]
        ]
    return filled


def _without_ratio(body: Mapping[str, Any]) -> Any:
    """The initial stress of a body that has no direction out of the plane."""
    stress = body.get("initial_stress", {})
    return {"out_of_plane_ratio": None, **stress} if isinstance(stress, Mapping) else stress
