"""All frames of a DEM run's folder as snapshots on one clock."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.validation.grains.love_weber import stress_of_contacts
from grainlaw.validation.grains.plausibility import check_density_of_grains
from grainlaw.validation.grains.readers import hdf5_grains, liggghts, mercury, text_table, vtk_points
from grainlaw.validation.grains.readers.contacts import read_contacts
from grainlaw.validation.grains.readers.raw_frame import RawFrame, Reader, mobile_columns, mobile_count, snapshot_of
from grainlaw.validation.grains.readers.text_file import read_start, unpacked_name
from grainlaw.validation.grains.run_description import RUN_DESCRIPTION_NAME, RunDescription
from grainlaw.validation.grains.snapshot import GrainSnapshot

READERS: tuple[Reader, ...] = (liggghts, hdf5_grains, vtk_points, mercury, text_table)
START = 4096
# LIGGGHTS writes the box beside each dump in VTK.
BOX_ENDINGS = ("_boundingBox.vtk", "_boundingBox.vtp", "_boundingBox.vtu")
# Times [s] nearer than this part of the clock's reading are the same.
SAME_TIME = 1e-9
# More grains than this part of the first frame's cannot leave the box without changing the deposit.
MOST_LOST = 0.01


def reader_of(path: Path) -> Reader | None:
    """The reader that recognises a file, or None."""
    start, name = read_start(path, START), unpacked_name(path)
    return next((reader for reader in READERS if reader.recognises(name, start)), None)


def raw_frames(path: Path) -> list[RawFrame]:
    """The frames of one file in whatever format. Raises InputError if no reader knows it."""
    if not path.is_file():
        raise InputError(f"{path} does not exist")
    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty")
    reader = reader_of(path)
    if reader is None:
        raise InputError(
            f"{path} is in no known format: LIGGGHTS, YADE or MercuryDPM text, VTK, HDF5 or CSV with named columns"
        )
    return list(reader.frames(path))


def read_snapshots(folder: Path, description: RunDescription) -> Iterator[GrainSnapshot]:
    """The mobile grains of a folder's dumps in the order of time, which counts from the release [s].

    Raises InputError for a damaged dump, one in other units, and one whose number of grains differs from the first by
    more than a few that left the box.
    """
    yield from snapshots_of(_listed_frames(folder, description), description)


def snapshots_of(frames: Sequence[RawFrame], description: RunDescription) -> Iterator[GrainSnapshot]:
    """The same from frames that have been read."""
    first: GrainSnapshot | None = None
    for time, frame in _since_release(frames, description):
        snapshot = snapshot_of(frame, time, description.mobile_types)
        if first is None:
            _check_density(frame, snapshot, description)
            first = snapshot
        if snapshot.count != first.count:
            _check_lost(frame, snapshot, first)
        if frame.contacts is not None and description.depth is not None and not description.is_round:
            contacts = read_contacts(frame.contacts)
            stress = stress_of_contacts(*contacts, description.depth, description.floor_level)
            snapshot = replace(snapshot, stress=stress)
        yield snapshot


def _since_release(frames: Sequence[RawFrame], description: RunDescription) -> list[tuple[float, RawFrame]]:
    """The frames from the release on, with their times since then [s]; those of the filling before are left out.

    Without a frame at the release, the last before it stands for the column, if that holds as many grains.
    """
    clock = [(_time(frame, description), frame) for frame in frames]
    tolerance = SAME_TIME * max(1.0, abs(description.release_time))
    timed = sorted(((time - description.release_time, frame) for time, frame in clock), key=lambda entry: entry[0])
    before = [entry for entry in timed if entry[0] < -tolerance]
    after = timed[len(before) :]
    if not after:
        last = f"; the last is at {before[-1][0] + description.release_time:g} s" if before else ""
        raise InputError(
            f"{RUN_DESCRIPTION_NAME}: no frame from release_time = {description.release_time:g} s on{last}"
        )
    if before and after[0][0] > tolerance:
        column, first = (mobile_count(entry[1], description.mobile_types) for entry in (before[-1], after[0]))
        after = before[-1:] + after if column == first else after
    return after


def _check_density(frame: RawFrame, snapshot: GrainSnapshot, description: RunDescription) -> None:
    """Raises InputError where the frame tells densities or masses that are not those of the description."""
    columns = mobile_columns(frame, description.mobile_types)
    density = columns["mass"] / snapshot.solid_volumes if "mass" in columns else columns.get("density")
    if density is not None:
        check_density_of_grains(frame.path, density, description.grain_density)


def _check_lost(frame: RawFrame, snapshot: GrainSnapshot, first: GrainSnapshot) -> None:
    """Raises InputError unless a few grains left the box, as a file that tells their number can show."""
    counts = f"{frame.path}: {snapshot.count} grains at t = {snapshot.time:g} s, {first.count} in the first frame"
    if snapshot.count > first.count:
        raise InputError(f"{counts}; grains were added: release_time in run.json must say when the filling ended")
    if not frame.complete:
        raise InputError(f"{counts}; is it truncated, or did grains leave the box?")
    if first.count - snapshot.count > MOST_LOST * first.count:
        raise InputError(f"{counts}; more than {MOST_LOST:.0%} of the grains left the box")


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
    found = [
        path
        for path in candidates
        if path.name != RUN_DESCRIPTION_NAME and (pattern or (not path.name.endswith(BOX_ENDINGS) and reader_of(path)))
    ]
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
        f"{frame.path} tells no time: run.json needs frames with their times, or time_step for a dump that tells its "
        "step (LIGGGHTS, or VTK with the step in its name)"
    )
