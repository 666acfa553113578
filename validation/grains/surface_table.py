"""A surface over time, or a deposit, as CSV: the least that an experiment tells.

    # grain_diameter = 0.003
    t,x,h
    0.0,-0.1,0.0
    0.0,0.0,0.1

Without the line of the grain diameter [m] it is that of the run's law. With a line `# space = axisymmetric` the column
is a cylinder and x the distance from its axis.
t in seconds since the release, x from the axis of the column and the height h in metres; rows in any order.
"""

import re
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.space import PLANE_STRAIN, Space
from grainlaw.validation.grains.coarse_graining import SPACING
from grainlaw.validation.grains.observation import SPACES, Observation
from grainlaw.validation.grains.readers.columns import parsed_columns
from grainlaw.validation.grains.readers.text_file import read_text
from grainlaw.validation.grains.snapshot import Array
from grainlaw.validation.grains.surface import fronts

COLUMNS = ("t", "x", "h")
# Larger lengths than this are taken for millimetres.
LARGEST_LENGTH = 100.0
_DIAMETER = re.compile(r"#\s*grain_diameter\s*=\s*(\S+)\s*")
_SPACE = re.compile(r"#\s*space\s*=\s*(.*?)\s*")


def is_surface_table(path: Path) -> bool:
    """Whether a file is text whose first line that is no comment names t, x and h."""
    try:
        lines = read_text(path)
    except InputError:
        return False
    header = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    return set(COLUMNS) <= {name.strip() for name in header.split(",")}


def read_surface_table(path: Path, grain_diameter: float | None = None) -> Observation:
    """Surface, runout and height of such a file; `grain_diameter` [m] is taken if the file names none.

    Raises InputError in one line for whatever is wrong in it.
    """
    lines = read_text(path)
    comments = [line for line in lines if line.startswith("#")]
    rows = [line for line in lines if line.strip() and not line.startswith("#")]
    names = [name.strip() for name in rows[0].split(",")]
    values = parsed_columns(path, names, rows[1:], len(comments) + 2, ",", needed=set(COLUMNS))
    t, x, h = (values[name] for name in COLUMNS)
    if len(t) == 0:
        raise InputError(f"{path}: no rows follow its header")
    if not all(np.isfinite(column).all() for column in (t, x, h)):
        raise InputError(f"{path}: values that are no finite numbers")
    if max(np.abs(x).max(), h.max()) > LARGEST_LENGTH:
        raise InputError(f"{path}: lengths up to {np.abs(x).max():g} m; is the file in millimetres?")
    diameter = _diameter(path, comments, grain_diameter)
    space = _space(path, comments)
    if space.hoop and x.min() < 0.0:
        raise InputError(f"{path}: x down to {x.min():g} m; around an axis x is the distance from it, >= 0")
    times = np.unique(t)
    cells = int(np.ceil(np.abs(x).max() / SPACING)) + 1
    lattice = (np.arange(0 if space.hoop else -cells, cells) + 0.5) * SPACING
    surface = np.array([_surface(lattice, x[t == time], h[t == time], space) for time in times])
    left, right = np.array([fronts(lattice, one, diameter) for one in surface]).T
    return Observation(
        description={"label": path.stem, "kernel_width": diameter, "space": space.name},
        times=times,
        x=lattice,
        z=np.zeros(0),
        surface=surface,
        series={"runout": right if space.hoop else 0.5 * (right - left), "height": surface.max(axis=1)},
        snapshot_times=np.zeros(0),
        snapshots={},
    )


def _surface(lattice: Array, x: Array, h: Array, space: Space) -> Array:
    """On the lattice; nothing beyond the ends, but within the innermost ring the surface goes on to the axis."""
    order = np.argsort(x)
    return np.interp(lattice, x[order], h[order], left=None if space.hoop else 0.0, right=0.0)


def _space(path: Path, comments: list[str]) -> Space:
    for line in comments:
        if found := _SPACE.fullmatch(line):
            if found[1] not in SPACES:
                raise InputError(f"{path}: space = {found[1]}; allowed: {', '.join(SPACES)}")
            return SPACES[found[1]]
    return PLANE_STRAIN


def _diameter(path: Path, comments: list[str], otherwise: float | None) -> float:
    for line in comments:
        if found := _DIAMETER.fullmatch(line):
            try:
                return float(found[1])
            except ValueError:
                raise InputError(f"{path}: grain_diameter '{found[1]}' is not a number") from None
    if otherwise is not None:
        return otherwise
    raise InputError(f"{path}: a line '# grain_diameter = ...' [m] before the header is missing")
