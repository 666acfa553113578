"""Many runs side by side through Dask, each into its folder: the finished are left alone, the failed tell why."""

import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import uuid4

from distributed import Client, Future, as_completed, get_worker
from distributed.scheduler import KilledWorker

from grainlaw import progress
from grainlaw.face.laws import load_plugin
from grainlaw.materials import InputError, SimulationError, registry
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.output.checkpoint import CHECKPOINT_NAME
from grainlaw.mpm_core.output.folder_lock import held
from grainlaw.mpm_core.output.prepare import OWN_FILES
from grainlaw.mpm_core.output.run_folder import SCENE_NAME
from grainlaw.mpm_core.output.summary import SUMMARY_NAME
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.stepping.compilation import noticed_compilation
from grainlaw.mpm_core.stepping.resumed_scene import is_finished, resumed_scene
from grainlaw.mpm_core.stepping.run import run
from grainlaw.progress import shown_runs
from grainlaw.studies.cluster import workers_of
from grainlaw.studies.kernels import compiled_once


@dataclass(frozen=True)
class Member:
    """A run of a batch: the name of its folder, and the tables of its scene with files by absolute path."""

    name: str
    scene: Mapping[str, Any]


@dataclass(frozen=True)
class Outcome:
    """What became of a member: its folder, and the reason why it failed; empty where it finished."""

    name: str
    folder: Path
    reason: str


Report = Callable[[Outcome], None]


def run_members(
    members: Sequence[Member],
    out: Path,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
    report: Report = lambda outcome: None,
) -> list[Outcome]:
    """Run each member into its folder below `out`; return what became of each, in their order.

    scheduler  address of a Dask scheduler whose workers see `out` under the same path; by default processes here
    workers    how many processes here, each with one thread; by default the cores
    resume     leave finished runs alone, go on with those begun from their checkpoint
    report     called with each outcome as it is there, also of what was finished before

    A member that fails, or whose worker is killed again and again, does not stop the others; a run whose worker was
    killed goes on from its checkpoint on another one. The workers load the files of laws that are loaded here.

    Raises InputError before anything is run where a folder holds a run (with `resume`, that of another scene), where
    `out` cannot be written, and for a scheduler that does not answer; SimulationError where the scheduler goes away. A
    KeyboardInterrupt gets a note of how to go on.
    """
    if scheduler is not None and workers is not None:
        raise InputError(f"workers = {workers}: the scheduler at {scheduler} has its own")
    with _prepared(out):
        found = _known_before(members, out, resume)
        for outcome in found.values():
            report(outcome)
        left = [member for member in members if member.name not in found]
        if left:
            with _stops_explained(found, members), workers_of(scheduler, workers) as client:
                for outcome in _outcomes(client, left, out.absolute()):
                    found[outcome.name] = outcome
                    report(outcome)
    return [found[member.name] for member in members]


def run_shown(
    members: Sequence[Member],
    out: Path,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
) -> list[Outcome]:
    """As `run_members`, with the progress shown."""
    with shown_runs(len(members)) as count:
        return run_members(
            members,
            out,
            scheduler=scheduler,
            workers=workers,
            resume=resume,
            report=lambda outcome: count(outcome.name, outcome.reason),
        )


@contextmanager
def _prepared(out: Path) -> Iterator[None]:
    """The folder of all runs, held against a second batch."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"output folder {out} cannot be written: {error.strerror}") from error
    with held(out):
        yield


def _known_before(members: Sequence[Member], out: Path, resume: bool) -> dict[str, Outcome]:
    """The outcomes of finished runs, by name. Raises InputError for a folder that holds what would be lost."""
    found = {}
    for member in members:
        folder = out / member.name
        if not resume and any(any(folder.glob(pattern)) for pattern in OWN_FILES):
            raise InputError(f"{folder} already holds a run; choose another --out, or --resume to go on with all")
        if resume and (folder / SCENE_NAME).is_file() and _is_finished(member, folder):
            found[member.name] = Outcome(member.name, folder, "")
    return found


def _is_finished(member: Member, folder: Path) -> bool:
    scene = Scene.from_dict(dict(member.scene), member.name)
    return is_finished(resumed_scene(scene, folder), folder)


def _outcomes(client: Client, members: Sequence[Member], out: Path) -> Iterator[Outcome]:
    """Hand members to the workers; yield each outcome as it is there."""
    batch, plugins, address = uuid4().hex, _files_of_laws(), client.scheduler_info(n_workers=0)["address"]
    _say_once_when_it_compiles(client, batch)
    futures = {
        client.submit(
            perform, dict(member.scene), out / member.name, plugins, batch, key=f"{member.name}-{batch}", pure=False
        ): member
        for member in members
    }
    try:
        for future in as_completed(futures):
            member = futures[future]
            if future.cancelled():
                raise SimulationError(f"the scheduler at {address} is gone")
            reason = _reason(future)
            folder = out / member.name
            if not reason and not (folder / SUMMARY_NAME).is_file():
                reason = f"the run finished, but {folder} is not on the disk that its worker writes to"
            yield Outcome(member.name, folder, reason)
    finally:
        client.cancel(list(futures), force=True)


def _say_once_when_it_compiles(client: Client, batch: str) -> None:
    heard: list[object] = []

    def hear(event: object) -> None:
        heard.append(event)
        if len(heard) == 1:
            progress.say_that_it_compiles()

    client.subscribe_topic(batch, hear)


def _reason(future: "Future[str]") -> str:
    """Why a run failed; empty where it did not."""
    error = future.exception()
    if error is None:
        return str(future.result())
    if isinstance(error, KilledWorker):
        return f"{error.allowed_failures + 1} workers were killed with this run, perhaps for their memory"
    return _in_one_line(error)


def _in_one_line(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


@contextmanager
def _stops_explained(found: Mapping[str, Outcome], members: Sequence[Member]) -> Iterator[None]:
    """Say how a batch that is stopped can go on."""

    def done() -> str:
        finished = sum(not outcome.reason for outcome in found.values())
        return f"{finished} of {len(members)} runs are finished; --resume goes on with the others"

    try:
        yield
    except SimulationError as error:
        raise SimulationError(f"{error}; {done()}") from error
    except KeyboardInterrupt as interrupt:
        interrupt.add_note(f"stopped by Ctrl-C; {done()}")
        raise


def _files_of_laws() -> list[Path]:
    """The files whose laws this process has loaded by path."""
    origins = {entry.origin for entry in registry().laws.values()}
    return [path.absolute() for path in map(Path, sorted(origins)) if path.is_file()]


# Kernels of two runs in one process would take turns anyway, and their compilation could not be told apart.
_ONE_AT_A_TIME = threading.Lock()


def perform(scene: dict[str, Any], folder: Path, plugins: Sequence[Path], batch: str) -> str:
    """One run, in a worker; returns the reason why it failed, or nothing."""
    try:
        with _ONE_AT_A_TIME, warnings.catch_warnings():
            # The process that handed it out has warned.
            warnings.simplefilter("ignore", InputWarning)
            for path in plugins:
                load_plugin(path)
            described = Scene.from_dict(scene, folder.name)
            compiling = noticed_compilation(lambda: get_worker().log_event(batch, "compiling"))
            with compiled_once(described, batch) as stepped, compiling:
                _run(described, folder, stepped)
    except (InputError, SimulationError) as error:
        return str(error)
    except Exception as error:
        return _in_one_line(error)
    return ""


def _run(scene: Scene, folder: Path, stepped: Callable[[], None]) -> None:
    if (folder / CHECKPOINT_NAME).is_file():
        try:
            run(scene, folder, resume=True, progress=lambda simulation, dt: stepped())
            return
        except InputError:
            pass  # of a law that was changed, or damaged: begun again
    run(scene, folder, overwrite=True, progress=lambda simulation, dt: stepped())
