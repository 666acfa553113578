"""An observation: what a collapse looked like, reduced to profiles and fields by one set of definitions.

In HDF5: the attributes `description` (JSON: provenance) and `grainlaw_observation` (version of this format, 1);
`x`, `z` [m]; `time` [s]; `surface` (time, x) [m]; `series/NAME` (time); `snapshots/time` [s] and `snapshots/NAME`
(time, x, z) with solid_fraction, velocity_x, velocity_z and, where contacts were told, stress_xx, stress_zz, stress_xz.

The description's `space` says what x is: the way along the slope ("plane_strain", the default), or the distance from
the axis of a cylinder ("axisymmetric"). Energies are then those of the whole body, in J.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from grainlaw.materials import InputError, atomic
from grainlaw.materials.errors import nearest_name
from grainlaw.mpm_core.output.hdf5_reading import UNREADABLE, existing_hdf5, numbers_of
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, Space
from grainlaw.validation.grains.coarse_graining import column_weights
from grainlaw.validation.grains.snapshot import Array

FORMAT_ATTRIBUTE = "grainlaw_observation"
FORMAT_VERSION = 1
SERIES_UNITS = {
    "runout": "m",
    "front_left": "m",
    "front_right": "m",
    "height": "m",
    "radius_of_98_percent": "m",
    "center_of_mass_x": "m",
    "center_of_mass_height": "m",
    "interior_solid_fraction": "1",
    "kinetic_energy": "J/m",
    "potential_energy": "J/m",
}
# In which grains are compared.
SPACES = {space.name: space for space in (PLANE_STRAIN, AXISYMMETRIC)}
# By the number of axes: series in full; surfaces to 1e-7, fields to 5e-4 of their value, finer than one grain tells.
STORED_TYPES: dict[int, type[np.floating[Any]]] = {1: np.float64, 2: np.float32, 3: np.float16}
SNAPSHOT_UNITS = {
    "solid_fraction": "1",
    "velocity_x": "m/s",
    "velocity_z": "m/s",
    "stress_xx": "Pa",
    "stress_zz": "Pa",
    "stress_xz": "Pa",
}


@dataclass(frozen=True)
class Observation:
    """A collapse over time.

    description      what was observed: case, code, seed, cost and whatever else the run told
    times            since the release, shape (t,) [s]
    x, z             centres of the lattice's cells [m]; in axisymmetry x is the distance from the axis
    surface          height of the surface above the floor, shape (t, x) [m]
    series           quantities of `SERIES_UNITS`, each of shape (t,)
    snapshot_times   of the fields, shape (k,) [s]
    snapshots        fields of `SNAPSHOT_UNITS`, each of shape (k, x, z)
    """

    description: dict[str, Any]
    times: Array
    x: Array
    z: Array
    surface: Array
    series: dict[str, Array]
    snapshot_times: Array
    snapshots: dict[str, Array]

    @property
    def label(self) -> str:
        """Code and seed, or whatever the description calls itself."""
        name = self.description.get("label") or self.description.get("code") or "unnamed"
        seed = self.description.get("seed")
        return name if seed is None else f"{name} {seed}"

    @property
    def space(self) -> Space:
        """Plane strain, or axisymmetry, where x is the distance from the axis."""
        return SPACES[self.description.get("space") or PLANE_STRAIN.name]

    def content(self, number: int) -> float:
        """What lies below the surface at one time: an area [m2], in axisymmetry a volume [m3]."""
        spacing = float(self.x[1] - self.x[0])
        around = 2.0 * np.pi if self.space.hoop else 1.0
        return around * spacing * float(self.surface[number] @ column_weights(self.x, self.space))

    def unit_of(self, name: str) -> str:
        """The unit of a series: energies are per metre of width in plane strain alone."""
        return SERIES_UNITS[name].removesuffix(PLANE_STRAIN.amount if self.space.hoop else "")

    def of(self, name: str) -> Array:
        """One series. Raises InputError if it was not observed."""
        if name not in self.series:
            raise InputError(f"{self.label}: no series '{name}'; {nearest_name(name, self.series)}")
        return self.series[name]


def write_observation(path: Path, observation: Observation) -> None:
    """Write an observation to HDF5, complete or not at all."""
    with atomic.replacing(path) as partial, h5py.File(partial, "w") as file:
        file.attrs[FORMAT_ATTRIBUTE] = FORMAT_VERSION
        file.attrs["description"] = json.dumps(observation.description)
        for name, values, unit in (
            ("x", observation.x, "m"),
            ("z", observation.z, "m"),
            ("time", observation.times, "s"),
            ("surface", observation.surface, "m"),
            ("snapshots/time", observation.snapshot_times, "s"),
        ):
            _write(file, name, values, unit)
        for name, values in observation.series.items():
            _write(file, f"series/{name}", values, observation.unit_of(name))
        for name, values in observation.snapshots.items():
            _write(file, f"snapshots/{name}", values, SNAPSHOT_UNITS[name])


def _write(file: h5py.File, name: str, values: Array, unit: str) -> None:
    kind = STORED_TYPES[values.ndim]
    stored = values.astype(kind if np.abs(values).max(initial=0.0) <= np.finfo(kind).max else np.float32)
    dataset = file.create_dataset(name, data=stored, compression="gzip", compression_opts=9, shuffle=True)
    dataset.attrs["unit"] = unit


def is_observation(path: Path) -> bool:
    """Whether a file is an observation in HDF5."""
    try:
        with existing_hdf5(path) as file:
            return FORMAT_ATTRIBUTE in file.attrs
    except UNREADABLE:
        return False


def read_observation(path: Path) -> Observation:
    """Read an observation. Raises InputError in one line for a damaged file or one of another kind."""
    try:
        with existing_hdf5(path) as file:
            if file.attrs.get(FORMAT_ATTRIBUTE) != FORMAT_VERSION:
                raise InputError(f"{path} is no observation of format {FORMAT_VERSION}")
            read = Observation(
                description=json.loads(file.attrs["description"]),
                times=_read(file, "time"),
                x=_read(file, "x"),
                z=_read(file, "z"),
                surface=_read(file, "surface"),
                series={name: _read(file, f"series/{name}") for name in file["series"]},
                snapshot_times=_read(file, "snapshots/time"),
                snapshots={name: _read(file, f"snapshots/{name}") for name in file["snapshots"] if name != "time"},
            )
            if (space := str(read.description.get("space") or PLANE_STRAIN.name)) not in SPACES:
                raise InputError(f"{path}: its space is {space!r}; allowed: {', '.join(SPACES)}")
    except UNREADABLE as error:
        raise InputError(f"{path} cannot be read as an observation: {error}") from None
    if read.surface.shape != (len(read.times), len(read.x)):
        raise InputError(
            f"{path}: surface has the shape {read.surface.shape}, expected {(len(read.times), len(read.x))}"
        )
    return read


def _read(file: h5py.File, name: str) -> Array:
    return numbers_of(file[name]).astype(float)
