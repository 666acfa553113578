"""What MPM codes call the positions of their points, what a point holds, and the time; in small letters.

HydraxMPM `position_stack`; GeoTaichi `position`, `volume`, `mass`, `t_current`; Newton `particle_q`; Matter `x`, `y`,
`m`; CB-Geo `coord_x`, `mass`; ParaView `Points:0`.
"""

# Arrays of shape (n, 2) or (n, 3).
VECTORS = (
    "position",
    "positions",
    "position_stack",
    "particle_position",
    "pos",
    "points",
    "coord",
    "coords",
    "coordinates",
    "particle_q",
    "x",
    "xp",
)
# One column for each axis.
_STEMS = ("", "pos_", "position_", "coord_", "coords_", "coordinate_")
_FORMS = ("{0}:{1}", "{0}_{1}", "{0}[{1}]")
_LETTERED = tuple(tuple(f"{stem}{axis}" for axis in "xyz") for stem in _STEMS)
_NUMBERED = tuple(
    tuple(form.format(vector, axis) for axis in range(3)) for vector in VECTORS if len(vector) > 1 for form in _FORMS
)
COLUMNS = _LETTERED + _NUMBERED
# What a point is counted by, the first kind that is there: a mass stays, a volume swells.
AMOUNTS = (
    ("mass", "masses", "mass_stack", "particle_mass", "m"),
    ("initial_volume", "volume0", "volume_0", "volume0_stack", "vol0"),
    ("volume", "volumes", "volume_stack", "particle_volume", "vol"),
)
# Points that differ in one of these are not all alike.
UNLIKE = ("radius", "radii", "size", "level", "type", "material", "materialid", "material_id", "bodyid", "body_id")
TIMES = ("time", "t", "t_current", "timevalue", "current_time")

_KNOWN = {*VECTORS, *(name for columns in COLUMNS for name in columns), *(name for kind in AMOUNTS for name in kind)}
_KNOWN |= {*UNLIKE, *TIMES}


def is_known(name: str) -> bool:
    """Whether a name means something here."""
    return name.lower() in _KNOWN
