"""Compression tests, axis yy: isotropic, oedometer, triaxial (drained and undrained) and biaxial (plane strain)."""

from grainlaw.materials.element.path import LoadingPath, constant_rate
from grainlaw.materials.element.settings import ElementTest, StrainedSettings
from grainlaw.materials.tensor import SymmetricTensor, isotropic

AXIAL = SymmetricTensor(0.0, -1.0, 0.0, 0.0, 0.0, 0.0)
RADIAL = SymmetricTensor(1.0, 0.0, 1.0, 0.0, 0.0, 0.0)
RADIAL_MEAN = SymmetricTensor(0.5, 0.0, 0.5, 0.0, 0.0, 0.0)
LATERAL = SymmetricTensor(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ISOCHORIC = SymmetricTensor(0.5, -1.0, 0.5, 0.0, 0.0, 0.0)


def strained(settings: StrainedSettings, direction: SymmetricTensor) -> LoadingPath:
    """A path on which every component of the strain rate is prescribed."""
    rates = constant_rate(settings.final_strain, settings.strain_rate, settings.time_step)
    return LoadingPath(settings.time_step, rates, direction)


def axial_with_held_stress(
    settings: StrainedSettings, free: SymmetricTensor, held: SymmetricTensor, held_name: str
) -> LoadingPath:
    """Axial compression with one lateral stress held at the initial pressure."""
    rates = constant_rate(settings.final_strain, settings.strain_rate, settings.time_step)
    return LoadingPath(settings.time_step, rates, AXIAL, free, held, -settings.initial_pressure, held_name)


def isotropic_compression(settings: StrainedSettings) -> LoadingPath:
    """Equal compression along the three axes; the driven component is the volumetric strain."""
    return strained(settings, isotropic(-1.0 / 3.0))


def oedometer(settings: StrainedSettings) -> LoadingPath:
    """Axial compression without lateral strain."""
    return strained(settings, AXIAL)


def triaxial_undrained(settings: StrainedSettings) -> LoadingPath:
    """Axial compression at constant volume."""
    return strained(settings, ISOCHORIC)


def triaxial_drained(settings: StrainedSettings) -> LoadingPath:
    """Axial compression at constant radial stress."""
    return axial_with_held_stress(settings, RADIAL, RADIAL_MEAN, "radial stress")


def biaxial(settings: StrainedSettings) -> LoadingPath:
    """Axial compression in plane strain (no strain along zz) at constant lateral stress xx."""
    return axial_with_held_stress(settings, LATERAL, LATERAL, "lateral stress")


COMPRESSION_TESTS = (
    ElementTest("isotropic", "isotropic compression", StrainedSettings, isotropic_compression),
    ElementTest("oedometer", "axial compression without lateral strain", StrainedSettings, oedometer),
    ElementTest("triaxial-drained", "axial compression at constant radial stress", StrainedSettings, triaxial_drained),
    ElementTest("triaxial-undrained", "axial compression at constant volume", StrainedSettings, triaxial_undrained),
    ElementTest("biaxial", "plane-strain compression at constant lateral stress", StrainedSettings, biaxial),
)
