"""The validation cases by name, in suites, each in the order in which it is run."""

from collections.abc import Sequence
from importlib import import_module

from grainlaw.materials.errors import InputError, nearest_name
from grainlaw.validation.case import Case

STANDARD = "standard"
# From one point to whole scenes.
SUITES: dict[str, tuple[str, ...]] = {
    STANDARD: (
        "simple_shear",
        "mcc_triaxial_drained",
        "mcc_triaxial_undrained",
        "mcc_one_dimensional_compression",
        "return_mapping",
        "mu_i_mcc_return",
        "mu_i_mcc_steady_shear",
        "mu_i_mcc_rate_jump",
        "mu_i_mcc_cam_clay_limit",
        "opening_and_closing",
        "rigid_rotation",
        "elastic_bar_vibration",
        "axis_aligned_solution",
        "generalised_vortex",
        "self_weight_column",
        "contact_gap",
        "sliding_block",
        "two_discs",
        "poiseuille",
        "bagnold_incline",
        "mirror_symmetry",
        "shifted_column",
        "heap_at_rest",
        "rest",
        "time_step_independence",
    ),
    # One scene for each granular law.
    "laws": ("collapse_of_every_law",),
    # What a user may do to it.
    "hard": (
        "overconsolidated_collapses",
        "stiffness_range",
        "regularisation_range",
        "grain_size_range",
        "points_per_cell",
        "floor_friction_range",
        "falling_block",
        "thrown_cloud",
        "slender_and_thin",
        "leaving_the_domain",
        "step_limit",
    ),
    # Collapses against finer grids, other frames and experiments.
    "collapses": (
        "grid_convergence",
        "runout_scaling",
        "aluminium_bars",
        "moving_frame",
        "turned_scene",
    ),
    # What accuracy costs.
    "speed": ("sleeping", "speed_error"),
}
NAMES = tuple(name for suite in SUITES.values() for name in suite)


def get_case(name: str) -> Case:
    """The case of that name, from its module; a hyphen may stand for an underscore.

    Raises InputError with the nearest valid name.
    """
    name = name.replace("-", "_")
    if name not in NAMES:
        raise InputError(f"unknown validation case or suite '{name}'; {nearest_name(name, [*NAMES, *SUITES])}")
    case: Case = import_module(f"grainlaw.validation.cases.{name}").CASE
    return case


def chosen_cases(names: Sequence[str]) -> list[Case]:
    """The cases of these names, a suite standing for its cases; without names, the standard suite."""
    chosen = [case for name in names or (STANDARD,) for case in SUITES.get(name, (name,))]
    return [get_case(name) for name in dict.fromkeys(chosen)]
