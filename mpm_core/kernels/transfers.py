"""The transfers between points and grid that a space has."""

from collections.abc import Callable
from typing import Any, NamedTuple

from grainlaw.mpm_core.kernels.bulk_3d import make_g2p_of_bulk, make_p2g_of_bulk
from grainlaw.mpm_core.kernels.g2p import make_g2p
from grainlaw.mpm_core.kernels.g2p_3d import make_g2p_3d
from grainlaw.mpm_core.kernels.p2g import make_p2g
from grainlaw.mpm_core.kernels.p2g_3d import make_p2g_3d
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.space import Space


class Transfers(NamedTuple):
    """Kernels of one space, basis and precision.

    In two axes nodes hold volumes and pressures: P2G always brings them, and `coupling_g2p` returns them. In three they
    stand in an array of their own, with transfers of their own for the steps that couple volumes.
    """

    p2g: Callable[..., Any]
    g2p: Callable[..., Any]
    coupling_g2p: Callable[..., Any]
    p2g_of_bulk: Callable[..., Any] | None
    g2p_of_bulk: Callable[..., Any] | None


def transfers(space: Space, basis: Basis, couples: bool, precision: str) -> Transfers:
    """The transfers of a body; it `couples` the volumes of its points if it is loose."""
    if space.axes == 3:
        p2g, g2p = make_p2g_3d(basis, precision), make_g2p_3d(basis, precision)
        return Transfers(
            p2g, g2p, g2p, make_p2g_of_bulk(basis, precision), make_g2p_of_bulk(basis, precision) if couples else None
        )
    p2g, g2p = make_p2g(space, basis, precision), make_g2p(space, basis, False, precision)
    return Transfers(p2g, g2p, make_g2p(space, basis, couples, precision), None, None)
