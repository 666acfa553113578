"""Parameters that are each within bounds but contradict one another are refused by name."""

import pytest

from grainlaw.materials import InputError, get_material

CASES = [
    ("drucker_prager", {"dilatancy_angle": 1.0}, "dilatancy_angle = 1 must not be larger than friction_angle"),
    ("modified_cam_clay", {"compression_index": 0.008}, "compression_index = 0.008 must be larger than swelling_index"),
    ("mu_i_lc", {"dynamic_friction": 0.5}, "dynamic_friction = 0.5 must not be smaller than static_friction"),
    (
        "mu_i_elastoplastic",
        {"dynamic_friction": 0.5},
        "dynamic_friction = 0.5 must not be smaller than static_friction",
    ),
    ("mu_i_mcc", {"compression_index": 0.008}, "compression_index = 0.008 must be larger than swelling_index"),
    ("mu_i_mcc", {"dynamic_state_ratio": 1.0}, "dynamic_state_ratio = 1 must not be smaller than critical_state_ratio"),
    ("mu_i_phi_i", {"dynamic_friction": 0.5}, "dynamic_friction = 0.5 must not be smaller than static_friction"),
    ("mu_i_phi_i", {"loosest_solid_fraction": 0.6}, "loosest_solid_fraction = 0.6 must not be larger than critical"),
    ("mu_i_lc_viscous", {"dynamic_friction": 0.5}, "dynamic_friction = 0.5 must not be smaller than static_friction"),
]


@pytest.mark.parametrize(("name", "changes", "reason"), CASES)
def test_contradicting_parameters_are_refused(name, changes, reason):
    law = get_material(name)
    values = law.parameter_sets["paper"].parameters._asdict()
    assert law.checked(values, "here") == law.parameter_sets["paper"].parameters
    with pytest.raises(InputError, match=f"^here: {reason}"):
        law.checked(values | changes, "here")
