"""The small collapse in the formats of other codes: the same positions, radii and times, or a refusal that is true."""

import gzip
import json
import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import pyvista

from grainlaw.materials import InputError
from grainlaw.materials.element.mixed import read_control
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.scene.file import read_content
from grainlaw.validation.grains.observe import observe_folder
from grainlaw.validation.grains.readers.run_folder import read_snapshots
from grainlaw.validation.grains.reference_file import load_reference
from grainlaw.validation.grains.run_description import read_run_description
from grainlaw.validation.grains.snapshot import GrainSnapshot

SMALL_COLLAPSE = Path(__file__).parent / "small_collapse"
STEPS = (0, 10002, 33340)
TIME_STEP = 3e-5
BOX = np.array([[-0.8, 0.9], [0.0, 0.06], [-0.1, 0.3]])
MARK = "\ufeff"


def read(folder: Path) -> list[GrainSnapshot]:
    return list(read_snapshots(folder, read_run_description(folder)))


@pytest.fixture(scope="module")
def truth() -> list[GrainSnapshot]:
    """Three frames of the collapse."""
    return [shot for shot in read(SMALL_COLLAPSE) if round(shot.time / TIME_STEP) in STEPS]


def describe(folder: Path, **more: object) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "run.json").write_text(json.dumps({"depth": 0.06, "grain_density": 2450.0, **more}))
    return folder


def radii(shot: GrainSnapshot) -> np.ndarray:
    return np.cbrt(shot.solid_volumes / (4.0 / 3.0 * np.pi))


def rows(*columns: object) -> str:
    parts = zip(*(np.asarray(column).tolist() for column in columns), strict=True)
    return "".join(" ".join(str(value) for value in row) + "\n" for row in parts)


def dump(
    step: int, names: str, body: str, *, before: str = "", flags: str = "ff pp ff", count: int | None = None
) -> str:
    box = "".join(f"{low} {high}\n" for low, high in BOX)
    number = body.count("\n") if count is None else count
    return (
        f"{before}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{number}\nITEM: BOX BOUNDS {flags}\n{box}"
        f"ITEM: ATOMS {names} \n{body}"
    )


def columns(shot: GrainSnapshot) -> list[np.ndarray]:
    return [*shot.positions.T, *shot.velocities.T, radii(shot)]


NAMES = "x y z vx vy vz radius"


def yade_attributes(folder: Path, shots: list[GrainSnapshot]) -> None:
    frames = []
    for number, shot in enumerate(shots):
        spin = np.zeros((shot.count, 3)).T
        body = rows(*shot.positions.T, radii(shot), *spin, *shot.velocities.T, np.ones(shot.count, int))
        text = f"#format x_y_z_r_attrs\n# x y z r b.state.angVel b.state.vel b.mask\n{body}"
        (folder / f"g{number}.txt").write_text(text)
        frames.append({"file": f"g{number}.txt", "time": shot.time})
    describe(folder, frames=frames)


def time_item(folder: Path, shots: list[GrainSnapshot]) -> None:
    for step, shot in zip(STEPS, shots, strict=True):
        before = f"ITEM: UNITS\nsi\nITEM: TIME\n{shot.time!r}\n"
        (folder / f"dump{step}.txt").write_text(dump(step, NAMES, rows(*columns(shot)), before=before))


def all_in_one_dump(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    texts = [dump(step, NAMES, rows(*columns(shot))) for step, shot in zip(STEPS, shots, strict=True)]
    (folder / "all.dump").write_text(MARK + texts[0] + "\n" + "".join(texts[1:]))


def scaled(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    for step, shot in zip(STEPS, shots, strict=True):
        inside = (shot.positions - BOX[:, 0]) / np.diff(BOX)[:, 0]
        body = rows(*inside.T, *shot.velocities.T, radii(shot))
        (folder / f"d.{step}").write_text(dump(step, "xs ys zs vx vy vz radius", body))


def unwrapped(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    for step, shot in zip(STEPS, shots, strict=True):
        # Every second grain went twice around the periodic depth.
        around = shot.positions + np.outer(np.arange(shot.count) % 2, [0.0, -0.12, 0.0])
        body = rows(*around.T, *shot.velocities.T, radii(shot))
        (folder / f"d.{step}").write_text(dump(step, "xu yu zu vx vy vz radius", body))


def scaled_unwrapped(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    for step, shot in zip(STEPS, shots, strict=True):
        inside = (shot.positions - BOX[:, 0]) / np.diff(BOX)[:, 0] + np.outer(np.arange(shot.count) % 3, [0, 1, 0])
        body = rows(*inside.T, *shot.velocities.T, radii(shot))
        (folder / f"d.{step}").write_text(dump(step, "xsu ysu zsu vx vy vz radius", body))


def texts_and_diameters(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    for step, shot in zip(STEPS, shots, strict=True):
        remarks = ["Si" if number % 2 else "glass" for number in range(shot.count)]
        body = rows(remarks, *shot.positions.T, *shot.velocities.T, 2 * radii(shot))
        (folder / f"d.{step}").write_text(dump(step, "element x y z vx vy vz diameter", body))


def packed(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    for step, shot in zip(STEPS, shots, strict=True):
        text = dump(step, NAMES, rows(*columns(shot)))
        (folder / f"dump{step}.liggghts.gz").write_bytes(gzip.compress(text.encode()))


def vtk(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP)
    for step, shot in zip(STEPS, shots, strict=True):
        points = pyvista.PolyData(shot.positions)
        points.point_data["radius"], points.point_data["v"] = radii(shot), shot.velocities
        points.save(folder / f"run2_dump{step}.vtk")
        pyvista.Box().save(folder / f"run2_dump{step}_boundingBox.vtk")


def paraview(folder: Path, shots: list[GrainSnapshot]) -> None:
    frames = []
    for number, shot in enumerate(shots):
        body = rows(radii(shot), *shot.velocities.T, *shot.positions.T).replace(" ", ",")
        head = '"radius","v:0","v:1","v:2","Points:0","Points:1","Points:2"\n'
        (folder / f"p{number}.csv").write_text(MARK + head + body)
        frames.append({"file": f"p{number}.csv", "time": shot.time})
    describe(folder, frames=frames)


def mercury(folder: Path, shots: list[GrainSnapshot]) -> None:
    text = ""
    for shot in shots:
        text += f"{shot.count} {shot.time!r} -0.8 0 -0.1 0.9 0.06 0.3\n"
        text += rows(*columns(shot), *np.zeros((6, shot.count)), np.zeros(shot.count, int))
    (folder / "column.data").write_text(text)


def filling_before(folder: Path, shots: list[GrainSnapshot]) -> None:
    describe(folder, time_step=TIME_STEP, release_time=0.6)
    first = columns(shots[0])
    for step, share in ((0, 0), (5000, 100), (19000, 886)):
        (folder / f"d.{step}").write_text(dump(step, NAMES, rows(*(column[:share] for column in first))))
    for step, shot in zip(STEPS, shots, strict=True):
        (folder / f"d.{step + 20000}").write_text(dump(step + 20000, NAMES, rows(*columns(shot))))


WRITERS = [
    yade_attributes,
    time_item,
    all_in_one_dump,
    scaled,
    unwrapped,
    scaled_unwrapped,
    texts_and_diameters,
    packed,
    vtk,
    paraview,
    mercury,
    filling_before,
]


@pytest.mark.parametrize("write", WRITERS, ids=lambda write: write.__name__)
def test_the_same_grains_in_another_format(tmp_path, truth, write: Callable[[Path, list[GrainSnapshot]], None]):
    write(describe(tmp_path), truth)
    found = read(tmp_path)
    assert [shot.time for shot in found] == pytest.approx([shot.time for shot in truth], abs=1e-12)
    # VTK holds single precision.
    for shot, expected in zip(found, truth, strict=True):
        apart = shot.positions - expected.positions
        # y is periodic: 0 and the depth are the same place.
        apart[:, 1] -= 0.06 * np.round(apart[:, 1] / 0.06)
        assert np.abs(apart).max() < 1e-7
        assert np.ptp(shot.positions[:, 1]) <= 0.06
        assert radii(shot) == pytest.approx(radii(expected), rel=1e-6)
        assert np.abs(shot.velocities - expected.velocities).max() < 1e-6


def test_the_column_before_the_release_stands_for_it(tmp_path, truth):
    describe(tmp_path, time_step=TIME_STEP, release_time=0.1)
    for step, shot in zip((0, 10000, 20000), truth, strict=True):
        (tmp_path / f"d.{step}").write_text(dump(step, NAMES, rows(*columns(shot))))
    assert [shot.time for shot in read(tmp_path)] == pytest.approx([-0.1, 0.2, 0.5])


def without(shot: GrainSnapshot, lost: int) -> str:
    return rows(*(column[lost:] for column in columns(shot)))


def test_a_few_grains_may_leave_the_box(tmp_path, truth):
    describe(tmp_path, time_step=TIME_STEP)
    for step, shot, lost in zip(STEPS, truth, (0, 0, 3), strict=True):
        (tmp_path / f"d.{step}").write_text(dump(step, NAMES, without(shot, lost)))
    assert [shot.count for shot in read(tmp_path)] == [887, 887, 884]
    assert observe_folder(tmp_path).description["grains_lost"] == 3


def _frame(folder: Path, truth: list[GrainSnapshot], **values: object) -> None:
    names = str(values.pop("names", NAMES))
    (folder / "d.0").write_text(dump(0, names, rows(*columns(truth[0])), **values))  # type: ignore[arg-type]


def _two(folder: Path, first: str, second: str) -> None:
    for step, body in ((0, first), (9, second)):
        (folder / f"d.{step}").write_text(dump(step, NAMES, body))


REFUSED = {
    "many lost": (lambda f, t: _two(f, without(t[0], 0), without(t[0], 90)), "left the box"),
    "grains added": (lambda f, t: _two(f, without(t[0], 90), without(t[0], 0)), "release_time"),
    "other units": (lambda f, t: _frame(f, t, before="ITEM: UNITS\ncgs\n"), "units 'cgs'"),
    "tilted box": (
        lambda f, t: _frame(f, t, names="xs y z vx vy vz radius", flags="xy xz yz ff pp ff"),
        "not rectangular",
    ),
    "packed and cut": (lambda f, t: (f / "d.gz").write_bytes(gzip.compress(b"ITEM: TIMESTEP\n" * 500)[:20]), "d.gz"),
    "negative number": (lambda f, t: _frame(f, t, count=-5), "a number after"),
    "text as radius": (
        lambda f, t: (f / "d.0").write_text(dump(0, "x y z radius", "0 0.01 0 0.007\n0 0.02 0.1 big\n")),
        "line 11: radius = 'big'",
    ),
    "in the plane": (lambda f, t: (f / "a.data").write_text("1 0 0 0 1 1\n0 0 0 0 0.01 0 0 0\n"), "two-dimensional"),
    "mercury cut": (lambda f, t: (f / "a.data").write_text("2 0 0 0 0 1 1 1\n" + "0 " * 14), "1 of 2 rows"),
    "far away": (
        lambda f, t: (f / "d.0").write_text(dump(0, "x y z radius", "0 0.01 0 0.007\n1e7 0.05 1e7 0.007\n")),
        "leave the box",
    ),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_what_has_no_one_meaning_is_refused(tmp_path, truth, kind):
    spoil, message = REFUSED[kind]
    spoil(describe(tmp_path, time_step=TIME_STEP), truth)
    with pytest.raises(InputError, match=message) as caught:
        observe_folder(tmp_path)
    assert "\n" not in str(caught.value)


def _turned(folder: Path, shots: list[GrainSnapshot], order: tuple[int, int, int], signs: tuple[int, int, int]) -> None:
    """The collapse with its axes x, y, z in another order or direction."""
    for step, shot in zip(STEPS, shots, strict=True):
        axes = [sign * shot.positions[:, axis] for axis, sign in zip(order, signs, strict=True)]
        (folder / f"d.{step}").write_text(dump(step, "x y z radius", rows(*axes, radii(shot))))


def _with_masses(folder: Path, shots: list[GrainSnapshot], unit: float) -> None:
    for step, shot in zip(STEPS, shots, strict=True):
        body = rows(*columns(shot), unit * 2450.0 * shot.solid_volumes)
        (folder / f"d.{step}").write_text(dump(step, f"{NAMES} mass", body))


def _with_densities(folder: Path, shots: list[GrainSnapshot], density: float) -> None:
    for step, shot in zip(STEPS, shots, strict=True):
        (folder / f"d.{step}").write_text(dump(step, f"{NAMES} rho", rows(*columns(shot), [density] * shot.count)))


CONTRADICTIONS = {
    "y up, z the depth": (lambda f, t: _turned(f, t, (0, 2, 1), (1, 1, 1)), {}, "along y .*is y up in this dump"),
    "y up, of any depth": (lambda f, t: _turned(f, t, (0, 2, 1), (1, 1, 1)), {"depth": 0.25}, "is y up in this dump"),
    "z down": (lambda f, t: _turned(f, t, (0, 1, 2), (1, 1, -1)), {}, "is z down in this dump"),
    "x up, z the depth": (lambda f, t: _turned(f, t, (2, 0, 1), (1, 1, 1)), {}, r"= 0\.06 m, but the grains span"),
    "depth in centimetres": (lambda f, t: _turned(f, t, (0, 1, 2), (1, 1, 1)), {"depth": 6.0},
                             r"run\.json: depth = 6 m, but the grains span 0\.0[67]\d* m along y"),
    "half of the depth": (lambda f, t: _turned(f, t, (0, 1, 2), (1, 1, 1)), {"depth": 0.03}, "the grains span"),
    "masses in grams": (lambda f, t: _with_masses(f, t, 1e3), {},
                        r"d\.0: the grains have 2\.45e\+06 kg/m3, but run\.json says grain_density = 2450; .*in grams"),
    "densities in g/cm3": (lambda f, t: _with_densities(f, t, 2.45), {}, r"the grains have 2\.45 kg/m3, but run\.json"),
}  # fmt: skip


@pytest.mark.parametrize("kind", CONTRADICTIONS)
def test_what_contradicts_its_description_is_refused(tmp_path, truth, kind):
    spoil, changes, message = CONTRADICTIONS[kind]
    spoil(describe(tmp_path, **({"time_step": TIME_STEP} | changes)), truth)
    with pytest.raises(InputError, match=message) as caught:
        observe_folder(tmp_path)
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match=message):
        load_reference(tmp_path)


@pytest.mark.parametrize(
    "write",
    [
        lambda f, t: _with_masses(f, t, 1.0),
        lambda f, t: _with_densities(f, t, 2600.0),
        lambda f, t: _turned(f, t, (0, 1, 2), (-1, 1, 1)),
    ],
    ids=["masses", "densities", "mirrored"],
)
def test_what_agrees_is_read_without_a_warning(tmp_path, truth, write):
    write(describe(tmp_path, time_step=TIME_STEP), truth)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert observe_folder(tmp_path).times[-1] == pytest.approx(1.0002)


def test_doubtful_descriptions_are_warned_about(tmp_path, truth):
    _with_densities(describe(tmp_path, time_step=TIME_STEP, grain_density=2.45), truth, 2.45)
    with pytest.warns(InputWarning, match=r"run\.json: grain_density = 2\.45 kg/m3 is that of no grains; .* 2450"):
        observe_folder(tmp_path)
    _turned(describe(tmp_path, time_step=TIME_STEP), truth, (2, 1, 0), (1, 1, 1))
    with pytest.warns(InputWarning, match="is x up in this dump"):
        observe_folder(tmp_path)


def test_no_frame_after_the_release(tmp_path, truth):
    _frame(describe(tmp_path, time_step=TIME_STEP, release_time=2.0), truth)
    with pytest.raises(InputError, match="no frame from release_time = 2 s on; the last is at 0 s"):
        read(tmp_path)


def test_a_surface_with_a_byte_order_mark_and_no_diameter(tmp_path):
    path = tmp_path / "experiment.csv"
    path.write_text(f"{MARK}t,x,h,remark\n0,-0.3,0,left\n0,0,0.1,top\n0,0.3,0,right\n", encoding="utf-8")
    assert load_reference(path, 0.003).of("runout")[0] == pytest.approx(0.3 * (1 - 0.03), abs=1e-3)
    with pytest.raises(InputError, match="grain_diameter"):
        load_reference(path)


def test_scenes_parameters_controls_and_descriptions_may_start_with_a_byte_order_mark(tmp_path):
    (tmp_path / "sand.toml").write_text(f"{MARK}poisson_ratio = 0.2\n", encoding="utf-8")
    scene = tmp_path / "scene.toml"
    scene.write_text(f'{MARK}title = "a"\n[material.linear_elastic]\nparameters = "sand.toml"\n', encoding="utf-8")
    content = read_content(scene, {})
    assert (content["title"], content["material"]["linear_elastic"]["poisson_ratio"]) == ("a", 0.2)
    (tmp_path / "run.json").write_text(MARK + '{"depth": 0.06, "grain_density": 2450}', encoding="utf-8")
    assert read_run_description(tmp_path).depth == 0.06
    (tmp_path / "control.toml").write_text(f"{MARK}time_step = 'soon'\n", encoding="utf-8")
    with pytest.raises(InputError, match="time_step"):
        read_control(tmp_path / "control.toml")


def test_output_in_ascii_ends_without_a_traceback():
    code = "import grainlaw.cli.main as command; command.app = lambda: print('S\\u00e4ule'); command.main()"
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert rb"S\xe4ule" in done.stdout
