"""Grains that have lost contact: the strain by which a point has opened is kept, and closes before stress comes back.

A law that lets opened material take up pressure as soon as it is compressed gains volume with every opening: a shaken
pile swells. Every law with an elastic pressure that can vanish therefore keeps `opening_strain`, the volumetric strain
beyond the state in which contact was lost.
"""

from typing import NamedTuple

from grainlaw.materials.pointwise import pointwise
from grainlaw.materials.tensor import SymmetricTensor, isotropic


class StrainInContact(NamedTuple):
    """The part of a strain increment that grains in contact bear, and the opening strain that is left."""

    compression: float
    shear: SymmetricTensor
    opening_strain: float


@pointwise
def strain_in_contact(compression: float, shear: SymmetricTensor, opening_strain: float) -> StrainInContact:
    """What is left of a strain increment (volumetric, compression-positive, and deviatoric) once the point has closed.

    While grains are apart they carry no shear either: the share of the increment that closes the point is lost to both.
    """
    if opening_strain <= 0.0:
        return StrainInContact(compression, shear, 0.0)
    if compression <= opening_strain:
        return StrainInContact(0.0, isotropic(0.0), opening_strain - compression)
    closed = compression - opening_strain
    return StrainInContact(closed, closed / compression * shear, 0.0)
