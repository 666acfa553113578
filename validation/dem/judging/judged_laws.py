"""The laws that are judged, one entry each; a law of a plugin joins by an entry of its own."""

from grainlaw.validation.dem.judging.fitted_laws import JudgedLaw
from grainlaw.validation.dem.judging.fitting_data import (
    COMPRESSION_FILE,
    CRITICAL_FLOW_FILE,
    CYCLE_FILE,
    FLOW_FILE,
    PEAK_FILE,
    SHEAR_FILE,
    SLOW_SHEAR_FILE,
    START_FILE,
)

GRAINS = {"grain_density": 2450.0, "grain_diameter": 0.015}
# Packings of spheres have ratios of 0.1 to 0.25; the collapse does not notice.
POISSON_RATIO = {"poisson_ratio": 0.2}
# With the compression the fit runs to lambda = kappa and a wrong M: the indices stay the paper's. With the start of
# shear it runs to a ratio of 13, whose surface no column of these sizes reaches: it stands.
CLAY = {"compression_index": 0.04, "swelling_index": 0.008, "overconsolidation_ratio": 1.0}

# The first one is that of a quick report.
JUDGED_LAWS = (
    JudgedLaw(
        law="mu_i_lc",
        title="mu(I)-LC",
        data=(SHEAR_FILE, COMPRESSION_FILE),
        given={**GRAINS, **POISSON_RATIO},
        limits="constant solid fraction: the packing can neither hold by dilating at the start nor swell",
    ),
    JudgedLaw(
        law="mu_i_phi_i",
        title="mu(I), phi(I)",
        data=(FLOW_FILE, START_FILE, COMPRESSION_FILE),
        # As loose as the fastest shear.
        given={**GRAINS, **POISSON_RATIO, "loosest_solid_fraction": 0.4},
        limits="one rate of dilation for all packings; no fabric, no collisions",
    ),
    JudgedLaw(
        law="mu_i_state",
        title="mu(I), state",
        data=(FLOW_FILE, PEAK_FILE, CYCLE_FILE),
        # As loose as the fastest shear; at rest, as the looser of the compressed packings; k hardly matters.
        given={
            **GRAINS,
            **POISSON_RATIO,
            "loosest_solid_fraction": 0.4,
            "resting_solid_fraction": 0.548,
            "settling_rate": 1.0,
        },
        limits="no fabric, no collisions; softening without a length",
    ),
    JudgedLaw(
        law="mu_i_elastoplastic",
        title="mu(I), elastoplastic",
        data=(SHEAR_FILE, COMPRESSION_FILE),
        given={**GRAINS, **POISSON_RATIO},
        limits="as mu(I)-LC: no dilatancy",
    ),
    JudgedLaw(
        law="drucker_prager",
        title="Drucker-Prager",
        data=(SLOW_SHEAR_FILE, COMPRESSION_FILE),
        given={**POISSON_RATIO, "dilatancy_angle": 0.0, "cohesion": 0.0},
        limits="no rate dependence, and a dilatancy that never ends or is not there",
    ),
    JudgedLaw(
        law="modified_cam_clay",
        title="Modified Cam Clay",
        data=(SLOW_SHEAR_FILE,),
        given={**POISSON_RATIO, **CLAY, "grain_density": 2450.0},
        limits="no rate dependence; isotropic hardening of a clay for grains that hardly compress",
    ),
    JudgedLaw(
        law="mu_i_mcc",
        title="mu(I)-MCC",
        data=(CRITICAL_FLOW_FILE,),
        given={**GRAINS, **POISSON_RATIO, **CLAY},
        limits="isotropic hardening of a clay for grains that hardly compress",
    ),
    JudgedLaw(
        law="mu_i_lc_viscous",
        title="mu(I)-LC, viscous",
        data=(SHEAR_FILE, COMPRESSION_FILE),
        given=GRAINS,
        limits="creeps: at rest its regularised viscosity still flows",
    ),
)
