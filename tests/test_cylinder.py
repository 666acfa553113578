"""Cylinders of grains: what is averaged around an axis against cones whose profile is known, and their decks."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from grainlaw.materials import InputError
from grainlaw.validation.dem.batch import case_named
from grainlaw.validation.dem.collapse import floor_of, release_files
from grainlaw.validation.dem.geometry import geometry_of
from grainlaw.validation.dem.packing import Packing, random_radii
from grainlaw.validation.grains.coarse_graining import disc_lattice, kernel_of
from grainlaw.validation.grains.distance import compare, profile_distance
from grainlaw.validation.grains.observation import Observation, read_observation, write_observation
from grainlaw.validation.grains.observe import observe_folder
from grainlaw.validation.grains.reference_file import load_reference
from grainlaw.validation.grains.snapshot import Array

DENSITY, RADIUS, SPACING = 2450.0, 0.003, 0.0075
DIAMETER = 2.0 * RADIUS
SOLID_FRACTION = 4.0 / 3.0 * np.pi * RADIUS**3 / SPACING**3
CONE_RADIUS, CONE_HEIGHT = 0.3, 0.15
NAMES = ("id", "type", "x", "y", "z", "vx", "vy", "vz", "radius")


def cone(stretch: float = 1.0) -> Array:
    """Centres of grains on a regular lattice in a cone of the same volume, `stretch` times as wide."""
    radius, height = CONE_RADIUS * stretch, CONE_HEIGHT / stretch**2
    axes = [
        (np.arange(round(length / SPACING)) + 0.5) * SPACING - start
        for length, start in ((2 * radius, radius), (2 * radius, radius), (height, 0.0))
    ]
    x, y, z = (values.ravel() for values in np.meshgrid(*axes, indexing="ij"))
    inside = z < height * (1.0 - np.hypot(x, y) / radius)
    return np.column_stack([x, y, z])[inside]


def write_cone(folder: Path, centres: Array, **description: object) -> Path:
    """A folder with one frame of grains that move away from the axis at 2/s times their distance from it."""
    folder.mkdir()
    n = len(centres)
    velocity = 2.0 * (centres - centres.mean(axis=0)) * [1.0, 1.0, 0.0]
    rows = np.column_stack([np.arange(n), np.ones(n), centres, velocity, np.full(n, RADIUS)])
    np.savetxt(folder / "grains.csv", rows, fmt="%.9g", delimiter=",", header=",".join(NAMES), comments="")
    content = {"space": "axisymmetric", "grain_density": DENSITY, "solid_fraction": SOLID_FRACTION, **description}
    (folder / "run.json").write_text(json.dumps({**content, "frames": [{"file": "grains.csv", "time": 0.0}]}))
    return folder


@pytest.fixture(scope="module")
def observed(tmp_path_factory):
    """The cone around x = y = 0."""
    return observe_folder(write_cone(tmp_path_factory.mktemp("cone") / "run", cone(), axis=[0.0, 0.0]))


def test_a_cone_of_grains_gives_its_profile_runout_height_and_centre_of_mass(observed):
    r = observed.x
    # Not at the tip and the rim, which the kernel rounds over two widths, twice that along the slope.
    inside = (r > 4 * DIAMETER) & (r < CONE_RADIUS - 8 * DIAMETER)
    truth = CONE_HEIGHT * (1.0 - r / CONE_RADIUS)
    assert np.abs(observed.surface[0] - truth)[inside].max() < 0.5 * DIAMETER
    assert observed.of("runout")[0] == pytest.approx(CONE_RADIUS * (1.0 - DIAMETER / CONE_HEIGHT), abs=SPACING)
    assert observed.of("height")[0] == pytest.approx(CONE_HEIGHT, abs=1.5 * DIAMETER)
    assert observed.of("center_of_mass_height")[0] == pytest.approx(CONE_HEIGHT / 4.0, rel=0.02)
    assert observed.content(0) == pytest.approx(np.pi * CONE_RADIUS**2 * CONE_HEIGHT / 3.0, rel=0.03)
    assert observed.description["bulk_solid_fraction"] == pytest.approx(SOLID_FRACTION)
    assert observed.of("interior_solid_fraction")[0] == pytest.approx(SOLID_FRACTION, rel=0.01)


def test_the_radius_of_98_percent_is_that_of_the_cone(observed):
    # Of a cone 3 q^2 - 2 q^3 of the volume lies within q radii.
    shares = np.linspace(0.0, 1.0, 10001)
    within = np.interp(0.98, 3.0 * shares**2 - 2.0 * shares**3, shares)
    assert observed.of("radius_of_98_percent")[0] == pytest.approx(within * CONE_RADIUS, rel=0.01)


def test_velocity_across_is_away_from_the_axis_and_energy_that_of_the_whole_cone(observed):
    speed, phi = observed.snapshots["velocity_x"][0], observed.snapshots["solid_fraction"][0]
    full = phi > 0.9 * SOLID_FRACTION
    assert np.abs(speed - 2.0 * observed.x[:, None])[full].max() < 0.05
    # The volume times the mean of r^2, 3/10 of the squared radius of a cone.
    mass = DENSITY * SOLID_FRACTION * np.pi * CONE_RADIUS**2 * CONE_HEIGHT / 3.0
    kinetic = 0.5 * mass * 4.0 * 0.3 * CONE_RADIUS**2
    assert observed.of("kinetic_energy")[0] == pytest.approx(kinetic, rel=0.03)
    assert observed.unit_of("kinetic_energy") == "J"


def test_a_shifted_axis_is_found(observed, tmp_path):
    shifted = observe_folder(write_cone(tmp_path / "run", cone() + np.array((0.31, -0.22, 0.0))))
    assert shifted.surface[0] == pytest.approx(observed.surface[0], abs=1e-9)
    assert shifted.series.keys() == observed.series.keys()


@pytest.mark.parametrize(
    ("centres", "described", "message"),
    [
        (
            cone() + np.array((0.02, 0.0, 0.0)),
            {"axis": [0.0, 0.0]},
            r"axis = \[0\.0, 0\.0\], .* 0\.02 m beside it, at x = 0\.02",
        ),
        (cone()[cone()[:, 0] > 0.0], {}, "no cylinder, or not all of it"),
        (cone() * [1.0, 0.2, 1.0], {}, "no cylinder"),
        (cone(), {"space": "plane_strain"}, "'depth' is missing"),
        (cone(), {"space": "round"}, "allowed: 'plane_strain' or 'axisymmetric'"),
        (cone(), {"space": "plane_strain", "depth": 0.06}, "the grains span"),
    ],
)
def test_what_stands_around_no_such_axis_is_refused(tmp_path, centres, described, message):
    with pytest.raises(InputError, match=message) as caught:
        observe_folder(write_cone(tmp_path / "run", centres, **described))
    assert "\n" not in str(caught.value)


def test_grains_that_rolled_away_alone_change_neither_runout_nor_profile(observed, tmp_path):
    lone = np.array([[1.0, 0.0, RADIUS], [-1.0, 0.0, RADIUS], [0.0, 1.2, RADIUS], [0.0, -1.2, RADIUS]])
    found = observe_folder(write_cone(tmp_path / "run", np.concatenate([cone(), lone]), axis=[0.0, 0.0]))
    assert found.of("runout") == pytest.approx(observed.of("runout"), rel=1e-9)
    assert found.of("radius_of_98_percent") == pytest.approx(observed.of("radius_of_98_percent"), rel=2e-3)
    assert found.surface[0][: len(observed.x)] == pytest.approx(observed.surface[0], abs=1e-9)


def test_rings_keep_the_volume_and_do_not_thin_out_at_the_axis():
    lattice = disc_lattice(0.5, 0.0, 0.4)
    random = np.random.default_rng(1)
    radii, angles = 0.3 * np.sqrt(random.uniform(size=4000)), random.uniform(0.0, 2.0 * np.pi, 4000)
    positions = np.column_stack([radii * np.cos(angles), radii * np.sin(angles), random.uniform(0.0, 0.2, 4000)])
    volumes = random.uniform(1e-7, 2e-7, 4000)
    field = kernel_of(positions, lattice, 0.015).field(volumes)
    ring = 2.0 * np.pi * lattice.x * lattice.spacing**2
    assert ring @ field.sum(axis=1) == pytest.approx(volumes.sum(), rel=1e-3)
    # A point on the axis is a Gaussian in three dimensions.
    on_axis = kernel_of(np.array([[0.0, 0.0, 0.2]]), lattice, 0.015).field(np.ones(1))
    away = np.hypot(lattice.x[0], lattice.z[26] - 0.2)
    assert on_axis[0, 26] == pytest.approx(np.exp(-0.5 * (away / 0.015) ** 2) / (0.015 * np.sqrt(2.0 * np.pi)) ** 3)


def profile(height: Array, x: Array, **description: object) -> Observation:
    """An observation of a surface alone."""
    series = {"runout": np.array([0.2]), "height": height.max(keepdims=True)}
    return Observation(
        {"label": "one", "space": "axisymmetric", **description},
        np.zeros(1), x, np.zeros(0), height[None], series, np.zeros(0), {},
    )  # fmt: skip


def test_distance_counts_rings_by_their_radius():
    x = (np.arange(40) + 0.5) * 0.0075
    disc = np.where(x < 0.15, 0.1, 0.0)
    with_ring = disc + np.where(x > 0.225, 0.02, 0.0)
    apart = 0.02 * (0.3**2 - 0.225**2)
    mean = 0.1 * 0.15**2 + 0.5 * apart
    assert profile_distance(profile(disc, x), profile(with_ring, x), 0.0) == pytest.approx(apart / mean)


def test_cylinders_and_plane_columns_are_not_compared():
    x = (np.arange(40) + 0.5) * 0.0075
    disc = np.where(x < 0.15, 0.1, 0.0)
    with pytest.raises(InputError, match="one is a cylinder, slope a plane column"):
        compare(profile(disc, x), [profile(disc, x, space="plane_strain", label="slope")])


def test_a_cylinder_survives_its_file(observed, tmp_path):
    path = tmp_path / "cone.h5"
    write_observation(path, observed)
    read = read_observation(path)
    assert read.space is observed.space
    assert compare(read, [observed]).distances[0].distance < 1e-6
    with h5py.File(path, "r+") as file:
        file.attrs["description"] = json.dumps({**observed.description, "space": "3d"})
    with pytest.raises(InputError, match="its space is '3d'; allowed: plane_strain, axisymmetric"):
        read_observation(path)


def test_an_experiment_with_a_cylinder_is_a_table_of_radii(tmp_path):
    path = tmp_path / "experiment.csv"
    rows = "t,x,h\n1,0.05,0.1\n1,0.15,0.1\n1,0.3,0.0\n"
    path.write_text("# grain_diameter = 0.004\n# space = axisymmetric\n" + rows)
    found = load_reference(path)
    assert found.x[0] > 0.0
    assert found.surface[0][0] == pytest.approx(0.1)
    assert found.of("runout")[0] == pytest.approx(0.3 - 0.04 * 0.15, abs=1e-6)
    # A disc and a ring below a straight slope from its inner to its outer radius.
    inner, outer = 0.15, 0.3
    slope = 0.1 / (outer - inner) * (outer * (outer**2 - inner**2) - 2.0 / 3.0 * (outer**3 - inner**3)) * np.pi
    assert found.content(0) == pytest.approx(np.pi * inner**2 * 0.1 + slope, rel=2e-3)
    path.write_text("# grain_diameter = 0.004\n# space = round\n" + rows)
    with pytest.raises(InputError, match="space = round; allowed: plane_strain, axisymmetric"):
        load_reference(path)
    path.write_text("# grain_diameter = 0.004\n# space = axisymmetric\nt,x,h\n1,-0.1,0.1\n1,0.1,0.0\n")
    with pytest.raises(InputError, match="distance from it"):
        load_reference(path)


def test_the_deck_has_a_round_wall_and_open_ends():
    case = case_named("cylinder-a1-glued")
    random = np.random.default_rng(1)
    grains = geometry_of(case).loose_grains(random_radii(case.grains, 50, random), 0.01, 0.3, random)
    beyond = np.hypot(grains.centres[:, 0], grains.centres[:, 1]) + grains.radii
    assert beyond.max() < case.radius
    assert np.ptp(grains.centres[:, 2]) > 0.2
    deck = release_files(case, "liggghts", 1, grains)["deck.in"]
    wall = deck.index("zcylinder 0.225 0. 0.")
    assert "boundary f f f" in deck
    assert wall < deck.index("unfix wall1") < deck.index("reset_timestep 0")
    assert "xplane" not in deck
    assert "contacts" not in deck


def test_glued_grains_cover_the_round_floor_without_seams():
    case = case_named("cylinder-a1-glued")
    glued, plane = floor_of(case, 1)
    assert isinstance(glued, Packing)
    assert plane < glued.centres[:, 2].min()
    away = np.hypot(glued.centres[:, 0], glued.centres[:, 1])
    assert away.max() < case.reach
    covered = [float((glued.radii[ring] ** 2).sum() / (outer**2 - inner**2)) for inner, outer, ring in (
        (0.0, 0.4, away < 0.4), (0.4, case.reach, away >= 0.4)
    )]  # fmt: skip
    assert np.all((np.array(covered) > 0.50) & (np.array(covered) < 0.60))
    # Neighbours across the edges of the repeated square do not overlap.
    near = glued.chosen((np.abs(glued.centres[:, 0]) < 0.02) & (np.abs(glued.centres[:, 1]) < 0.2))
    gaps = np.linalg.norm(near.centres[:, None] - near.centres, axis=2) - near.radii[:, None] - near.radii
    assert gaps[~np.eye(len(near), dtype=bool)].min() >= -1e-12
