"""The laws that are judged, one entry each; a law of a plugin joins by an entry of its own."""

from validation.dem_report.fitted_laws import JudgedLaw
from validation.dem_report.fitting_data import (
    COMPRESSION_FILE,
    SHEAR_FILE,
    SLOW_SHEAR_FILE,
)

GRAINS = {"grain_density": 2450.0, "grain_diameter": 0.015}
# Packings of spheres have ratios of 0.1 to 0.25; the collapse does not notice.
POISSON_RATIO = {"poisson_ratio": 0.2}

JUDGED_LAWS = (
    JudgedLaw(
        law="mu_i_lc",
        title="mu(I)-LC",
        data=(SHEAR_FILE, COMPRESSION_FILE),
        given={**GRAINS, **POISSON_RATIO},
        limits="constant solid fraction: the packing can neither hold by dilating at the start nor swell",
    ),
    JudgedLaw(
        law="mu_i_lc_viscous",
        title="mu(I)-LC, viscous",
        data=(SHEAR_FILE, COMPRESSION_FILE),
        given=GRAINS,
        limits="creeps: at rest its regularised viscosity still flows",
    ),
    JudgedLaw(
        law="modified_cam_clay",
        title="Modified Cam Clay",
        # Together with the compression the fit runs to lambda = kappa and a wrong M; the indices stay the paper's.
        data=(SLOW_SHEAR_FILE,),
        given={**POISSON_RATIO, "grain_density": 2450.0, "overconsolidation_ratio": 1.0},
        limits="no rate dependence; isotropic hardening of a clay for grains that hardly compress",
    ),
)
