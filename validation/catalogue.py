"""The validation cases by name, in suites, each in the order in which it is run."""

from collections.abc import Sequence
from importlib import import_module

from grainlaw.materials.errors import InputError, nearest_name
from grainlaw.validation.case import Case

STANDARD = "standard"
# Where each case is: the room and the module of its name, or room, module and the name of a row of its table.
_PLACES: dict[str, tuple[str, ...]] = {
    # From one point to whole scenes.
    STANDARD: (
        "point.simple_shear",
        "point.mcc_triaxial_drained",
        "point.mcc_triaxial_undrained",
        "point.mcc_one_dimensional_compression",
        "point.return_mapping",
        "point.mu_i_mcc_return",
        "point.mu_i_mcc_steady_shear",
        "point.mu_i_mcc_rate_jump",
        "point.mu_i_mcc_cam_clay_limit",
        "point.opening_and_closing",
        "exact.rigid_rotation",
        "exact.elastic_bar_vibration",
        "exact.axis_aligned_solution",
        "exact.generalised_vortex",
        "exact.self_weight_column",
        "exact.contact_gap",
        "exact.sliding_block",
        "exact.two_discs",
        "exact.poiseuille",
        "exact.bagnold_incline",
        "collapses.invariances.mirror_symmetry",
        "collapses.invariances.shifted_column",
        "exact.heap_at_rest",
        "collapses.rest",
        "collapses.invariances.time_step_independence",
    ),
    # Axisymmetry and three dimensions, and the same problem in several spaces.
    "spaces": (
        "spaces.radial_expansion",
        "spaces.self_weight",
        "spaces.turned_block",
        "spaces.vibrations",
        "spaces.oblique_slide",
        "spaces.driven_cylinder",
        "spaces.driven_cube",
        "spaces.pipe_flow",
        "spaces.two_spheres",
        "spaces.slab",
        "spaces.cylinder",
        "spaces.every_law",
    ),
    # One scene for each granular law.
    "laws": ("collapses.collapse_of_every_law",),
    # What a user may do to it.
    "hard": (
        "hard.ranges.overconsolidated_collapses",
        "hard.ranges.stiffness_range",
        "hard.ranges.regularisation_range",
        "hard.ranges.grain_size_range",
        "hard.ranges.points_per_cell",
        "hard.ranges.floor_friction_range",
        "hard.falling_block",
        "hard.thrown_cloud",
        "hard.slender_and_thin",
        "hard.leaving_the_domain",
        "hard.step_limit",
    ),
    # Collapses against finer grids, other frames and experiments.
    "collapses": (
        "collapses.grid_convergence",
        "collapses.runout_scaling",
        "collapses.cylinder_scaling",
        "collapses.aluminium_bars",
        "collapses.invariances.moving_frame",
        "collapses.invariances.turned_scene",
    ),
    # Obstacles and what flows past them.
    "obstacles": (
        "obstacles.turned_plane",
        "obstacles.oblique_plane",
        "obstacles.earth_pressure",
        "obstacles.intruder_depth",
        "obstacles.janssen",
        "obstacles.turned_column",
        "obstacles.hopper_discharge",
        "obstacles.hopper_discharge_3d",
        "obstacles.hopper_grains",
        "obstacles.drum_grains",
    ),
    # The piles of other MPM codes on the paper's column.
    "mpm": (
        "mpm.piles.hydrax_mu_i_lc",
        "mpm.piles.hydrax_cam_clay",
        "mpm.piles.matter_cam_clay",
        "mpm.piles.geotaichi_cam_clay",
        "mpm.piles.newton_drucker_prager",
    ),
    # What accuracy costs.
    "speed": ("speed.sleeping", "speed.speed_error"),
}
SUITES = {suite: tuple(place.rpartition(".")[2] for place in places) for suite, places in _PLACES.items()}
NAMES = tuple(name for suite in SUITES.values() for name in suite)


def get_case(name: str) -> Case:
    """The case of that name, from its module; a hyphen may stand for an underscore.

    Raises InputError with the nearest valid name.
    """
    name = name.replace("-", "_")
    if name not in NAMES:
        raise InputError(f"unknown validation case or suite '{name}'; {nearest_name(name, [*NAMES, *SUITES])}")
    place = next(place for places in _PLACES.values() for place in places if place.endswith(f".{name}"))
    room, module, *row = place.split(".")
    found = import_module(f"grainlaw.validation.cases.{room}.{module}")
    case: Case = found.CASES[name] if row else found.CASE
    return case


def chosen_cases(names: Sequence[str]) -> list[Case]:
    """The cases of these names, a suite standing for its cases; without names, the standard suite."""
    chosen = [case for name in names or (STANDARD,) for case in SUITES.get(name, (name,))]
    return [get_case(name) for name in dict.fromkeys(chosen)]
