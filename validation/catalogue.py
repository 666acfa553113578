"""The validation cases by name, in the order in which they are run: from one point to whole scenes."""

from collections.abc import Sequence
from importlib import import_module

from materials.errors import InputError, nearest_name
from validation.case import Case

NAMES = (
    "simple_shear",
    "mcc_triaxial_drained",
    "mcc_triaxial_undrained",
    "mcc_one_dimensional_compression",
    "return_mapping",
    "opening_and_closing",
    "rigid_rotation",
    "elastic_bar_vibration",
    "self_weight_column",
    "sliding_block",
    "two_discs",
    "bagnold_incline",
    "mirror_symmetry",
    "shifted_column",
    "rest",
    "time_step_independence",
)
# Too long for a run of all cases.
ON_REQUEST = ("speed_error",)


def get_case(name: str) -> Case:
    """The case of that name, from its module; a hyphen may stand for an underscore.

    Raises InputError with the nearest valid name.
    """
    name = name.replace("-", "_")
    if name not in NAMES + ON_REQUEST:
        raise InputError(f"unknown validation case '{name}'; {nearest_name(name, NAMES + ON_REQUEST)}")
    case: Case = import_module(f"validation.cases.{name}").CASE
    return case


def chosen_cases(names: Sequence[str]) -> list[Case]:
    """The cases of these names, or all of them."""
    return [get_case(name) for name in names or NAMES]
