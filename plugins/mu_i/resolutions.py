"""With what cells, points and steps collapses of mu(I)-LC kept to an accuracy (`grainlaw validate speed_error`)."""

from grainlaw.materials import Resolution

MU_I_LC = {
    "10%": Resolution(8, 25, 0.4, cells_along=15),
    "3%": Resolution(32, 25, 0.4, cells_along=68),
    "1%": Resolution(48, 25, 0.4, cells_along=96),
}
