"""All frames of a DEM run's folder as snapshots on one clock."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.validation.grains.love_weber import stress_of_contacts
from grainlaw.validation.grains.readers import hdf5_grains, liggghts, text_table, vtk_points
from grainlaw.validation.grains.readers.contacts import read_contacts
from grainlaw.validation.grains.readers.raw_frame import RawFrame, Reader, snapshot_of
from grainlaw.validation.grains.run_description import RUN_DESCRIPTION_NAME, RunDescription
from grainlaw.validation.grains.snapshot import GrainSnapshot

READERS: tuple[Reader, ...] = (liggghts, hdf5_grains, vtk_points, text_table)
START = 4096


def reader_of(path: Path) -> Reader | None:
    """The reader that recognises a file, or None."""
    with path.open("rb") as file:
        start = file.read(START)
    return next((reader for reader in READERS if reader.recognises(path, start)), None)


def raw_frames(path: Path) -> list[RawFrame]:
    """The frames of one file in whatever format. Raises InputError if no reader knows it."""
    if not path.is_file():
        raise InputError(f"{path} does not exist")
    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty")
    reader = reader_of(path)
    if reader is None:
        raise InputError(f"{path} is in no known format: LIGGGHTS or YADE text, VTK, HDF5 or CSV with named columns")
    return list(reader.frames(path))


def read_snapshots(folder: Path, description: RunDescription) -> Iterator[GrainSnapshot]:
    """The mobile grains of a folder's dumps in the order of time, which counts from the release [s].

    Raises InputError for a damaged dump, one in other units, and one whose number of grains differs from the first.
    """
    yield from snapshots_of(_listed_frames(folder, description), description)


def snapshots_of(frames: Sequence[RawFrame], description: RunDescription) -> Iterator[GrainSnapshot]:
    """The same from frames that have been read."""
    first: GrainSnapshot | None = None
    timed = [(_time(frame, description) - description.release_time, frame) for frame in frames]
    for time, frame in sorted(timed, key=lambda entry: entry[0]):
        snapshot = snapshot_of(frame, time, description.mobile_types)
        first = first or snapshot
        if snapshot.count != first.count:
            raise InputError(
                f"{frame.path}: {snapshot.count} grains at t = {time:g} s, {first.count} in the first frame; "
                "is it truncated, or did grains leave the box?"
            )
        if frame.contacts is not None:
            contacts = read_contacts(frame.contacts)
            stress = stress_of_contacts(*contacts, description.depth, description.floor_level)
            snapshot = replace(snapshot, stress=stress)
        yield snapshot


def _listed_frames(folder: Path, description: RunDescription) -> list[RawFrame]:
    if description.frames is None:
        return [frame for path in _grain_files(folder, description.grains_files) for frame in raw_frames(path)]
    frames = []
    for entry in description.frames:
        found = raw_frames(folder / entry.file)
        if entry.time is not None and len(found) > 1:
            raise InputError(f"{folder / entry.file} holds {len(found)} frames, but run.json gives it one time")
        contacts = folder / entry.contacts if entry.contacts else None
        for frame in found:
            frames.append(replace(frame, time=frame.time if entry.time is None else entry.time, contacts=contacts))
    if not frames:
        raise InputError(f"{folder / RUN_DESCRIPTION_NAME}: frames is an empty list")
    return frames


def _grain_files(folder: Path, pattern: str) -> list[Path]:
    """The dumps of a folder in the order of their names. Raises InputError if there is none."""
    candidates = sorted(path for path in folder.glob(pattern or "*") if path.is_file())
    found = [path for path in candidates if path.name != RUN_DESCRIPTION_NAME and (pattern or reader_of(path))]
    if not found:
        raise InputError(f"{folder} holds no dump of grains{f' named {pattern}' if pattern else ''}")
    return found


def _time(frame: RawFrame, description: RunDescription) -> float:
    """Time on the run's clock [s]: that of run.json or of the frame, or its step times the time step."""
    if frame.time is not None:
        return frame.time
    if frame.step is not None and description.time_step is not None:
        return frame.step * description.time_step
    raise InputError(
        f"{frame.path} tells no time: run.json needs frames with their times, or time_step for a LIGGGHTS dump"
    )
