"""All frames of a DEM run's folder as snapshots on one clock."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from materials import InputError
from validation.grains.readers import hdf5_grains, liggghts, text_table, vtk_points
from validation.grains.readers.raw_frame import RawFrame, Reader, snapshot_of
from validation.grains.run_description import RUN_DESCRIPTION_NAME, RunDescription
from validation.grains.snapshot import GrainSnapshot

READERS: tuple[Reader, ...] = (liggghts, hdf5_grains, vtk_points, text_table)
START = 4096


def reader_of(path: Path) -> Reader | None:
    """The reader that recognises a file, or None."""
    with path.open("rb") as file:
        start = file.read(START)
    return next((reader for reader in READERS if reader.recognises(path, start)), None)


def grain_files(folder: Path, pattern: str) -> list[Path]:
    """The dumps of a folder in the order of their names. Raises InputError if there is none."""
    if pattern:
        found = sorted(path for path in folder.glob(pattern) if path.is_file())
    else:
        candidates = sorted(path for path in folder.iterdir() if path.is_file() and path.name != RUN_DESCRIPTION_NAME)
        found = [path for path in candidates if reader_of(path) is not None]
    if not found:
        raise InputError(f"{folder} holds no dump of grains{f' named {pattern}' if pattern else ''}")
    return found


def raw_frames(path: Path) -> list[RawFrame]:
    """The frames of one file in whatever format. Raises InputError if no reader knows it."""
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
    frames = [frame for path in grain_files(folder, description.grains_files) for frame in raw_frames(path)]
    yield from snapshots_of(frames, description)


def snapshots_of(frames: Sequence[RawFrame], description: RunDescription) -> Iterator[GrainSnapshot]:
    """The same from frames that have been read."""
    if all(frame.step is not None for frame in frames):
        frames = sorted(frames, key=lambda frame: frame.step or 0)
    elif all(frame.time is not None for frame in frames):
        frames = sorted(frames, key=lambda frame: frame.time or 0.0)
    first: GrainSnapshot | None = None
    for time, frame in zip(_times(frames, description), frames, strict=True):
        snapshot = snapshot_of(frame, time, description.mobile_types)
        first = first or snapshot
        if snapshot.count != first.count:
            raise InputError(
                f"{frame.path}: {snapshot.count} grains at t = {time:g} s, {first.count} in the first frame; "
                "is it truncated, or did grains leave the box?"
            )
        yield snapshot


def _times(frames: Sequence[RawFrame], description: RunDescription) -> list[float]:
    """Times since the release: the frames' own, or the step times the time step, or those of the description."""
    if all(frame.time is not None for frame in frames):
        return [(frame.time or 0.0) - description.release_time for frame in frames]
    if description.time_step is not None and all(frame.step is not None for frame in frames):
        return [(frame.step or 0) * description.time_step - description.release_time for frame in frames]
    if description.times is None:
        raise InputError(f"{frames[0].path} tells no time: run.json needs times, or time_step for a LIGGGHTS dump")
    if len(description.times) != len(frames):
        raise InputError(
            f"{frames[0].path.parent}: {len(frames)} frames, but run.json lists {len(description.times)} times"
        )
    return list(description.times)
