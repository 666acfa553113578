"""From grains, or material points, to an observation."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, Space
from grainlaw.validation.grains.coarse_graining import (
    SPACING,
    Kernel,
    Lattice,
    column_lattice,
    disc_lattice,
    kernel_of,
    solid_fraction,
    stress,
)
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.plausibility import axis_of, check_geometry, check_grain_density
from grainlaw.validation.grains.readers.run_folder import read_snapshots
from grainlaw.validation.grains.run_description import RunDescription, read_run_description
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, sphere_diameters
from grainlaw.validation.grains.surface import bulk_solid_fraction, fronts, interior_solid_fraction, surface_height

# Room for the kernel around the material, in its widths.
MARGIN = 4.0
# Of the lattice on which grains are spread; more would not fit into memory.
MOST_CELLS = 2e7
# Of the mass: what lies farther out are grains that rolled on alone.
INNER_SHARE = 0.98


@dataclass(frozen=True)
class Setting:
    """What the definitions need to know of a run, in SI units.

    width            of the kernel: one mean grain diameter
    depth            over which the grains are averaged in plane strain; 1 for material points
    center           of the column along x
    bulk             solid fraction before the release; None: that of the first snapshot
    space            plane strain, or axisymmetry, where all around an axis is averaged
    center_y         of the axis along y, in axisymmetry
    """

    width: float
    depth: float
    floor: float
    center: float
    grain_density: float
    gravity: float
    bulk: float | None = None
    space: Space = PLANE_STRAIN
    center_y: float = 0.0

    def across(self, snapshot: GrainSnapshot) -> Array:
        """Way along x from the center, or distance from the axis, of each grain [m]."""
        x, y, _ = snapshot.positions.T
        return np.hypot(x - self.center, y - self.center_y) if self.space.hoop else x - self.center


def observe_folder(folder: Path) -> Observation:
    """The observation of a DEM run's folder. Raises InputError in one line for whatever is wrong in it."""
    return observe_dumps(folder, read_run_description(folder))


def observe_dumps(folder: Path, description: RunDescription, label: str = "") -> Observation:
    """The observation of those dumps of a folder that a description names; `label` is what it calls itself.

    Raises InputError in one line for whatever is wrong in them.
    """
    check_grain_density(description)
    snapshots = list(read_snapshots(folder, description))
    check_geometry(snapshots, description)
    provenance = description.model_dump(mode="json", exclude={"frames"})
    setting = setting_of(description, snapshots[0])
    return observe(snapshots, setting, {"label": label, **provenance} if label else provenance)


def setting_of(description: RunDescription, first: GrainSnapshot) -> Setting:
    """The setting of a DEM run; the kernel's width is the mean diameter of its grains.

    Raises InputError if that is not the diameter which the description names.
    """
    diameter = float(sphere_diameters(first.solid_volumes).mean())
    named = description.mean_diameter
    if named is not None and not 0.5 < diameter / named < 2.0:
        raise InputError(
            f"run.json: mean_diameter = {named:g} m, but the grains have {diameter:g} m; are the units the same?"
        )
    setting = Setting(
        width=diameter,
        depth=description.depth or 1.0,
        floor=description.floor_level,
        center=description.center,
        grain_density=description.grain_density,
        gravity=description.gravity,
        bulk=description.solid_fraction,
    )
    if not description.is_round:
        return setting
    x, y = axis_of(first, description.axis)
    return replace(setting, depth=1.0, center=x, center_y=y, space=AXISYMMETRIC)


def observe(snapshots: Iterable[GrainSnapshot], setting: Setting, description: dict[str, Any]) -> Observation:
    """Profiles and series at the times of all snapshots; fields at the first, at half of the runout and at the last."""
    snapshots = list(snapshots)
    lattice = _lattice(snapshots, setting)
    kernels = [_kernel(snapshot, lattice, setting) for snapshot in snapshots]
    fractions = [solid_fraction(snapshot, kernel) for snapshot, kernel in zip(snapshots, kernels, strict=True)]
    bulk = setting.bulk or bulk_solid_fraction(fractions[0], lattice, setting.width)
    surface = np.array([surface_height(phi, lattice, bulk) for phi in fractions])
    series = {
        **_fronts(lattice, surface, setting),
        "height": surface.max(axis=1),
        "interior_solid_fraction": np.array(
            [
                interior_solid_fraction(phi, height, lattice, setting.width)
                for phi, height in zip(fractions, surface, strict=True)
            ]
        ),
    }
    series |= _integrals(snapshots, setting)
    if setting.space.hoop:
        series["radius_of_98_percent"] = np.array([_inner_radius(snapshot, setting) for snapshot in snapshots])
        description = {**description, "space": setting.space.name}
    chosen = _chosen(series["runout"])
    fields = [_fields(snapshots[number], kernels[number], fractions[number], setting) for number in chosen]
    if not setting.space.hoop and all(snapshots[number].stress is not None for number in chosen):
        for number, field in zip(chosen, fields, strict=True):
            field.update(_stresses(snapshots[number], lattice, setting))
    times = np.array([snapshot.time for snapshot in snapshots])
    if lost := snapshots[0].count - min(snapshot.count for snapshot in snapshots):
        description = {**description, "grains_lost": lost}
    return Observation(
        description={**description, "bulk_solid_fraction": bulk, "kernel_width": setting.width},
        times=times,
        x=lattice.x if setting.space.hoop else lattice.x - setting.center,
        z=lattice.z - setting.floor,
        surface=surface,
        series=series,
        snapshot_times=times[chosen],
        snapshots={name: np.array([field[name] for field in fields]) for name in fields[0]},
    )


def _lattice(snapshots: list[GrainSnapshot], setting: Setting) -> Lattice:
    margin = MARGIN * setting.width
    reach = max(float(np.abs(setting.across(snapshot)).max()) for snapshot in snapshots)
    top = max(float(snapshot.positions[:, 2].max()) for snapshot in snapshots)
    if (2.0 * reach + 2.0 * margin) * (top - setting.floor + margin) > MOST_CELLS * SPACING**2:
        raise InputError(
            f"grains up to {reach:g} m from {_axis_named(setting)} and {top:g} m high are too far apart to be spread "
            f"over cells of {SPACING:g} m; did grains leave the box?"
        )
    height = top - setting.floor + margin
    if setting.space.hoop:
        return disc_lattice(reach + margin, setting.floor, height)
    return column_lattice(setting.center, reach + margin, setting.floor, height)


def _axis_named(setting: Setting) -> str:
    beside = f", y = {setting.center_y:g} m" if setting.space.hoop else ""
    return f"x = {setting.center:g} m{beside}"


def _kernel(snapshot: GrainSnapshot, lattice: Lattice, setting: Setting) -> Kernel:
    positions = snapshot.positions
    if setting.space.hoop:
        positions = positions - [setting.center, setting.center_y, 0.0]
    return kernel_of(positions, lattice, setting.width, setting.depth)


def _fronts(lattice: Lattice, surface: Array, setting: Setting) -> dict[str, Array]:
    """Runout over time: half of the way between both ends, or the radius of the pile."""
    left, right = np.array([fronts(lattice.x, height, setting.width) for height in surface]).T
    if setting.space.hoop:
        return {"runout": right}
    return {"runout": 0.5 * (right - left), "front_left": left, "front_right": right}


def _inner_radius(snapshot: GrainSnapshot, setting: Setting) -> float:
    """The radius [m] around the axis within which 98 % of the mass lies by the centres of the grains."""
    radii = setting.across(snapshot)
    order = np.argsort(radii)
    shares = np.cumsum(snapshot.solid_volumes[order])
    return float(np.interp(INNER_SHARE * shares[-1], shares, radii[order]))


def _integrals(snapshots: list[GrainSnapshot], setting: Setting) -> dict[str, Array]:
    """Centre of mass and translational energies, per metre of depth or of the whole cylinder."""
    rows = []
    for snapshot in snapshots:
        mass = setting.grain_density * snapshot.solid_volumes / setting.depth
        x, _, z = np.average(snapshot.positions, axis=0, weights=mass)
        height = z - setting.floor
        kinetic = 0.5 * float(mass @ (snapshot.velocities**2).sum(axis=1))
        rows.append((x - setting.center, height, kinetic, mass.sum() * setting.gravity * height))
    names = ("center_of_mass_x", "center_of_mass_height", "kinetic_energy", "potential_energy")
    found = dict(zip(names, np.array(rows).T, strict=True))
    if setting.space.hoop:
        # Around the axis it tells nothing but how round the pile is.
        del found["center_of_mass_x"]
    return found


def _chosen(runout: Array) -> list[int]:
    """The first snapshot, the one nearest to half of the growth of the runout, and the last."""
    halfway = int(np.argmin(np.abs(runout - 0.5 * (runout[0] + runout[-1]))))
    return sorted({0, halfway, len(runout) - 1})


def _fields(snapshot: GrainSnapshot, kernel: Kernel, phi: Array, setting: Setting) -> dict[str, Array]:
    """Solid fraction, and velocity, across and up, as momentum over mass; 0 without material."""
    present = phi > 1e-3
    velocities = [
        np.divide(kernel.field(snapshot.solid_volumes * component), phi, out=np.zeros_like(phi), where=present)
        for component in (_velocity_across(snapshot, setting), snapshot.velocities[:, 2])
    ]
    return {"solid_fraction": phi, "velocity_x": velocities[0], "velocity_z": velocities[1]}


def _velocity_across(snapshot: GrainSnapshot, setting: Setting) -> Array:
    """Along x, or away from the axis [m/s]."""
    if not setting.space.hoop:
        return snapshot.velocities[:, 0]
    away = snapshot.positions[:, :2] - [setting.center, setting.center_y]
    radii = setting.across(snapshot)
    outwards = (away * snapshot.velocities[:, :2]).sum(axis=1)
    return np.divide(outwards, radii, out=np.zeros_like(radii), where=radii > 0.0)


def _stresses(snapshot: GrainSnapshot, lattice: Lattice, setting: Setting) -> dict[str, Array]:
    """Components of the stress [Pa], compression-positive."""
    assert snapshot.stress is not None
    found = stress(snapshot.stress, lattice, setting.width, setting.depth)
    return dict(zip(("stress_xx", "stress_zz", "stress_xz"), found, strict=True))
