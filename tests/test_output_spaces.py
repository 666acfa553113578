"""What runs leave in each space: units of the history, shapes of piles, sections, cuts and views, without a run."""

import csv
import math
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from scenes_for_tests import BLOCK, changed

from grainlaw.face.runs import Run
from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.output import rendering
from grainlaw.mpm_core.output.cut import Cut
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.history import HistoryWriter, history_columns
from grainlaw.mpm_core.output.middle import Middle, middle_of
from grainlaw.mpm_core.output.observables import Measure, pile_shape
from grainlaw.mpm_core.output.pictures import write_run_pictures
from grainlaw.mpm_core.output.point_image import ColorScale, draw_points
from grainlaw.mpm_core.output.quantities import write_quantities
from grainlaw.mpm_core.space import AXISYMMETRIC, SPACES, THREE_D

CELL, SPACING = 0.1, 0.05
RADIUS, HEIGHT = 1.0, 0.6


def body_in(space, positions, masses, density=1000.0):
    count = positions.shape[1]
    return SimpleNamespace(positions=positions, count=count, masses=masses, initial_density=density, space=space)


def half_section():
    """The points of a cylinder in axisymmetry, four per cell, with masses as their radii."""
    r, y = np.meshgrid(np.arange(SPACING / 2, RADIUS, SPACING), np.arange(SPACING / 2, HEIGHT, SPACING))
    return body_in(AXISYMMETRIC, np.array([r.ravel(), y.ravel()]), 1000.0 * SPACING**2 * r.ravel())


def cylinder(signs=((1, 1), (-1, 1), (1, -1), (-1, -1)), center=(0.0, 0.0)):
    """The points of those quarters of a cylinder in 3D whose signs of x and y are given, eight per cell."""
    along = np.arange(SPACING / 2, RADIUS, SPACING)
    x, y, z = (
        part.ravel() for part in np.meshgrid(along, along, np.arange(SPACING / 2, HEIGHT, SPACING), indexing="ij")
    )
    inside = np.hypot(x, y) < RADIUS
    quarter = np.array([x, y, z])[:, inside]
    points = np.concatenate([quarter * [[sx], [sy], [1]] for sx, sy in signs], axis=1)
    return points + np.array([[center[0]], [center[1]], [0.0]])


def shape_3d(points, middle):
    body = body_in(THREE_D, points, np.full(points.shape[1], 1000.0 * SPACING**3))
    return pile_shape([body], Measure(0.0, CELL, 8.0, middle))


@pytest.mark.parametrize(("name", "unit"), [("plane_strain", "J/m"), ("axisymmetric", "J/rad"), ("3d", "J")])
def test_energies_have_the_unit_of_the_space_in_table_and_run(tmp_path, name, unit):
    write_quantities(tmp_path, [], SPACES[name])
    HistoryWriter(tmp_path).close()
    (tmp_path / "scene.toml").write_text(f'space = "{name}"\n')
    with (tmp_path / "quantities.csv").open(newline="") as table:
        rows = {row["name"]: row for row in csv.DictReader(table)}
    energies = [one for one, row in rows.items() if row["unit"].startswith("J")]
    assert len(energies) == 14
    assert {rows[one]["unit"] for one in energies} == {unit}
    per = {"J/m": "kinetic energy per width in", "J/rad": "kinetic energy per radian in", "J": "kinetic energy in"}
    assert rows["kinetic_energy"]["doc"].startswith(per[unit])
    assert not any("{" in row["doc"] for row in rows.values())
    assert Run(tmp_path).units == {one.name: rows[one.name]["unit"] for one in history_columns()}


def test_the_runout_in_axisymmetry_is_the_radius_of_98_percent():
    shape = pile_shape([half_section()], Measure(0.0, CELL, points_per_cell=4.0))
    assert shape.runout == pytest.approx(math.sqrt(0.98) * RADIUS, abs=SPACING)
    assert shape.front_left == pytest.approx(0.1 * RADIUS, abs=SPACING)
    assert shape.center_of_mass_height == pytest.approx(HEIGHT / 2)


def test_the_top_in_axisymmetry_does_not_depend_on_how_far_from_the_axis_it_is():
    flat = half_section()
    for columns in (slice(0, 4), slice(-4, None)):
        r = np.unique(flat.positions[0])[columns]
        raised = body_in(
            AXISYMMETRIC,
            np.concatenate([flat.positions, [r, np.full(4, 2.0)]], axis=1),
            np.append(flat.masses, 1000.0 * SPACING**2 * r),
        )
        assert pile_shape([raised], Measure(0.0, CELL, points_per_cell=4.0)).height == 2.0


@pytest.mark.parametrize(
    ("signs", "center"),
    [
        (((1, 1),), (0.0, 0.0)),
        (((1, 1), (1, -1)), (0.0, 0.5)),
        (((1, 1), (-1, 1), (1, -1), (-1, -1)), (0.3, 0.2)),
    ],
)
def test_a_quarter_a_half_and_a_whole_cylinder_have_one_shape_that_of_axisymmetry(signs, center):
    shape = shape_3d(cylinder(signs, center), Middle(center, (True, True)))
    axisymmetric = pile_shape([half_section()], Measure(0.0, CELL, points_per_cell=4.0))
    assert shape.runout == pytest.approx(axisymmetric.runout, abs=0.6 * SPACING)
    assert shape.center_of_mass_height == pytest.approx(HEIGHT / 2)
    assert shape.height == pytest.approx(HEIGHT - SPACING / 2)


def test_the_way_along_a_slab_is_none_of_its_spreading():
    points = cylinder()
    slab = shape_3d(points, Middle((0.0, 0.0), (True, False)))
    away = np.sort(np.abs(points[0]))
    assert slab.runout == pytest.approx(away[int(0.98 * len(away))], abs=1e-9)


def box(lower, upper, **boundary):
    """A scene in 3D with one box in a domain of 1.0 x 0.8 x 0.6 m."""
    content = changed(BLOCK, {"space": "3d", "gravity": [0.0, 0.0, -9.81], "grid.upper": [1.0, 0.8, 0.6]})
    content["body"][0] |= {"shape": {"kind": "box", "lower": lower, "upper": upper}}
    return Scene.from_dict({**content, "boundary": boundary})


@pytest.mark.parametrize(
    ("lower", "upper", "boundary", "place", "spreads"),
    [
        ([0.0, 0.0, 0.0], [0.3, 0.2, 0.2], {}, (0.0, 0.0), (True, True)),
        ([0.7, 0.6, 0.0], [1.0, 0.8, 0.2], {}, (1.0, 0.8), (True, True)),
        ([0.0, 0.3, 0.0], [0.3, 0.5, 0.2], {"left": "no_slip"}, (0.15, 0.4), (True, True)),
        ([0.2, 0.0, 0.0], [0.6, 0.8, 0.2], {}, (0.4, 0.4), (True, False)),
        ([0.2, 0.0, 0.0], [0.6, 0.8, 0.2], {"front": "periodic", "back": "periodic"}, (0.4, 0.4), (True, False)),
        ([0.0, 0.0, 0.0], [1.0, 0.8, 0.2], {}, (0.5, 0.4), (True, False)),
    ],
)
def test_the_middle_lies_in_planes_of_symmetry(lower, upper, boundary, place, spreads):
    middle = middle_of(box(lower, upper, **boundary))
    assert middle.place == pytest.approx(place)
    assert middle.spreads == spreads


def drawn(positions, values, cut):
    """The image of a cut, its extent and the area [m2] that it covers."""
    image = draw_points(Figure().subplots(), positions, values, SPACING, ColorScale("copper", 0.0, 1.0), cut=cut)
    left, right, bottom, top = image.get_extent()
    pixels = image.get_array()
    pixel = (right - left) * (top - bottom) / pixels.size
    return pixels, (left, right, bottom, top), pixel * np.count_nonzero(~np.ma.getmaskarray(pixels))


def test_an_axisymmetric_section_is_mirrored_at_the_axis():
    x, y = half_section().positions
    pixels, (left, right, *_), area = drawn(np.column_stack([x, y, 0 * x]), x / RADIUS, Cut(is_mirrored=True))
    assert area == pytest.approx(2.0 * RADIUS * HEIGHT, rel=0.07)
    assert left == pytest.approx(-right, abs=0.01)
    row = pixels[pixels.shape[0] // 2]
    shown = row.compressed()
    np.testing.assert_allclose(shown[2:-2], shown[::-1][2:-2], atol=2 * SPACING)
    assert shown[2] > 0.9
    assert shown.min() < 0.1


@pytest.mark.parametrize("along", [0, 1])
def test_a_cut_through_a_ball_is_a_disc_of_the_points_there(along):
    lattice = np.arange(-RADIUS + SPACING / 2, RADIUS, SPACING)
    points = np.column_stack([one.ravel() for one in np.meshgrid(lattice, lattice, lattice)])
    ball = points[np.linalg.norm(points, axis=1) < RADIUS]
    normal = 1 - along
    values = np.abs(ball[:, normal])
    for place in (0.0, 0.6):
        pixels, _, area = drawn(ball, values, Cut(along, 2, normal, place))
        assert area == pytest.approx(math.pi * (RADIUS**2 - place**2), rel=0.1)
        np.testing.assert_allclose(pixels.compressed(), place, atol=1.1 * SPACING)
    pixels, _, area = drawn(ball, values, Cut(along, 2, normal, 1.5))
    assert area == 0.0


def write_run_3d(folder):
    """The run of a quarter of a cylinder that becomes twice as wide and a quarter as high."""
    folder.mkdir()
    sides = "".join(f'[boundary.{side}]\nkind = "free_slip"\n' for side in ("left", "right", "front", "back"))
    grid = f"[grid]\ncell_size = {CELL}\nlower = [0.0, 0.0, 0.0]\nupper = [2.5, 2.5, 1.0]\n"
    (folder / "scene.toml").write_text(f'space = "3d"\n{grid}{sides}')
    series, history = FrameSeries(folder), HistoryWriter(folder)
    for number in range(3):
        stretch = 1.0 + number / 2
        places = (cylinder(((1, 1),)) * [[stretch], [stretch], [stretch**-2]]).T
        strain = Field("shear_strain", "1", "", 1.5 * number * np.hypot(*places[:, :2].T) / (stretch * RADIUS))
        series.write(Frame(0.1 * number, number, places, (strain,)))
        row = {column.name: 0 for column in history_columns()}
        history.append(row | {"t": 0.1 * number, "step": number, "runout": stretch})
    history.close()
    return folder


def browns(picture):
    """The share of the pixels of a picture that have a colour, neither grey nor white."""
    pixels = imread(picture)[..., :3]
    return np.mean(np.ptp(pixels, axis=2) > 0.1)


def test_a_run_in_3d_gets_a_view_and_cuts(tmp_path):
    folder = write_run_3d(tmp_path / "run")
    assert [path.name for path in write_run_pictures(folder)] == ["final.png", "history.png", "snapshots.png"]
    assert 0.15 < browns(folder / "final.png") < 0.6
    assert browns(folder / "snapshots.png") > 0.03


@pytest.mark.parametrize(
    "spoilt", ["", "[grid]\ncell_size = 0.1\n", "boundary = 3\n[grid]\nlower = 3\nupper = [1.0]\n"]
)
def test_a_scene_that_does_not_tell_its_domain_is_refused_in_a_line(tmp_path, spoilt):
    folder = write_run_3d(tmp_path / "run")
    (folder / "scene.toml").write_text(f'space = "3d"\n{spoilt}')
    with pytest.raises(InputError, match=r"scene\.toml does not tell the domain and its sides"):
        write_run_pictures(folder)


# In the place of the program that draws: it says that it did but has not, dies as where a library of graphics is
# missing, leaves what is no picture, or never ends.
@pytest.mark.parametrize(
    "program",
    [
        "",
        "import os; os.abort()",
        "import pathlib, sys; (pathlib.Path(sys.argv[1]) / 'view_000000.png').write_text('none')",
        "import time; time.sleep(60)",
    ],
)
def test_where_nothing_can_be_rendered_points_stand_in(tmp_path, monkeypatch, program):
    broken = tmp_path / "render_points.py"
    broken.write_text(program)
    monkeypatch.setattr(rendering, "PROGRAM", broken)
    monkeypatch.setattr(rendering, "LONGEST_WAIT", 1.0)
    points = cylinder(((1, 1),)).T
    scale = ColorScale("copper", 0.0, 1.0)
    view = rendering.View(points, points[:, 0], SPACING, scale, np.array([[0.0] * 3, [2.5, 2.5, 1.0]]))
    assert rendering.rendered(view) is None
    figure = Figure()
    (place,) = figure.add_gridspec(1, 1)
    axes = rendering.draw_view(figure, place, view, None, 3.0)
    (shown,) = axes.collections
    x, y, z = (np.asarray(one) for one in shown._offsets3d)
    # What the front, the right and the top show, and nothing from inside.
    assert len(x) < 0.5 * len(points)
    outside = (y < SPACING) | (z > HEIGHT - SPACING) | (np.hypot(x, y) > RADIUS - 2 * SPACING)
    assert outside.mean() > 0.9


def test_the_program_that_draws_needs_nothing_of_this_library():
    assert "grainlaw" not in rendering.PROGRAM.read_text()
    assert sys.version_info >= (3, 11)  # python -P
