"""Compression and swelling indices of Cam Clay in the two planes in which they are measured."""


def own_index(index_in_e_ln_p: float, void_ratio: float) -> float:
    """A slope (lambda or kappa) for this library in ln v - ln p, from one in e - ln p at a void ratio e.

    With v = 1 + e, d(ln v) = de/(1 + e): the slope in e - ln p over 1 + e. Straight lines of one plane are curved in
    the other, so take e where the material will be. C_c and C_s, per decade of pressure, are ln(10) = 2.303 times the
    slopes in e - ln p.
    """
    return index_in_e_ln_p / (1.0 + void_ratio)
