"""Material points as grains: each a grain whose volume of solid is its mass over the grain density.

In plane strain a point has one metre of depth, in axisymmetry it is a ring all around the axis; its plane (x, y) is the
(x, z) of the grains.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import Space
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, StressMoments

DEPTH = 1.0
# Rows of a body's stress that are xx, zz, xz of the grains, by the number of axes.
STRESSES = {2: [0, 1, 3], 3: [0, 2, 5]}


def snapshot_of_bodies(time: float, bodies: Sequence[Body], density: float) -> GrainSnapshot:
    """The points of all bodies at a time [s]; `density` of the grains [kg/m3]."""
    space = bodies[0].space
    positions = _in_3d(np.concatenate([body.positions for body in bodies], axis=1))
    velocity = _in_3d(np.concatenate([body.velocity for body in bodies], axis=1))
    volumes = _whole(space) * np.concatenate([body.volume for body in bodies])
    stress = np.concatenate([body.stress[STRESSES[space.axes]] for body in bodies], axis=1)
    moments = StressMoments(positions, -(stress * volumes).T)
    return GrainSnapshot(time, positions, velocity, _solid_volumes(bodies, density), moments)


def filled_space(bodies: Sequence[Body]) -> GrainSnapshot:
    """The points of all bodies at the start, each a grain as large as the space that it fills."""
    found = snapshot_of_bodies(0.0, bodies, 1.0)
    return replace(found, solid_volumes=_whole(bodies[0].space) * np.concatenate([body.volume for body in bodies]))


def snapshots_of_run(run: RunFolder, scene: Scene, density: float) -> Iterator[GrainSnapshot]:
    """The frames of a run's folder; `density` of the grains [kg/m3]. Raises InputError if they hold no velocity."""
    # Frames list the points in the order of generation, as freshly built bodies do.
    volumes = _solid_volumes(build_bodies(scene), density)
    for number in range(len(run.frame_files)):
        frame = run.load_frame(number)
        if len(frame.positions) != len(volumes):
            raise InputError(
                f"{run.path}: frame {number} holds {len(frame.positions)} points, the scene {len(volumes)}"
            )
        axes = scene.in_space.axes
        positions, velocity = frame.positions[:, :axes].T, frame.field("velocity").values[:, :axes].T
        yield GrainSnapshot(frame.time, _in_3d(positions), _in_3d(velocity), volumes)


def mirrored(snapshot: GrainSnapshot, plane: float = 0.0) -> GrainSnapshot:
    """The whole column from its half beyond x = plane [m]."""
    reflection = np.array([-1.0, 1.0, 1.0])
    offset = np.array([2.0 * plane, 0.0, 0.0])
    return GrainSnapshot(
        snapshot.time,
        np.concatenate([offset + snapshot.positions * reflection, snapshot.positions]),
        np.concatenate([snapshot.velocities * reflection, snapshot.velocities]),
        np.concatenate([snapshot.solid_volumes, snapshot.solid_volumes]),
        None if snapshot.stress is None else _mirrored_stress(snapshot.stress, offset, reflection),
    )


def _mirrored_stress(stress: StressMoments, offset: Array, reflection: Array) -> StressMoments:
    """Both halves; the shear stress changes its sign."""
    return StressMoments(
        np.concatenate([offset + stress.positions * reflection, stress.positions]),
        np.concatenate([stress.values * [1.0, 1.0, -1.0], stress.values]),
    )


def grain_density(bodies: Sequence[Body], otherwise: float | None = None) -> float:
    """The one grain density of all bodies [kg/m3], or another value for laws that declare none.

    Raises InputError if there is none, or several.
    """
    found = {getattr(body.parameters, "grain_density", otherwise) for body in bodies}
    if len(found) > 1 or None in found:
        laws = ", ".join(body.law.name for body in bodies)
        raise InputError(f"laws {laws}: grains and points compare by solid fraction, which needs one grain_density")
    return float(found.pop() or 0.0)


def grain_diameter(bodies: Sequence[Body]) -> float | None:
    """The one grain diameter of all bodies [m]; None where a law declares none, or they differ."""
    found = {getattr(body.parameters, "grain_diameter", None) for body in bodies}
    return found.pop() if len(found) == 1 else None


def _solid_volumes(bodies: Sequence[Body], density: float) -> Array:
    return _whole(bodies[0].space) * np.concatenate([body.masses / density for body in bodies])


def _whole(space: Space) -> float:
    """Radians around the axis; in the other spaces 1."""
    return 2.0 * np.pi if space.hoop else 1.0


def _in_3d(rows: Array) -> Array:
    """Each point's (x, y, z), shape (n, 3), from rows of them; rows (x, y) of a plane are (x, 0, z)."""
    if len(rows) == 3:
        return rows.T
    return np.column_stack([rows[0], np.zeros(rows.shape[1]), rows[1]])
