"""With what cells, points and steps collapses of mu(I)-LC kept to an accuracy (docs/accuracy.md)."""

from grainlaw.materials import Resolution

MU_I_LC = {
    "10%": Resolution(8, 25, 0.4, cells_along=15, slenderness=3.0),
    "3%": Resolution(32, 25, 0.4, cells_along=68, slenderness=2.2),
}
