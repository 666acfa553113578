"""The mark of the core's compiled code: it changes whenever a file that kernels are made from changes."""

from pathlib import Path

from materials.compilation import mark_of_sources

KERNEL_FILES = (
    "basis",
    "blocks",
    "body_force",
    "boundary",
    "columns",
    "contact",
    "elastic_energy",
    "fields",
    "gather",
    "grid",
    "grid_to_points",
    "lane_arithmetic",
    "lanes",
    "law_at_points",
    "momentum",
    "parts",
    "places",
    "points_to_grid",
    "reach",
    "reports",
    "rows",
    "scatter",
    "side_by_side",
    "sleeping",
    "sorting",
    "stencils",
    "stress",
    "volumes",
)
CORE_MARK = mark_of_sources(Path(__file__).with_name(f"{name}.py") for name in KERNEL_FILES)
