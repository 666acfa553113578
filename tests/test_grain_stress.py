"""Stress of grains and of points through one coarse graining, against exact values."""

import json

import numpy as np
import pytest

from grainlaw.materials import InputError
from grainlaw.validation.grains.coarse_graining import column_lattice, stress
from grainlaw.validation.grains.love_weber import stress_of_contacts
from grainlaw.validation.grains.observation import read_observation, write_observation
from grainlaw.validation.grains.observe import observe_folder
from grainlaw.validation.grains.readers.contacts import NAMES, read_contacts
from grainlaw.validation.grains.snapshot import StressMoments

DIAMETER, DEPTH, COUNT = 0.015, 0.06, 80
GRAVITY, DENSITY = 9.81, 2450.0
MASS = DENSITY * np.pi / 6.0 * DIAMETER**3


def stack():
    """Contacts of spheres on top of one another: centres above and below, and the force on the upper of the two."""
    centres = np.column_stack([np.zeros(COUNT), np.full(COUNT, 0.03), (np.arange(COUNT) + 0.5) * DIAMETER])
    above = np.arange(COUNT - 1, 0, -1) * MASS * GRAVITY
    return centres[1:], centres[:-1], np.column_stack([np.zeros((COUNT - 1, 2)), above])


def test_two_spheres_pressed_together_carry_force_times_distance():
    first, second = np.array([[0.0, 0.0, 0.1]]), np.array([[0.01, 0.0, 0.11]])
    force = np.array([[-3.0, 0.0, -3.0]])
    lattice = column_lattice(0.0, 0.3, 0.0, 0.3)
    fields = stress(stress_of_contacts(first, second, force, DEPTH, 0.0), lattice, DIAMETER, DEPTH)
    totals = [field.sum() * lattice.spacing**2 * DEPTH for field in fields]
    # f (x) l, half of the couple for each of the shear stresses.
    assert totals == pytest.approx([0.03, 0.03, 0.03], rel=1e-4)


def test_stress_of_a_stack_of_spheres_is_the_weight_above():
    lattice = column_lattice(0.0, 0.3, 0.0, COUNT * DIAMETER)
    _, zz, xz = stress(stress_of_contacts(*stack(), DEPTH, 0.0), lattice, DIAMETER, DEPTH)
    carried = zz.sum(axis=0) * lattice.spacing * DEPTH
    weight = MASS * GRAVITY * (COUNT - lattice.z / DIAMETER)
    inside = (lattice.z > 6 * DIAMETER) & (lattice.z < (COUNT - 6) * DIAMETER)
    assert carried[inside] == pytest.approx(weight[inside], rel=1e-3)
    assert np.abs(xz).max() < 1e-9 * zz.max()


def test_points_and_contacts_of_one_column_have_one_stress():
    """Material points at rest under their weight, through the same kernel as the stack of spheres."""
    lattice = column_lattice(0.0, 0.3, 0.0, COUNT * DIAMETER)
    heights = (np.arange(4 * COUNT) + 0.5) * DIAMETER / 4.0
    positions = np.column_stack([np.zeros((4 * COUNT, 2)), heights])
    carried = MASS * GRAVITY * (COUNT - heights / DIAMETER) * DIAMETER / 4.0
    points = StressMoments(positions, np.column_stack([0.0 * carried, carried, 0.0 * carried]))
    _, of_points, _ = stress(points, lattice, DIAMETER, DEPTH)
    _, of_contacts, _ = stress(stress_of_contacts(*stack(), DEPTH, 0.0), lattice, DIAMETER, DEPTH)
    inside = (lattice.z > 6 * DIAMETER) & (lattice.z < (COUNT - 6) * DIAMETER)
    assert of_contacts[:, inside] == pytest.approx(of_points[:, inside], rel=1e-3, abs=1e-6 * of_points.max())


def test_a_contact_across_the_period_is_short_and_the_sign_of_the_force_does_not_matter():
    first, second = np.array([[0.0, 0.001, 0.1]]), np.array([[0.0, 0.059, 0.1]])
    force = np.array([[0.0, 2.0, 0.0]])
    one, other = (stress_of_contacts(first, second, sign * force, DEPTH, 0.0) for sign in (1.0, -1.0))
    assert one.values == pytest.approx(0.0)
    assert one.values == pytest.approx(other.values)
    assert np.ptp(one.positions[:, 1]) < 0.002


@pytest.mark.parametrize("code", ["liggghts", "yade"])
def test_a_run_with_contacts_is_observed_with_its_stress(tmp_path, code):
    write_stack(tmp_path, code)
    observed = observe_folder(tmp_path)
    write_observation(tmp_path / "o.h5", observed)
    found = read_observation(tmp_path / "o.h5")
    carried = found.snapshots["stress_zz"][0].sum(axis=0) * (found.x[1] - found.x[0]) * DEPTH
    inside = (found.z > 6 * DIAMETER) & (found.z < (COUNT - 6) * DIAMETER)
    weight = MASS * GRAVITY * (COUNT - found.z / DIAMETER)
    assert carried[inside] == pytest.approx(weight[inside], rel=2e-3)


def test_faulty_contacts_are_refused_in_one_line(tmp_path):
    write_stack(tmp_path, "liggghts")
    path = tmp_path / "contacts.txt"
    whole = path.read_text()
    path.write_text(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="truncated"):
        read_contacts(path)
    path.write_text(whole.replace(" c_c[12]", ""))
    with pytest.raises(InputError, match="columns"):
        read_contacts(path)
    path.unlink()
    with pytest.raises(InputError, match="names it as a file of contacts"):
        observe_folder(tmp_path)


def write_stack(folder, code):
    upper, lower, force = stack()
    centres = np.vstack([lower[:1], upper])
    # A second grain beside the first, so that the grains span the depth.
    centres = np.vstack([centres, [0.0, 0.0, 0.5 * DIAMETER]])
    grains = np.column_stack([centres, np.full(len(centres), 0.5 * DIAMETER)])
    contacts = np.column_stack([upper, lower, np.zeros((len(upper), 3)), force])
    if code == "liggghts":
        bounds = "ITEM: BOX BOUNDS ff pp ff\n-1 1\n0 0.06\n0 2\n"
        header = f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{len(grains)}\n{bounds}ITEM: ATOMS x y z radius"
        columns = " ".join(f"c_c[{number}]" for number in range(1, 13))
        other = f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n{len(contacts)}\n{bounds}ITEM: ENTRIES {columns}"
    else:
        header, other = "# x y z radius", f"# {' '.join(NAMES)}"
    np.savetxt(folder / "grains.txt", grains, fmt="%.9g", header=header, comments="")
    np.savetxt(folder / "contacts.txt", contacts, fmt="%.9g", header=other, comments="")
    frames = [{"file": "grains.txt", "contacts": "contacts.txt", "time": 0.0}]
    description = {"depth": DEPTH, "grain_density": DENSITY, "frames": frames}
    (folder / "run.json").write_text(json.dumps(description))
