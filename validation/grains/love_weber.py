"""Stress of grains from the forces between them.

sigma(x) = 1/depth sum_c f_c (x) l_c int_0^1 W(x - x_c + s l_c) ds, with the force f_c on a grain at x_c and the branch
l_c to its centre from that of the other (Love 1927; Weber 1966; spread along the branch: Goldhirsch 2010, Granular
Matter 12: 239). It balances gravity exactly. The integral is a sum over the points of a Gauss rule; what lies below the
floor is left out. Compression-positive; the momentum of fluctuations is not in it (10 % at I = 1, nothing at rest).
"""

import numpy as np

from grainlaw.validation.grains.snapshot import Array, StressMoments

PIECES = 5


def stress_of_contacts(first: Array, second: Array, force: Array, depth: float, floor: float) -> StressMoments:
    """The stress times volume of each piece of each branch.

    first, second  centres (n, 3) [m]; force: on the first (n, 3) [N]; depth: period along y [m]; floor: its level [m]
    """
    branch = first - second
    branch[:, 1] -= depth * np.round(branch[:, 1] / depth)
    # Grains push: a force that points the other way was told of the other grain.
    force = force * np.where((force * branch).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
    moments = np.column_stack(
        [
            force[:, 0] * branch[:, 0],
            force[:, 2] * branch[:, 2],
            0.5 * (force[:, 0] * branch[:, 2] + force[:, 2] * branch[:, 0]),
        ]
    )
    places, weights = np.polynomial.legendre.leggauss(PIECES)
    positions = (first[:, None, :] - 0.5 * (1.0 + places)[None, :, None] * branch[:, None, :]).reshape(-1, 3)
    values = (0.5 * weights[None, :, None] * moments[:, None, :]).reshape(-1, 3)
    above = positions[:, 2] >= floor
    return StressMoments(positions[above], values[above])
