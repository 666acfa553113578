"""One run of a case: its folder, its identity, and what it leaves there."""

import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.materials.atomic import write_text
from grainlaw.materials.errors import InputError, SimulationError
from grainlaw.validation.dem import collapse, compression, drum, hopper, shear, shear_steps, triaxial, wall_shear
from grainlaw.validation.dem.description import (
    AnyCase,
    Collapse,
    Compression,
    CylinderCollapse,
    PlaneShear,
    RoughDrum,
    ShearSteps,
    SlotHopper,
    Triaxial,
    WallShear,
)
from grainlaw.validation.dem.geometry import Column, geometry_of
from grainlaw.validation.dem.packing import Packing, cut
from grainlaw.validation.dem.programs import LIGGGHTS, PROGRAMS, YADE, Cost, installed_version, run_program

Files = dict[str, str]
Report = Callable[[str], None]
RECORD = "run.json"


@dataclass(frozen=True)
class Run:
    """A case in one code with one packing."""

    case: AnyCase
    code: str
    seed: int

    @property
    def name(self) -> str:
        """Case, code and seed."""
        return f"{self.case.name}/{self.code}-seed{self.seed}"

    def folder(self, out: Path) -> Path:
        """Where the run's files lie below `out`."""
        return out / self.case.name / f"{self.code}-seed{self.seed}"


def runs_of(case: AnyCase, code: str | None = None, seeds: tuple[int, ...] | None = None) -> list[Run]:
    """The runs of a case, in both codes or one, with its own seeds or those asked for."""
    codes = [code] if code else ["liggghts", "yade"]
    if "yade" in codes and not isinstance(case, Collapse):
        codes.remove("yade")
        if not codes:
            raise InputError(f"case '{case.name}' has a deck for LIGGGHTS only")
    return [Run(case, name, seed) for name in codes for seed in (seeds or case.seeds(name))]


def finished(run: Run, out: Path) -> bool:
    """Whether the run lies there complete and was made by the decks as they are now."""
    record = run.folder(out) / RECORD
    if not record.is_file():
        return False
    try:
        return bool(json.loads(record.read_text(encoding="utf-8"))["inputs_hash"] == inputs_hash(run))
    except (json.JSONDecodeError, KeyError):
        return False


def inputs_hash(run: Run) -> str:
    """Hash of what the run is made from: description, code, seed and deck templates."""
    case = run.case.model_dump_json(exclude={"purpose", "liggghts_seeds", "yade_seeds"})
    return files_hash({"case": case, "code": run.code, "seed": str(run.seed)} | _kind(run.case).templates(run.code))


def files_hash(files: Files) -> str:
    """Hash of the names and contents of a run's input files."""
    digest = hashlib.sha256()
    for name in sorted(files):
        digest.update(name.encode() + b"\0" + files[name].encode() + b"\0")
    return digest.hexdigest()[:16]


def perform(run: Run, out: Path, time_limit: float, report: Report = lambda _: None) -> Path:
    """Make the run, replacing what an earlier try left; return its folder.

    Raises SimulationError if a code fails or takes longer than `time_limit` [s] for one deck, InputError if it is
    missing.
    """
    PROGRAMS[run.code].command("")
    folder = run.folder(out)
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    record = _perform_collapse if isinstance(run.case, Column) else _perform_cell
    content = record(run, out, folder, time_limit, report)
    content["inputs_hash"] = inputs_hash(run)
    write_text(folder / RECORD, json.dumps(content, indent=1) + "\n")
    return folder


def settled_packing(case: Column, seed: int, out: Path, time_limit: float, report: Report) -> Packing:
    """The cut packing of a column, from the store of packings or made by LIGGGHTS; the same for both codes."""
    files = collapse.settling_files(case, seed)
    folder = out / "packings" / files_hash(files)
    done = folder / "done.txt"
    if not done.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder, files)
        run_program(LIGGGHTS, folder, "deck.in", time_limit, lambda line: report(f"settling: {line}"))
        done.write_text(f"{case.name} seed {seed}\n", encoding="utf-8")
    table = np.loadtxt(folder / "packing.txt", skiprows=9)
    return cut(Packing(table[:, 2:5], table[:, 8]), case.initial_height)


def _perform_collapse(run: Run, out: Path, folder: Path, time_limit: float, report: Report) -> dict[str, Any]:
    case = run.case
    assert isinstance(case, Column)
    geometry = geometry_of(case)
    packing = settled_packing(case, run.seed, out, time_limit, report)
    files = collapse.release_files(case, run.code, run.seed, packing)
    _write(folder, files)
    program = PROGRAMS[run.code]
    cost = run_program(program, folder, "deck.in" if program is LIGGGHTS else "deck.py", time_limit, report)
    if program is YADE and "finished" not in (folder / "log.txt").read_text(encoding="utf-8", errors="replace"):
        raise SimulationError(f"YADE stopped before the end; see {folder / 'log.txt'}")
    numbers = [count * collapse.output_steps(case) for count in range(collapse.outputs(case) + 1)]
    missing = [name for n in numbers if not (folder / (name := f"grains_{n:07d}.txt")).is_file()]
    if missing:
        raise SimulationError(f"{program.name} did not write {missing[0]}; see {folder / 'log.txt'}")
    steps = numbers[-1] + round(case.relaxation / case.time_step)
    return _record(run, files, cost, steps, len(packing)) | {
        "floor": case.floor,
        **geometry.record,
        "initial_height": case.initial_height,
        "gravity": case.gravity,
        "initial_solid_fraction": packing.volume / (geometry.base * case.initial_height),
        "release_time": 0.0,
        "mobile_types": [1],
        "frames": [_frame(n, case.time_step, geometry.with_contacts) for n in numbers],
    }


def _frame(step: int, time_step: float, with_contacts: bool) -> dict[str, Any]:
    contacts = {"contacts": f"contacts_{step:07d}.txt"} if with_contacts else {}
    return {"file": f"grains_{step:07d}.txt", **contacts, "time": step * time_step}


def _perform_cell(run: Run, out: Path, folder: Path, time_limit: float, report: Report) -> dict[str, Any]:
    kind = _kind(run.case)
    files = kind.files(run.case, run.seed)
    _write(folder, files)
    cost = run_program(LIGGGHTS, folder, "deck.in", time_limit, report)
    found = kind.reduce(run.case, folder)
    return _record(run, files, cost, found.steps, found.grains) | {"table": found.table}


def _kind(case: AnyCase) -> Any:
    modules = {
        Collapse: collapse,
        CylinderCollapse: collapse,
        PlaneShear: shear,
        WallShear: wall_shear,
        ShearSteps: shear_steps,
        Compression: compression,
        SlotHopper: hopper,
        RoughDrum: drum,
        Triaxial: triaxial,
    }
    return modules[type(case)]


def _record(run: Run, files: Files, cost: Cost, steps: int, grains: int) -> dict[str, Any]:
    case = run.case
    return {
        "status": "done",
        "case": case.name,
        "kind": case.kind,
        "code": run.code,
        "code_version": installed_version(PROGRAMS[run.code]),
        "seed": run.seed,
        "deck_hash": files_hash(files),
        "made": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "wall_time": round(cost.wall, 2),
        "cpu_time": round(cost.cpu, 2),
        "steps": steps,
        "grains": grains,
        "grain_steps_per_second": round(steps * grains / cost.cpu),
        "time_step": case.time_step,
        "grain_density": case.grains.density,
        "mean_diameter": case.grains.mean_diameter,
        "smallest_diameter": case.grains.smallest_diameter,
        "largest_diameter": case.grains.largest_diameter,
        "description": case.model_dump(),
    }


def _write(folder: Path, files: Files) -> None:
    for name, content in files.items():
        (folder / name).write_text(content, encoding="utf-8")
