"""Parameters that are each within bounds but contradict one another are refused by name."""

import pytest

from materials import InputError, get_material

CASES = [
    ("drucker_prager", {"dilatancy_angle": 1.0}, "dilatancy_angle = 1 must not be larger than friction_angle"),
    ("modified_cam_clay", {"compression_index": 0.008}, "compression_index = 0.008 must be larger than swelling_index"),
    ("mu_i_lc", {"dynamic_friction": 0.5}, "dynamic_friction = 0.5 must not be smaller than static_friction"),
    ("mu_i_lc_viscous", {"dynamic_friction": 0.5}, "dynamic_friction = 0.5 must not be smaller than static_friction"),
]


@pytest.mark.parametrize(("name", "changes", "reason"), CASES)
def test_contradicting_parameters_are_refused(name, changes, reason):
    law = get_material(name)
    values = law.parameter_sets["paper"].parameters._asdict()
    assert law.checked(values, "here") == law.parameter_sets["paper"].parameters
    with pytest.raises(InputError, match=f"^here: {reason}"):
        law.checked(values | changes, "here")
