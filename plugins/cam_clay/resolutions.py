"""With what cells, points and steps collapses of Cam Clay kept to an accuracy (`grainlaw validate speed_error`).

Overconsolidated clay softens as it fails, so that its runout depends on the cells in another way.
"""

from grainlaw.materials import Resolution

# By overconsolidation ratio.
MODIFIED_CAM_CLAY = {
    1.0: {
        "10%": Resolution(48, 4, 0.4),
        # The runout of more slender columns scatters by more between grids however fine.
        "3%": Resolution(64, 16, 0.4, cells_along=80, slenderness=1.5),
    },
    # More slender columns fall in one of two ways, and leave other piles.
    4.0: {
        "10%": Resolution(64, 25, 0.4, cells_along=80, slenderness=1.5),
    },
}
