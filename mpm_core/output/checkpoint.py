"""`checkpoint.h5`: the whole state of a run, from which it resumes bit for bit."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import h5py
from numpy.typing import NDArray

from grainlaw.materials import InputError, atomic
from grainlaw.materials.compilation import mark_of_law
from grainlaw.materials.law import Law
from grainlaw.mpm_core.grid.active_nodes import active_between
from grainlaw.mpm_core.ledger import Ledger
from grainlaw.mpm_core.output.hdf5_file import sealed_hdf5
from grainlaw.mpm_core.output.hdf5_reading import UNREADABLE, existing_hdf5, numbers_of
from grainlaw.mpm_core.simulation import Simulation

CHECKPOINT_NAME = "checkpoint.h5"
# What of the active nodes is stored; the rest follows.
ACTIVE_ROWS = ("first_rows", "last_rows")


@dataclass
class Clock:
    """What the time loop remembers besides the simulation.

    The next frame and the next row of the history, in intervals; how many rows were due so far; wall time so far [s].
    """

    next_frame: int = 0
    next_history: int = 0
    history_rows: int = 0
    wall_time: float = 0.0


def write_checkpoint(folder: Path, simulation: Simulation, clock: Clock) -> None:
    """Replace the folder's checkpoint by the present state."""
    scalars = {
        "time": simulation.time,
        "steps": simulation.steps,
        "drift": simulation.drift,
        "drift_unprojected": simulation.drift_unprojected,
        "ways_bounded": simulation.ways_bounded,
        "last_step": simulation.last_step,
        "signal_speed": simulation.signal_speed,
        "strain_rate": simulation.strain_rate,
    }
    with atomic.replacing(folder / CHECKPOINT_NAME) as partial, sealed_hdf5(partial) as file:
        file.attrs.update(scalars)
        for name, part in (("clock", clock), ("ledger", simulation.ledger)):
            file.create_group(name).attrs.update(asdict(part))
        # Found anew from where points have drifted to, it would be another, and so what is withheld from its nodes.
        for name in ACTIVE_ROWS:
            file.create_dataset(f"active/{name}", data=getattr(simulation.active.columns, name))
        for number, body in enumerate(simulation.bodies):
            group = file.create_group(f"body/{number}")
            _write_rows(group, "points", body.points)
            group.create_dataset("ids", data=body.ids)
            group.create_dataset("stripe_starts", data=body.stripe_starts)
            group.attrs.update(law=body.law.name, law_mark=mark_of_law(body.law), rows=", ".join(body.row_names))
            group.attrs.update(awake=body.awake, signal_speed_asleep=body.signal_speed_asleep)
        for inflow in simulation.inflows.all:
            group = file.create_group(f"inflow/{inflow.name}")
            group.create_dataset("entered", data=inflow.entered)
            group.create_dataset("waited", data=inflow.waited)
            group.attrs.update(was_blocked=inflow.was_blocked, generated=inflow.body.generated)
        for name, state in simulation.obstacles.states.items():
            file.create_dataset(f"obstacle/{name}", data=state)
        if simulation.sleep is not None:
            sleep = file.create_group("sleep")
            sleep.attrs["started"] = simulation.sleep.started
            sleep.create_dataset("withheld", data=simulation.sleep.withheld, compression="gzip")
            for number, positions in enumerate(simulation.sleep.positions):
                sleep.create_dataset(f"positions/{number}", data=positions)


def _write_rows(group: h5py.Group, name: str, values: NDArray[Any]) -> None:
    """Write an array row by row: given whole, what lies apart in memory would be copied first."""
    rows = group.create_dataset(name, values.shape, values.dtype)
    for number, row in enumerate(values):
        rows[number] = row


def read_checkpoint(folder: Path, simulation: Simulation) -> Clock:
    """Bring a simulation, built from the same scene, to the state of the folder's checkpoint.

    Raises InputError if there is none, if it cannot be read or belongs to another scene.
    """
    path = folder / CHECKPOINT_NAME
    if not path.is_file():
        raise InputError(f"{folder} holds no {CHECKPOINT_NAME} to resume from; --overwrite starts the run again")
    try:
        with existing_hdf5(path) as file:
            return _restore(file, simulation)
    except ValueError as error:
        raise InputError(f"{path} belongs to another scene: {error}") from error
    except UNREADABLE as error:
        raise InputError(f"{path} cannot be read: {error}") from error


def refuse_other_laws(folder: Path, laws: Sequence[Law]) -> None:
    """Raises InputError where the law of a body is not what it was, in its own file or in what it takes from others."""
    try:
        with existing_hdf5(folder / CHECKPOINT_NAME) as file:
            marks = [str(file[f"body/{number}"].attrs["law_mark"]) for number in range(len(laws))]
    except UNREADABLE:
        return  # what is wrong with it is said where it is read
    for law, mark in zip(laws, marks, strict=True):
        if mark != mark_of_law(law):
            raise InputError(
                f"{folder}: the law {law.name} ({law.source_file}) was changed since the run began; undo that to go "
                "on, or begin the run again with --overwrite"
            )


def how_to_go_on(folder: Path) -> str:
    """What can be done with a run that was stopped: from when, and from which file."""
    path = folder / CHECKPOINT_NAME
    try:
        with existing_hdf5(path) as file:
            return f"--resume goes on from t = {float(file.attrs['time']):.6g} s, last checkpoint: {path}"
    except (*UNREADABLE, InputError):
        return "there is no checkpoint yet: --overwrite begins the run again"


def _restore(file: h5py.File, simulation: Simulation) -> Clock:
    for number, body in enumerate(simulation.bodies):
        group = file[f"body/{number}"]
        rows, points = group["points"].shape
        grows = any(inflow.body is body for inflow in simulation.inflows.all)
        if rows != len(body.points) or not (grows or points <= body.count):
            raise ValueError(f"body {number} has {(rows, points)} values, not {body.points.shape}")
        body.reserve(points)
        body.set_count(points)
        body.points[:] = numbers_of(group["points"])
        body.ids = numbers_of(group["ids"])
        body.stripe_starts = numbers_of(group["stripe_starts"])
        body.set_awake(int(group.attrs["awake"]))
        body.signal_speed_asleep = float(group.attrs["signal_speed_asleep"])
    for inflow in simulation.inflows.all:
        group = file[f"inflow/{inflow.name}"]
        inflow.entered, inflow.waited = numbers_of(group["entered"]), numbers_of(group["waited"])
        inflow.was_blocked, inflow.body.generated = bool(group.attrs["was_blocked"]), int(group.attrs["generated"])
    if simulation.sleep is not None:
        simulation.sleep.started = float(file["sleep"].attrs["started"])
        simulation.sleep.positions = [
            numbers_of(file[f"sleep/positions/{number}"]) for number in range(len(simulation.bodies))
        ]
        simulation.sleep.withheld = numbers_of(file["sleep/withheld"])
        simulation.sleep.bring_sleepers()
    simulation.time = float(file.attrs["time"])
    simulation.steps = int(file.attrs["steps"])
    simulation.drift = float(file.attrs["drift"])
    simulation.drift_unprojected = float(file.attrs["drift_unprojected"])
    simulation.ways_bounded = int(file.attrs["ways_bounded"])
    simulation.last_step = float(file.attrs["last_step"])
    simulation.signal_speed = float(file.attrs["signal_speed"])
    simulation.strain_rate = float(file.attrs["strain_rate"])
    simulation.keep_to(active_between(simulation.grid, *(numbers_of(file[f"active/{name}"]) for name in ACTIVE_ROWS)))
    simulation.obstacles.states = {name: numbers_of(state) for name, state in file.get("obstacle", {}).items()}
    simulation.obstacles.find_contacts(simulation.bodies, simulation.grid, simulation.basis)
    simulation.ledger = Ledger(**{name: float(value) for name, value in file["ledger"].attrs.items()})
    clock = file["clock"].attrs
    counts = {name: int(clock[name]) for name in ("next_frame", "next_history", "history_rows")}
    return Clock(wall_time=float(clock["wall_time"]), **counts)
