"""The pictures: which frames they choose, and that bodies look solid and stay in their outline."""

from contextlib import contextmanager
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text
from synthetic_run import COLUMN_HEIGHT, COLUMN_WIDTH, FRAMES, SPACING, frame, history_row, write_run

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.frame import Field
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.history import HistoryWriter
from grainlaw.mpm_core.output.picture_style import color_scale, field_label, paper_picture, scalar_values
from grainlaw.mpm_core.output.pictures import draw_frame, draw_history, write_run_pictures
from grainlaw.mpm_core.output.point_image import ColorScale, draw_points, outline_color, point_spacing
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.snapshots import draw_snapshots, normalized_runout


def drawn(positions, values):
    """The image of the points and the area [m2] that it covers."""
    image = draw_points(Figure().subplots(), positions, values, SPACING, ColorScale("copper", 0.0, 1.0))
    left, right, bottom, top = image.get_extent()
    rows, columns = image.get_array().shape
    pixel_area = (right - left) * (top - bottom) / (rows * columns)
    return image.get_array(), pixel_area * np.count_nonzero(~np.ma.getmaskarray(image.get_array()))


def test_spacing_is_that_of_the_lattice():
    assert point_spacing(frame(0).positions) == pytest.approx(SPACING)


@pytest.mark.parametrize("number", [0, 5, 10])
def test_a_stretched_body_is_drawn_solid_with_its_own_area(number):
    positions = frame(number).positions
    image, area = drawn(positions, np.ones(len(positions)))
    assert area == pytest.approx(2 * COLUMN_WIDTH * COLUMN_HEIGHT, rel=0.07)
    covered = ~np.ma.getmaskarray(image)
    middle = covered[covered.shape[0] // 2]
    assert middle[np.flatnonzero(middle)[0] : np.flatnonzero(middle)[-1]].all()


def test_bodies_further_apart_than_four_spacings_stay_apart():
    positions = frame(0).positions.copy()
    positions[positions[:, 0] > 0, 0] += 6 * SPACING
    image, _ = drawn(positions, np.ones(len(positions)))
    middle = ~np.ma.getmaskarray(image)[image.shape[0] // 2]
    assert np.count_nonzero(np.diff(middle.astype(int)) == 1) == 2


def test_colours_sit_where_the_points_are():
    positions = frame(0).positions
    image, _ = drawn(positions, (positions[:, 0] > 0).astype(float))
    half = image.shape[1] // 2
    assert image[:, : half - 20].max() == 0.0
    assert image[:, half + 20 :].min() == 1.0


def test_normalised_runout_runs_from_zero_to_one(tmp_path):
    run = RunFolder(write_run(tmp_path / "run"))
    np.testing.assert_allclose(normalized_runout(run, run.frame_times), np.linspace(0, 1, 11), atol=1e-12)


def test_a_heap_at_rest_has_no_snapshots(tmp_path):
    folder = write_run(tmp_path / "heap", growth=0.0)
    assert [path.name for path in write_run_pictures(folder)] == ["final.png", "history.png"]
    with pytest.raises(InputError, match="never grew"):
        draw_snapshots([("heap", RunFolder(folder))], tmp_path / "a.png")
    assert not (tmp_path / "a.png").exists()


def test_a_collapse_gets_all_three_pictures(tmp_path):
    for path in write_run_pictures(write_run(tmp_path / "run")):
        picture = imread(path)[..., :3]
        assert picture.shape[1] == 1800
        assert 0.02 < np.mean(picture.min(axis=2) < 0.5) < 0.9
    assert path.name == "snapshots.png"


def test_several_runs_share_a_picture_with_a_row_each(tmp_path):
    runs = [(name, RunFolder(write_run(tmp_path / name, growth))) for name, growth in (("a", 1.5), ("b", 2.0))]
    draw_snapshots(runs[:1], tmp_path / "one.png")
    draw_snapshots(runs, tmp_path / "two.png")
    draw_history(runs, tmp_path / "history.png")
    assert imread(tmp_path / "two.png").shape[0] > 1.3 * imread(tmp_path / "one.png").shape[0]


@pytest.fixture
def drawn_figures(monkeypatch):
    """The figures of the pictures that a test has drawn, by the names of their files."""
    figures = {}

    @contextmanager
    def kept_picture(path, height, layout):
        with paper_picture(path, height, layout) as figure:
            yield figure
        figures[path.name] = figure

    for module in ("snapshots", "pictures"):
        monkeypatch.setattr(f"grainlaw.mpm_core.output.{module}.paper_picture", kept_picture)
    return figures


def texts_of(figure):
    return {text.get_text() for text in figure.findobj(Text)}


def test_labels_of_a_tall_picture_do_not_overlap_nor_leave_it(tmp_path, drawn_figures):
    names = [f"a_long_name_of_a_law_{count}" for count in range(6)]
    draw_snapshots([(name, RunFolder(write_run(tmp_path / name))) for name in names], tmp_path / "six.png")
    figure = drawn_figures["six.png"]
    figure.draw_without_rendering()
    texts = {text.get_window_extent(): text.get_text() for text in figure.findobj(Text) if text.get_visible()}
    labels = [box for box, text in texts.items() if any(name in text for name in names)]
    assert len(labels) == len(names)
    shown = [*labels, *(box for box, text in texts.items() if "[m]" in text and box not in labels)]
    assert [(texts[a], texts[b]) for a, b in combinations(shown, 2) if a.overlaps(b)] == []
    for box in shown:
        assert 0.0 <= box.x0 < box.x1 <= figure.bbox.x1, texts[box]
        assert 0.0 <= box.y0 < box.y1 <= figure.bbox.y1, texts[box]


def test_a_field_that_the_run_did_not_write_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"no field 'pressur'.*did you mean 'pressure'"):
        draw_frame(frame(0), "pressur", tmp_path / "a.png")


def test_labels_carry_units_and_vectors_are_shown_by_length():
    assert field_label(frame(0).field("pressure")) == "pressure [Pa]"
    assert field_label(frame(0).field("shear_strain")) == "shear strain"
    velocity = frame(3).field("velocity")
    np.testing.assert_allclose(scalar_values(velocity) ** 2, (velocity.values**2).sum(axis=1))


def test_a_uniform_field_still_has_a_colour_scale():
    scale = color_scale([np.full(5, 2.0)], None)
    assert scale.lower == 2.0
    assert scale.upper > scale.lower


@pytest.mark.parametrize(
    ("output", "label"),
    [
        ("", "shear strain"),
        ('picture_field = "pressure"', "pressure [Pa]"),
        ('picture_field = "velocity"', "velocity [m/s]"),
    ],
)
def test_pictures_show_the_field_that_the_scene_chooses(tmp_path, drawn_figures, output, label):
    folder = write_run(tmp_path / "run")
    (folder / "scene.toml").write_text(f"[output]\n{output}\n")
    write_run_pictures(folder)
    for name in ("final.png", "snapshots.png"):
        assert label in texts_of(drawn_figures[name])


def write_two_materials(folder, **laws):
    """A run whose left half is of the first material and whose right half is of the second."""
    bodies = "".join(f'[[body]]\nmaterial = "{name}"\n' for name in laws)
    tables = "".join(f'[material.{name}]\nlaw = "{law}"\n' for name, law in laws.items())
    folder.mkdir()
    series, history = FrameSeries(folder), HistoryWriter(folder)
    for number in range(FRAMES):
        one = frame(number)
        body = Field("body", "1", "number of the body", (one.positions[:, 0] > 0).astype(float))
        series.write(replace(one, fields=(*one.fields, body)))
        history.append(history_row(100 * number))
    history.close()
    (folder / "scene.toml").write_text(bodies + tables)
    return folder


def outlines_of(axes):
    """The colours of the outlines, and the widths of what they enclose [m]."""
    found = [one for one in axes.collections if isinstance(one, ContourSet)]
    return {to_hex(one.get_edgecolor()[0]): np.ptp(np.vstack(one.allsegs[0])[:, 0]) for one in found}


def test_materials_are_told_apart_by_outlines_with_their_names(tmp_path, drawn_figures):
    write_run_pictures(write_two_materials(tmp_path / "run", sand="mu_i_lc", mu_i_mcc="mu_i_mcc"))
    for name in ("final.png", "snapshots.png"):
        figure = drawn_figures[name]
        assert {"sand (mu_i_lc)", "mu_i_mcc"} <= texts_of(figure)
        outlines = outlines_of(figure.axes[2 if name == "snapshots.png" else 0])
        assert list(outlines) == [to_hex(outline_color(number)) for number in (0, 1)]
        # each is half as wide as the body at the end
        assert list(outlines.values()) == pytest.approx([2.5 * COLUMN_WIDTH] * 2, rel=0.1)


def test_one_material_has_no_outline(tmp_path, drawn_figures):
    write_run_pictures(write_two_materials(tmp_path / "one", sand="mu_i_lc"))
    assert outlines_of(drawn_figures["final.png"].axes[0]) == {}
    assert "sand (mu_i_lc)" not in texts_of(drawn_figures["final.png"])


def test_a_material_has_one_colour_in_all_rows(tmp_path, drawn_figures):
    runs = {
        "one": write_two_materials(tmp_path / "one", sand="mu_i_lc", clay="modified_cam_clay"),
        "other": write_two_materials(tmp_path / "other", clay="modified_cam_clay", rock="linear_elastic"),
    }
    draw_snapshots([(name, RunFolder(folder)) for name, folder in runs.items()], tmp_path / "both.png")
    axes = drawn_figures["both.png"].axes
    colors = [to_hex(outline_color(number)) for number in range(3)]
    assert list(outlines_of(axes[0])) == colors[:2]
    assert list(outlines_of(axes[3])) == colors[1:]
    assert {"sand (mu_i_lc)", "clay (modified_cam_clay)", "rock (linear_elastic)"} <= texts_of(
        drawn_figures["both.png"]
    )
