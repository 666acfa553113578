"""Files of points of other MPM codes: read alike in every format, refused in a line where they tell no pile."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
import pyvista
from points_for_tests import AREA, WRITERS, block
from scenes_for_tests import COLUMN, call_command_line, changed

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, SPACES
from grainlaw.validation.cases.mpm.piles import ROWS
from grainlaw.validation.cases.mpm.set_ups import HEIGHT, one_preconsolidation_pressure
from grainlaw.validation.catalogue import SUITES
from grainlaw.validation.mpm.peers import peers
from grainlaw.validation.mpm.piles import compare_piles, pile_at
from grainlaw.validation.mpm.points import read_points
from grainlaw.validation.mpm.readers import point_table
from grainlaw.validation.mpm.state import Start, read_state
from grainlaw.validation.report.page import read_page

WIDTH = 0.005
START = Start(AREA, WIDTH)
WIDE, NARROW = 0.3, 0.27


def observed(path: Path, space=PLANE_STRAIN):
    return read_state(path).observed(START, space, 1.5)


def npz(folder: Path, **arrays: object) -> Path:
    np.savez(folder / "points.npz", **arrays)
    return folder / "points.npz"


@pytest.mark.parametrize("form", WRITERS)
def test_the_same_points_in_every_format(tmp_path, form):
    places = block(WIDE)[::7]
    volumes = 1.0 + np.arange(len(places)) / len(places)
    found = read_points(WRITERS[form](tmp_path, places, volumes))
    assert found.positions[:, :2] == pytest.approx(places, abs=1e-7)
    assert found.amounts == pytest.approx(volumes)
    assert found.time == (None if form.startswith("ply") else 1.0)


def test_a_block_has_its_width_its_height_and_the_area_of_the_column(tmp_path):
    found = observed(npz(tmp_path, position=block(WIDE), time=0.7))
    assert found.times.tolist() == [0.7]
    assert found.content(0) == pytest.approx(AREA, rel=0.01)
    assert found.of("height")[0] == pytest.approx(0.5 * AREA / WIDE, rel=0.005)
    assert found.of("runout")[0] == pytest.approx(WIDE, abs=WIDTH)


def test_the_area_between_two_blocks_of_one_area(tmp_path):
    wide = observed(npz(tmp_path, position=block(WIDE)))
    narrow = observed(npz(tmp_path, position=block(NARROW)))
    found = compare_piles(narrow, wide, WIDTH)
    area, half_width, top = (one.distance for one in found.distances)
    height, taller = 0.5 * AREA / WIDE, 0.5 * AREA / NARROW
    between = 2.0 * (WIDE - NARROW) * height + 2.0 * NARROW * (taller - height)
    assert area == pytest.approx(between / AREA, rel=0.03)
    assert half_width == pytest.approx(NARROW / WIDE - 1.0, abs=0.01)
    assert top == pytest.approx(taller / height - 1.0, abs=0.005)
    assert found.verdict == "differs"
    # What differs in size alone is the same shape.
    assert compare_piles(wide, wide, WIDTH).shape_distance == 0.0
    assert found.shape_distance == pytest.approx(area, rel=0.05)


def test_points_count_by_their_mass(tmp_path):
    """Twice as many points of half the mass on one side are no higher there."""
    places = block(WIDE)
    right = places[:, 0] > 0.0
    twice = np.concatenate([places, places[right]])
    mass = np.where(np.concatenate([right, right[right]]), 0.5, 1.0)
    found = observed(npz(tmp_path, position=twice, mass=mass, volume=np.ones(len(twice))))
    even = observed(npz(tmp_path, position=places))
    assert found.surface == pytest.approx(even.surface, abs=1e-9)


def describe(folder: Path, **told: object) -> None:
    (folder / "run.json").write_text(json.dumps(told))


def test_axis_floor_half_and_up_are_told_beside_the_file(tmp_path):
    places = block(WIDE)
    even = observed(npz(tmp_path, position=places))
    right = places[places[:, 0] > 0.0] + [1.6, 0.019]
    depth = np.linspace(0.0, 0.05, len(right))
    path = npz(tmp_path, particle_q=np.column_stack([right[:, 0], right[:, 1], depth]), t=2.5)
    describe(tmp_path, code="Newton", center=1.6, floor_level=0.019, half=True, up="y", release_time=1.5)
    found = observed(path)
    assert (found.label, found.times.tolist()) == ("Newton", [1.0])
    assert found.surface == pytest.approx(even.surface, abs=1e-7)


def test_a_cylinder_in_space_and_rings_of_a_plane(tmp_path):
    radius, height = 0.15, 0.3
    start = Start(np.pi * radius**2 * height, 0.01)
    x, y, z = (
        values.ravel() for values in np.meshgrid(*[np.arange(-0.145, 0.15, 0.01)] * 2, np.arange(0.005, 0.3, 0.01))
    )
    inside = np.hypot(x, y) < radius
    whole = npz(tmp_path, position=np.column_stack([x + 2.0, y - 1.0, z])[inside], volume=np.ones(inside.sum()))
    found = read_state(whole).observed(start, AXISYMMETRIC, 1.0)
    half_plane = (x > 0.0) & (np.abs(y + 0.005) < 1e-9)
    rings = npz(tmp_path, position=np.column_stack([x, z])[half_plane], mass=x[half_plane])
    for one in (found, read_state(rings).observed(start, AXISYMMETRIC, 1.0)):
        assert one.of("height")[0] == pytest.approx(height, rel=0.01)
        assert one.of("runout")[0] == pytest.approx(radius, abs=0.01)
    with pytest.raises(InputError, match="rings of different volume"):
        read_state(npz(tmp_path, position=np.column_stack([x, z])[half_plane])).observed(start, AXISYMMETRIC, 1.0)


def _archive(folder: Path, name: str, content: bytes) -> Path:
    with zipfile.ZipFile(folder / "points.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return folder / "points.npz"


def _head(shape: tuple[int, ...], length: int) -> bytes:
    buffer = io.BytesIO()
    np.lib.format.write_array_header_1_0(buffer, {"descr": "<f8", "fortran_order": False, "shape": shape})
    return buffer.getvalue() + bytes(length)


def _file(name: str, content: bytes):
    def write(folder: Path) -> Path:
        (folder / name).write_bytes(content)
        return folder / name

    return write


def _cut(form: str, share: float):
    def write(folder: Path) -> Path:
        path = WRITERS[form](folder, block(WIDE), np.ones(len(block(WIDE))))
        path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
        return path

    return write


def _of_position(message_of: object):
    return lambda folder: npz(folder, position=message_of)


PLY = b"ply\nformat binary_little_endian 1.0\nelement vertex %s\nproperty double x\nproperty double y\n%send_header\n"
SPOILT = block(WIDE)
SPOILT[5, 1] = np.nan
MANY = len(SPOILT)
REFUSED = {
    "empty": (_file("points.npz", b""), "is empty"),
    "no format": (_file("points.dat", b"\x00\x01\x02"), "in no known format: npz, CSV"),
    "no zip": (_file("points.npz", b"PK\x03\x04 and no more"), "cannot be read as npz"),
    "npz cut off": (_cut("npz", 0.5), "cannot be read as npz"),
    "vtu cut off": (_cut("vtu", 0.5), "VTK"),
    "ply cut off": (_cut("ply, binary", 0.5), r"of \d+ vertices; is it truncated"),
    "ply, text, cut off": (_cut("ply", 0.5), "cannot be read as PLY"),
    "csv cut off": (_cut("csv", 0.501), "columns; is the file truncated"),
    "npz that says more than it holds": (
        lambda folder: _archive(folder, "position.npy", _head((10**11, 2), 16)),
        "as long",
    ),
    "npz that unpacks too far": (
        lambda folder: _archive(folder, "position.npy", _head((300, 2), 4800)),
        "300 points; allowed",
    ),
    "ply that says more than it holds": (_file("points.ply", PLY % (b"9" * 30, b"") + bytes(64)), "truncated"),
    "ply of lists": (_file("points.ply", PLY % (b"1", b"property list uchar int a\n") + bytes(64)), "hold lists"),
    "ply without an end": (_file("points.ply", b"ply\nformat ascii 1.0\n" + b"comment\n" * 20000), "no end"),
    "no points": (_of_position(np.zeros((0, 2))), "holds no points"),
    "no positions": (
        lambda folder: npz(folder, place=block(WIDE)),
        "holds no positions: it has place; known are position",
    ),
    "positions twice": (lambda folder: npz(folder, x=SPOILT, position=SPOILT), "more than once: x; position"),
    "positions and columns": (lambda folder: npz(folder, pos=SPOILT, x=SPOILT[:, 0], y=SPOILT[:, 1]), "pos; x, y"),
    "columns of two lengths": (lambda folder: npz(folder, x=np.zeros(4), y=np.zeros(3)), "x, y differ in length"),
    "one component": (_of_position(np.zeros((9, 1))), r"shape \(9, 1\); expected \(points, 2\) or"),
    "several times": (_of_position(np.zeros((3, 9, 2))), r"shape \(3, 9, 2\)"),
    "NaN": (_of_position(SPOILT), f"1 of {MANY} points have positions that are no finite numbers"),
    "millimetres": (_of_position(1000.0 * block(WIDE)), "is the file in millimetres"),
    "text": (_file("points.csv", b"x,y\n0.1,sand\n"), "y = 'sand' is not a number"),
    "two times": (
        lambda folder: npz(folder, position=block(WIDE), t=np.arange(3.0)),
        "t from 0 to 2 s; expected one state",
    ),
    "volumes of others": (
        lambda folder: npz(folder, position=block(WIDE), volume=np.ones(3)),
        f"3 values of volume for {MANY}",
    ),
    "no volume": (lambda folder: npz(folder, position=block(WIDE), vol=np.zeros(MANY)), "vol that are not above 0"),
    "two masses": (lambda folder: npz(folder, position=block(WIDE), m=np.ones(MANY), mass=np.ones(MANY)), "leave one"),
    "points of two sizes": (
        lambda folder: npz(folder, position=block(WIDE), radius=1.0 + (SPOILT[:, 0] > 0.0)),
        "radius goes from 1 to 2, so that points are not all alike; a volume or a mass",
    ),
    "beside the axis": (
        _of_position(block(WIDE) + np.array([1.6, 0.0])),
        'at x = 1.6 m, the axis at 0 m; run.json.*"center"',
    ),
    "above the floor": (
        _of_position(block(WIDE) + np.array([0.0, 0.1])),
        'lowest points are at 0.1.* the floor at 0 m.*"floor_level"',
    ),
    "another column": (_of_position(2.0 * block(WIDE)), "as densely as in the run's column"),
    "far away": (
        _of_position(np.concatenate([block(WIDE), [[90.0, 90.0], [-90.0, 0.0]]])),
        "points.npz: grains up to 90 m",
    ),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_what_tells_no_pile_is_refused_in_a_line(tmp_path, monkeypatch, kind):
    write, message = REFUSED[kind]
    if kind == "npz that unpacks too far":
        monkeypatch.setattr(point_table, "MOST_POINTS", 200)
    with pytest.raises(InputError, match=message) as refusal:
        observed(write(tmp_path))
    assert "\n" not in str(refusal.value)


def test_a_surface_around_an_axis_says_so_itself(tmp_path):
    path = tmp_path / "disc.csv"
    path.write_text("# space = axisymmetric\nt,x,h\n1.0,0.0,0.1\n1.0,0.3,0.1\n")
    state = read_state(path)
    assert state.description.in_space(SPACES["3d"]) is AXISYMMETRIC
    assert state.observed(START, SPACES["3d"], 1.0).of("runout")[0] == pytest.approx(0.3, abs=0.01)


def test_descriptions_that_are_wrong_are_refused(tmp_path):
    path = npz(tmp_path, position=block(WIDE))
    describe(tmp_path, up="x")
    with pytest.raises(InputError, match=r"run.json: up"):
        read_state(path)
    with pytest.raises(InputError, match="is a folder"):
        read_state(tmp_path)
    with pytest.raises(InputError, match="does not exist"):
        read_state(tmp_path / "none.npz")


def test_vtk_keeps_its_points_whatever_they_hold(tmp_path):
    """An array `position` among the data of the points, as of a start, is not where they are."""
    places = block(WIDE)
    cloud = pyvista.PolyData(np.column_stack([places, np.zeros(len(places))]))
    cloud.point_data["position"] = np.ones((len(places), 3))
    cloud.save(tmp_path / "points.vtp")
    assert read_points(tmp_path / "points.vtp").positions[:, :2] == pytest.approx(places, abs=1e-6)


@pytest.fixture(scope="module")
def column(tmp_path_factory):
    """A run of a column, 0.3 m wide and 0.8 m high, that has hardly begun to fall."""
    scene = changed(COLUMN, {"grid.cell_size": 0.05, "time.end": 1e-3, "output": {"interval": 1e-3, "pictures": False}})
    folder = tmp_path_factory.mktemp("beside") / "column"
    run(Scene.from_dict(scene), folder)
    return folder


def test_compare_puts_a_run_beside_points_and_a_surface(tmp_path, monkeypatch, capsys, column):
    """Blocks of the run's area, one as wide as its column, one a tenth narrower and higher."""
    size = np.sqrt(0.24 / AREA)
    same = npz(tmp_path, position=size * block(0.15 / size), time=1e-3)
    surface = tmp_path / "narrow.csv"
    x = np.arange(-0.2, 0.2001, 0.005)
    rows = [f"0.001,{one:.4f},{0.8 / 0.9 if abs(one) < 0.135 else 0.0}" for one in x]
    surface.write_text("\n".join(["t,x,h", *rows]) + "\n")
    out = tmp_path / "out"
    assert call_command_line(monkeypatch, "compare", column, "--mpm", same, "--mpm", surface, "--out", out) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert str(out / "comparison.html") in printed.out
    page = read_page(out)
    assert page.title == "Runs beside other MPM codes"
    table = page.sections[0].tables[0]
    first, second = (dict(zip(table.columns[:5], row, strict=False)) for row in table.rows)
    assert (first["run"], first["code"], first["verdict"]) == ("column", "points", "indistinguishable")
    assert float(first["E_A"].split()[0]) < 3.0
    assert second["verdict"] == "differs"
    # Between them lie two strips at the sides and one on top, a tenth of the area each.
    assert float(second["E_A"].split()[0]) == pytest.approx(20.0, abs=5.0)
    assert page.sections[0].figures[0].image.startswith("data:image/png")


def test_a_bad_file_is_one_line_and_exit_2_and_nothing_is_written(tmp_path, monkeypatch, capsys, column):
    path = _cut("vtu", 0.5)(tmp_path)
    assert call_command_line(monkeypatch, "compare", column, "--mpm", path, "--out", tmp_path / "out") == 2
    printed = capsys.readouterr()
    assert printed.err == f"error: {path} cannot be read as VTK; is it truncated?\n"
    assert list((tmp_path / "out").iterdir()) == []


def test_a_state_later_than_the_run_is_warned_about(tmp_path, monkeypatch, capsys, column):
    size = np.sqrt(0.24 / AREA)
    path = npz(tmp_path, position=size * block(0.15 / size), time=2.0)
    assert call_command_line(monkeypatch, "compare", column, "--mpm", path) == 0
    assert "points is at t = 2 s, column ends at 0.001 s" in capsys.readouterr().err


def test_the_piles_that_ship_are_those_of_the_column_and_tell_where_they_are_from():
    for peer in peers().values():
        pile = pile_at(peer.observed(WIDTH), peer.time, WIDTH)
        assert pile.area == pytest.approx(peer.area, rel=0.01)
        assert 0.7 * AREA < pile.area < 1.05 * AREA
        assert peer.differs
        assert peer.name in SUITES["mpm"]
    assert sorted(peers()) == sorted(SUITES["mpm"])


def test_the_changes_of_every_set_up_make_a_scene():
    for row in ROWS:
        for set_up in (row.ours, row.mistaken, *row.others.values()):
            Scene.load(shipped_scenes()[set_up.scene], {"grid.cell_size": 0.025, **set_up.changes()})


def test_layers_of_one_preconsolidation_pressure_have_that_of_the_bottom():
    scene = Scene.load(
        shipped_scenes()["collapse_mcc_ocr1"], {"grid.cell_size": 0.025, **one_preconsolidation_pressure()}
    )
    sizes = np.concatenate([body.states[0] for body in build_bodies(scene)])
    # p_c = p + q^2/(M^2 p) of the weight of 0.9 m, at the middle of each layer; within one it goes with the depth.
    weight = 1500.0 * 9.8 * HEIGHT
    assert np.median(sizes) == pytest.approx(weight * (0.8 + 0.6**2 / (1.2**2 * 0.8)), rel=0.05)
