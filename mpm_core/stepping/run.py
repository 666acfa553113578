"""The time loop: from a scene to a run's folder."""

import math
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path

from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.output.bounded_points import limited
from grainlaw.mpm_core.output.checkpoint import Clock, how_to_go_on, refuse_other_laws
from grainlaw.mpm_core.output.folder_lock import held
from grainlaw.mpm_core.output.prepare import go_on, new_folder
from grainlaw.mpm_core.output.recorder import Recorder
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.summary import FinalState, RunSummary, read_summary, write_summary
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.stepping.interrupts import Interrupts, interrupts_noted
from grainlaw.mpm_core.stepping.peak_memory import peak_memory
from grainlaw.mpm_core.stepping.resumed_scene import is_finished, resumed_scene

Progress = Callable[[Simulation, float], None]


def run(
    scene: Scene,
    folder: Path,
    *,
    threads: int = 1,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> RunSummary:
    """Run a scene and write its folder; `progress(simulation, dt)` is called after each step.

    A run that is resumed may have a later end than it had: it comes to the same bits as one that ran through.

    Raises InputError for what cannot be run, would overwrite a run or is not the run to resume, and SimulationError,
    naming the time, the point and the last checkpoint, where the computation goes wrong or the disk is full. A
    KeyboardInterrupt gets a note of how to go on.
    """
    if resume and overwrite:
        choices = "--resume goes on with the run there, --overwrite begins it again; choose one"
        raise InputError(f"{folder}: {choices}")
    started = time.perf_counter()
    if resume:
        scene = resumed_scene(scene, folder)
        if is_finished(scene, folder):
            _draw(scene, folder)
            return read_summary(folder)
        refuse_other_laws(folder, [scene.law(material) for material in scene.materials])
    simulation = built_simulation(scene, threads)
    refuse_impossible_steps(simulation)
    text = scene.to_toml()
    with held(folder) if resume else new_folder(folder, text, overwrite=overwrite), _stops_explained(folder):
        clock = go_on(folder, simulation) if resume else Clock()
        summary = _run(simulation, folder, clock, started - clock.wall_time, progress)
        write_summary(folder, summary)
        _draw(scene, folder)
    return summary


def _run(simulation: Simulation, folder: Path, clock: Clock, started: float, progress: Progress | None) -> RunSummary:
    recorder = Recorder(folder, simulation, clock)
    try:
        with interrupts_noted() as interrupts:
            first_steps = _advance(simulation, recorder, started, progress, interrupts)
        recorder.finish(time.perf_counter() - started)
    finally:
        recorder.close()
    compile_time = simulation.build_time + max(0.0, first_steps)
    return _summary(simulation, recorder, time.perf_counter() - started, compile_time)


@contextmanager
def _stops_explained(folder: Path) -> Iterator[None]:
    """Say from where a run that is stopped can go on."""
    try:
        yield
    except SimulationError as error:
        raise SimulationError(f"{error}; {how_to_go_on(folder)}") from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise SimulationError(f"{folder} cannot be written: {reason}; {how_to_go_on(folder)}") from error
    except KeyboardInterrupt as interrupt:
        interrupt.add_note(f"stopped by Ctrl-C; {how_to_go_on(folder)}")
        raise


def _draw(scene: Scene, folder: Path) -> None:
    if scene.output.pictures and scene.output.vtu:
        from grainlaw.mpm_core.output.pictures import write_run_pictures

        write_run_pictures(folder)
    if scene.output.movie:
        _film(folder)


def _film(folder: Path) -> None:
    """Make the film of a finished run, which what goes wrong with it must not lose."""
    from grainlaw.mpm_core.output.film import FILM_NAME, write_film

    try:
        write_film([(folder.resolve().name, RunFolder(folder))], folder / FILM_NAME)
    except Exception as error:  # whatever the libraries that draw and encode may raise
        reason = str(error) if isinstance(error, InputError | SimulationError) else f"{type(error).__name__}: {error}"
        warnings.warn(f"{folder}: the run is finished, its film is not made: {reason}", InputWarning, stacklevel=2)


def built_simulation(scene: Scene, threads: int) -> Simulation:
    """The simulation of a scene. Raises InputError, naming the scene's file, for a scene that cannot be built."""
    try:
        return Simulation(scene, threads)
    except InputError as error:
        raise InputError(f"{scene.source}: {error}") from error
    except MemoryError as error:
        cells = " x ".join(f"{float(count):.12g}" for count in scene.grid.cells)
        raise InputError(f"{scene.source}: grid: {cells} cells do not fit into memory") from error


def _advance(
    simulation: Simulation, recorder: Recorder, started: float, progress: Progress | None, interrupts: Interrupts
) -> float:
    """Step to the end. Returns the wall time that the first step took longer than the second one [s]."""
    durations: list[float] = []
    if simulation.steps == 0:
        recorder.record(time.perf_counter() - started)
    while simulation.time < simulation.scene.time.end:
        before = time.perf_counter()
        for dt in simulation.steps_to(recorder.next_frame_time()):
            now = time.perf_counter()
            if len(durations) < 2:
                durations.append(now - before)
            recorder.record(now - started)
            if progress is not None:
                progress(simulation, dt)
            interrupts.after_step()
            before = time.perf_counter()
    return durations[0] - durations[1] if len(durations) == 2 else 0.0


def refuse_impossible_steps(simulation: Simulation) -> None:
    """Raises InputError for a step of the scene that is unstable, and for a smallest one above the first."""
    step, stable = simulation.scene.time.step, simulation.critical_time_step()
    first = step or simulation.adaptive_step()
    if simulation.smallest_step > first:
        where = f"{simulation.scene.source}: time.smallest_step = {simulation.smallest_step:g} s"
        raise InputError(f"{where} is above the first step, {first:.6g} s; allowed: less")
    if step is not None and step > stable:
        where = f"{simulation.scene.source}: time.step = {step:g} s"
        raise InputError(f"{where} is above the stable step at the start, {stable:.6g} s")


def _summary(simulation: Simulation, recorder: Recorder, wall_time: float, compile_time: float) -> RunSummary:
    scene, shape, ledger = simulation.scene, recorder.shape(), simulation.ledger
    points = simulation.initial_points + simulation.inflows.points_in
    released = ledger.released
    return RunSummary(
        scene=scene.title,
        material=", ".join(dict.fromkeys(body.law.name for body in simulation.bodies)),
        points=simulation.initial_points,
        cells=math.prod(scene.grid.cells),
        steps=simulation.steps,
        simulated_time=simulation.time,
        mass_left=ledger.mass_left,
        points_left=points - sum(body.count for body in simulation.bodies),
        mass_in=ledger.mass_in,
        points_in=simulation.inflows.points_in,
        wall_time=wall_time,
        compile_time=compile_time,
        point_steps_per_second=points * simulation.steps / max(wall_time - compile_time, 1e-9),
        peak_memory_bytes=peak_memory(),
        final=FinalState(
            runout=shape.runout,
            height=shape.height,
            center_of_mass_height=None if math.isnan(shape.center_of_mass_height) else shape.center_of_mass_height,
            kinetic_energy=ledger.kinetic,
        ),
        energy_balance_error=abs(ledger.numerical_dissipation) / released if released > 0.0 else 0.0,
        limited=limited(simulation),
        threads=simulation.threads,
        version=version("grainlaw"),
    )
