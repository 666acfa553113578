"""Cylinders of material points, in axisymmetry and in 3D, observed as grains are; and as a scene of `validate dem`."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN
from grainlaw.validation.dem.judging.column import column_of, column_scene
from grainlaw.validation.grains.distance import profile_distance
from grainlaw.validation.grains.material_points import snapshot_of_bodies
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import observe
from grainlaw.validation.grains.run_observation import as_grains
from grainlaw.validation.reference.reference_set import Ensemble

RADIUS, HEIGHT, CELL, WIDTH = 0.12, 0.1, 0.01, 0.012
DENSITY, GRAIN_DENSITY, GRAVITY = 1500.0, 2500.0, 9.81
VOLUME = np.pi * RADIUS**2 * HEIGHT
MATERIAL = {
    "mu_i_lc": {
        "static_friction": 0.5,
        "dynamic_friction": 0.9,
        "inertial_number_constant": 0.3,
        "bulk_modulus": 4e5,
        "poisson_ratio": 0.2,
        "grain_density": GRAIN_DENSITY,
        "grain_diameter": WIDTH,
    }
}
RECTANGLE = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [RADIUS, HEIGHT]}


def cylinder(center: tuple[float, float]) -> dict[str, object]:
    return {"kind": "cylinder", "center": [*center, 0.0], "radius": RADIUS, "height": HEIGHT}


def scene_of(space: str, shape: dict[str, object], lower: list[float], upper: list[float], **more) -> Scene:
    content = {
        "space": space,
        "grid": {"cell_size": CELL, "lower": lower, "upper": upper},
        "time": {"end": 1.0},
        "material": MATERIAL,
        "body": [{"material": "mu_i_lc", "shape": shape, "density": DENSITY}],
    }
    return Scene.from_dict({**content, **more}, "cylinder")


def observed(space: str, shape, lower: list[float], upper: list[float], compared=AXISYMMETRIC, **more) -> Observation:
    """A scene at its start, observed as a cylinder, or as a plane column."""
    scene = scene_of(space, shape, lower, upper, **more)
    bodies = build_bodies(scene)
    snapshots = [snapshot_of_bodies(0.0, bodies, GRAIN_DENSITY)]
    setting, whole = as_grains(scene, bodies, snapshots, WIDTH, GRAIN_DENSITY, compared)
    return observe(whole, setting, {"label": space})


def observed_part(halved: tuple[bool, bool]) -> Observation:
    """The half or quarter of a cylinder in 3D that lies beyond planes of symmetry through its axis."""
    whole = scene_of("3d", cylinder((0.2, 0.25)), [0.0, 0.0, 0.0], [0.4, 0.5, 0.2])
    snapshot = snapshot_of_bodies(0.0, build_bodies(whole), GRAIN_DENSITY)
    lower = np.where([*halved, False], [0.2, 0.25, 0.0], 0.0)
    kept = (snapshot.positions > lower).all(axis=1)
    part = replace(
        snapshot,
        positions=snapshot.positions[kept],
        velocities=snapshot.velocities[kept],
        solid_volumes=snapshot.solid_volumes[kept],
        stress=None,
    )
    box = {"kind": "box", "lower": lower.tolist(), "upper": [0.4, 0.5, 0.1]}
    scene = scene_of("3d", box, lower.tolist(), [0.4, 0.5, 0.2])
    bodies = [SimpleNamespace(positions=part.positions.T)]
    setting, points = as_grains(scene, bodies, [part], WIDTH, GRAIN_DENSITY, AXISYMMETRIC)
    return observe(points, setting, {"label": "part"})


CYLINDERS = {
    "axisymmetric": lambda: observed("axisymmetric", RECTANGLE, [0.0, 0.0], [0.2, 0.2]),
    "whole": lambda: observed("3d", cylinder((0.2, 0.25)), [0.0, 0.0, 0.0], [0.4, 0.5, 0.2]),
    "half": lambda: observed_part((False, True)),
    "quarter": lambda: observed_part((True, True)),
}


@pytest.mark.parametrize("form", CYLINDERS)
def test_a_cylinder_of_points_is_the_same_in_axisymmetry_and_whole_half_and_quarter_in_3d(form):
    found = CYLINDERS[form]()
    assert found.space is AXISYMMETRIC
    assert found.description["bulk_solid_fraction"] == pytest.approx(DENSITY / GRAIN_DENSITY, rel=0.01)
    assert found.of("height")[0] == pytest.approx(HEIGHT, rel=0.02)
    assert found.of("runout")[0] == pytest.approx(RADIUS, abs=0.5 * CELL)
    assert found.of("center_of_mass_height")[0] == pytest.approx(HEIGHT / 2.0)
    assert found.of("radius_of_98_percent")[0] == pytest.approx(np.sqrt(0.98) * RADIUS, abs=0.3 * CELL)
    assert found.content(0) == pytest.approx(VOLUME, rel=0.04)
    energy = DENSITY * VOLUME * GRAVITY * HEIGHT / 2.0
    assert found.of("potential_energy")[0] == pytest.approx(energy, rel=0.01)
    assert profile_distance(found, CYLINDERS["axisymmetric"](), 0.0) < 0.02


def test_a_slab_in_3d_is_a_plane_column():
    plane = observed("plane_strain", RECTANGLE, [0.0, 0.0], [0.2, 0.2], compared=PLANE_STRAIN)
    box = {"kind": "box", "lower": [0.0, 0.0, 0.0], "upper": [RADIUS, 0.04, HEIGHT]}
    sides = {"front": "periodic", "back": "periodic"}
    slab = observed("3d", box, [0.0, 0.0, 0.0], [0.2, 0.04, 0.2], boundary=sides, compared=PLANE_STRAIN)
    assert slab.space is PLANE_STRAIN
    assert slab.surface[0] == pytest.approx(plane.surface[0], abs=1e-9)
    for name, values in plane.series.items():
        assert slab.of(name) == pytest.approx(values, rel=1e-9, abs=1e-12), name
    assert slab.snapshots["stress_zz"] == pytest.approx(plane.snapshots["stress_zz"])


def test_the_scene_of_a_cylinder_has_its_mass_and_its_radius():
    start = CYLINDERS["axisymmetric"]()
    described = {"half_width": RADIUS, "initial_height": HEIGHT, "gravity": GRAVITY, "grain_density": GRAIN_DENSITY}
    grains = replace(start, description=start.description | described, times=np.array([0.0, 0.1]))
    column = column_of(Ensemble("cylinder", (grains,)))
    scene = Scene.from_dict(column_scene(column, "mu_i_lc", MATERIAL["mu_i_lc"], CELL), "column")
    assert scene.in_space is AXISYMMETRIC
    (body,) = build_bodies(scene)
    assert 2.0 * np.pi * body.masses.sum() == pytest.approx(DENSITY * VOLUME, rel=0.01)
    assert body.positions[0].max() == pytest.approx(RADIUS - 0.25 * CELL)
