"""The fields of a frame: each declared once, computed only when a scene asks for it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, StateVariable, SymmetricTensor
from grainlaw.materials.errors import nearest_name
from grainlaw.materials.law import Law
from grainlaw.materials.tensor import deviatoric_stress, pressure
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.invariants import over_stress
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.scene.model import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FieldDeclaration:
    """Name, SI unit, doc, and how to compute the field of a body; `needs` names a parameter that a law must have."""

    name: str
    unit: str
    doc: str
    compute: Callable[[Body], Array]
    needs: str = ""


def _stress_invariant(function: Callable[[SymmetricTensor], float]) -> Callable[[Body], Array]:
    def compute(body: Body) -> Array:
        values = np.empty(body.count)
        over_stress(body.space, function)(body.points, values)
        return values

    return compute


def _stress_component(name: str) -> Callable[[Body], Array]:
    """A component of the stress; zero where the space does not have it."""

    def compute(body: Body) -> Array:
        names = body.layout.stress_names
        return body.stress[names.index(name)] if name in names else np.zeros(body.count)

    return compute


def _velocity(body: Body) -> Array:
    return _in_3d(body.velocity)


def _in_3d(components: Array) -> Array:
    """Vectors as ParaView takes them, shape (n, 3); the third component is zero where the space has two axes."""
    return np.pad(components.T, ((0, 0), (0, 3 - len(components))))


def _solid_fraction(body: Body) -> Array:
    return np.asarray(body.density / body.parameters.grain_density)


def _volumetric_strain_rate(body: Body) -> Array:
    return -body.volumetric_rate


FIELDS = {
    field.name: field
    for field in (
        FieldDeclaration("velocity", "m/s", "velocity; in axisymmetry along the radius and upwards", _velocity),
        FieldDeclaration("pressure", "Pa", "p = -tr(sigma)/3, compression-positive", _stress_invariant(pressure)),
        FieldDeclaration("deviatoric_stress", "Pa", "q = sqrt(3/2 s:s)", _stress_invariant(deviatoric_stress)),
        FieldDeclaration(
            "shear_strain",
            "1",
            "accumulated shear strain, integral of sqrt(1/2 D_d:D_d) dt",
            lambda body: body.shear_strain,
        ),
        FieldDeclaration("density", "kg/m3", "bulk density", lambda body: body.density),
        FieldDeclaration("solid_fraction", "1", "bulk density over grain density", _solid_fraction, "grain_density"),
        FieldDeclaration("volumetric_strain_rate", "1/s", "-tr(D), compression-positive", _volumetric_strain_rate),
        FieldDeclaration("stress_xx", "Pa", "sigma_xx, tension-positive", _stress_component("xx")),
        FieldDeclaration("stress_yy", "Pa", "sigma_yy, tension-positive", _stress_component("yy")),
        FieldDeclaration(
            "stress_zz",
            "Pa",
            "sigma_zz, tension-positive; in axisymmetry the hoop stress, around the axis",
            _stress_component("zz"),
        ),
        FieldDeclaration("stress_xy", "Pa", "sigma_xy", _stress_component("xy")),
        FieldDeclaration("stress_yz", "Pa", "sigma_yz; zero but in 3D", _stress_component("yz")),
        FieldDeclaration("stress_xz", "Pa", "sigma_xz; zero but in 3D", _stress_component("xz")),
    )
}
BODY_FIELD = "body"
_DEFAULTS = ("velocity", "pressure", "deviatoric_stress", "shear_strain", "solid_fraction")


def chosen_fields(scene: Scene) -> list[str]:
    """The names of the fields to write: those that a scene asks for, and what its pictures show.

    Raises InputError for a name that neither the core nor any law knows.
    """
    laws = [scene.law(material) for material in scene.materials]
    output = scene.output
    names = _defaults(laws) if output.fields is None else list(output.fields)
    for name in names:
        _refuse_unknown("output.fields", name, laws)
    if output.picture_field is not None:
        _refuse_unknown("output.picture_field", output.picture_field, laws)
        names.append(output.picture_field)
    if len(set(scene.materials)) > 1:
        names.append(BODY_FIELD)
    return list(dict.fromkeys(names))


def _defaults(laws: Sequence[Law]) -> list[str]:
    available = [name for name in _DEFAULTS if _is_available(name, laws)]
    return available + [name for name, declared in _states(laws).items() if declared.output]


def _states(laws: Sequence[Law]) -> dict[str, StateVariable]:
    return {name: declared for law in laws for name, declared in law.state_declarations.items()}


def _refuse_unknown(key: str, name: str, laws: Sequence[Law]) -> None:
    if name in FIELDS and not _is_available(name, laws):
        raise InputError(f"{key}: '{name}' needs a law with the parameter '{FIELDS[name].needs}'")
    valid = [*(known for known in FIELDS if _is_available(known, laws)), *_states(laws), BODY_FIELD]
    if name not in valid:
        close = nearest_name(name, valid)
        listed = f" allowed: {', '.join(valid)}" if close.startswith("did") else ""
        raise InputError(f"{key}: unknown field '{name}'; {close}{listed}")


def _is_available(name: str, laws: Sequence[Law]) -> bool:
    needed = FIELDS[name].needs
    return not needed or all(needed in law.parameters._fields for law in laws)


def make_frame(time: float, step: int, bodies: Sequence[Body], names: Sequence[str]) -> Frame:
    """A frame of all bodies, in the order in which their points were generated."""
    order = np.argsort(np.concatenate([body.ids for body in bodies]))
    positions = np.concatenate([_in_3d(body.positions) for body in bodies])
    fields = tuple(_frame_field(name, bodies, order) for name in names)
    return Frame(time, step, positions[order], fields)


def _frame_field(name: str, bodies: Sequence[Body], order: NDArray[np.int64]) -> Field:
    if name == BODY_FIELD:
        numbers = [np.full(body.count, float(number)) for number, body in enumerate(bodies)]
        return Field(name, "1", "number of the body in the scene", np.concatenate(numbers)[order])
    if name in FIELDS:
        declared = FIELDS[name]
        values = np.concatenate([declared.compute(body) for body in bodies])
        return Field(name, declared.unit, declared.doc, values[order])
    declarations = [body.law.state_declarations.get(name) for body in bodies]
    found = next(declaration for declaration in declarations if declaration is not None)
    parts = [
        body.state(name) if declaration is not None else np.zeros(body.count)
        for body, declaration in zip(bodies, declarations, strict=True)
    ]
    return Field(name, found.unit, found.doc, np.concatenate(parts)[order])
