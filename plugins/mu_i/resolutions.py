"""With what cells, points and steps collapses of mu(I)-LC kept to an accuracy (`grainlaw validate speed_error`).

Waves cross two or three cells in the FLIP blend time with which piles converge.
"""

from grainlaw.materials import Resolution

BLEND_TIME_PER_CELL = 0.1

MU_I_LC = {
    "10%": Resolution(8, 25, 0.4, cells_along=15, blend_time_per_cell=BLEND_TIME_PER_CELL),
    "3%": Resolution(32, 25, 0.4, cells_along=68, blend_time_per_cell=BLEND_TIME_PER_CELL),
    "1%": Resolution(48, 25, 0.4, cells_along=96, blend_time_per_cell=BLEND_TIME_PER_CELL),
}
