"""Grains that have lost contact: the strain by which a point has opened is kept, and closes before stress comes back.

A law that lets opened material take up pressure as soon as it is compressed gains volume with every opening: a shaken
pile swells. Every law with an elastic pressure that can vanish therefore keeps `gap`, the volumetric strain since.
"""

from typing import NamedTuple

from grainlaw.materials.pointwise import pointwise
from grainlaw.materials.tensor import SymmetricTensor, scaled


class Contact(NamedTuple):
    """The part of a strain increment that is left once the gap has closed, and the gap that is left if it has not."""

    compression: float
    shear: SymmetricTensor
    gap: float


@pointwise
def after_closing(compression: float, shear: SymmetricTensor, gap: float) -> Contact:
    """A strain increment (volumetric, compression-positive, and deviatoric) after it has closed a gap as far as it can.

    While grains are apart they carry no shear either: the share of the increment that closes the gap is lost to both.
    """
    if gap <= 0.0:
        return Contact(compression, shear, 0.0)
    if compression <= gap:
        return Contact(0.0, scaled(shear, 0.0), gap - compression)
    return Contact(compression - gap, scaled(shear, (compression - gap) / compression), 0.0)
