"""Random states and strains for the return maps of Cam Clay."""

import math

from grainlaw.materials import SymmetricTensor, half_norm


def random_deviator(rng, q):
    """A deviator of this q [Pa] in any direction."""
    direction = rng.normal(size=6)
    direction[:3] -= direction[:3].mean()
    s = SymmetricTensor(*direction)
    return q / (math.sqrt(3.0) * half_norm(s)) * s


def random_strain(rng, size):
    """A strain of about this size: its compression and its deviator."""
    strain = rng.normal(size=6) * size
    compression = -strain[:3].sum()
    strain[:3] -= strain[:3].mean()
    return compression, SymmetricTensor(*strain)
