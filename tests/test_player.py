"""The page that plays a run: what it holds, that it stays small, and what a browser shows of it."""

import json
import re
import shutil
import subprocess
from base64 import b64decode

import numpy as np
import pytest
from matplotlib.image import imread
from scenes_for_tests import call_command_line
from synthetic_run import FRAMES, frame
from test_film import add_obstacle, few_frames, grey_columns, panel, write_domain
from test_output_spaces import HEIGHT, RADIUS, write_run_3d

from grainlaw.face.runs import Run
from grainlaw.materials import InputError
from grainlaw.mpm_core.obstacles.outline import Outline
from grainlaw.mpm_core.output.cut import PLANE
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.history import HistoryWriter
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.vtp import ObstacleFrame
from grainlaw.player import thinning
from grainlaw.player.content import MOST_BYTES, page_content
from grainlaw.player.page import write_page
from grainlaw.player.shapes import Shapes
from grainlaw.player.thinning import FEWEST_POINTS, thinned

CHROMIUM = shutil.which("chromium")
# In the wide window, of a page without a title in 3D.
ABOVE_SCALE = slice(50, 535)
WIDE, NARROW = (1280, 800), (390, 844)
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--virtual-time-budget=3000",
)  # fmt: skip


def unpacked(text, kind):
    return np.frombuffer(b64decode(text), kind)


def places_of(content):
    """The places that a page's content stands for, shape (points of all frames, axes) [m]."""
    lower, upper = np.array(content["lower"]), np.array(content["upper"])
    return lower + unpacked(content["places"], "<u2").reshape(-1, content["axes"]) / 65535 * (upper - lower)


def test_places_and_values_of_all_points_are_there(tmp_path):
    content = page_content(RunFolder(few_frames(tmp_path / "run")))
    frames = [frame(number) for number in (0, 5, 10)]
    assert content["times"] == [0.0, 0.5, 1.0]
    assert content["counts"] == [len(one.positions) for one in frames]
    assert content["notes"] == []
    expected = np.concatenate([one.positions[:, :2] for one in frames])
    np.testing.assert_allclose(places_of(content), expected, atol=0.5 / 65535)
    strain, pressure, velocity = content["fields"]
    assert [one["name"] for one in content["fields"]] == ["shear_strain", "pressure", "velocity"]
    strains = np.concatenate([one.field("shear_strain").values for one in frames])
    levels = unpacked(strain["values"], np.uint8)
    np.testing.assert_allclose(levels / 254 * 3.0, strains, atol=3.0 / 500)
    assert (strain["lower"], strain["upper"]) == (0.0, 3.0)
    assert (pressure["lower"], velocity["lower"]) > (0.0, 0.0)
    assert unpacked(pressure["values"], np.uint8).max() == 254


def test_values_that_are_none_have_no_colour(tmp_path):
    one = frame(0)
    values = np.full(len(one.positions), np.nan)
    values[0] = 7.0
    (tmp_path / "run").mkdir()
    FrameSeries(tmp_path / "run").write(Frame(0.0, 0, one.positions, (Field("dilation", "1", "", values),)))
    (field,) = page_content(RunFolder(tmp_path / "run"))["fields"]
    assert unpacked(field["values"], np.uint8).tolist() == [0] + [255] * (len(values) - 1)
    assert field["lower"] == 7.0


@pytest.mark.parametrize(("frames", "points"), [(31, 4000), (31, 1_000_000), (1000, 20_000), (100_000, 50)])
def test_a_page_stays_small_and_says_what_it_leaves_out(frames, points):
    size = 12
    found = thinned([points] * frames, size, MOST_BYTES)
    shown = [found.numbers(points) for _ in found.frames[:2]]
    assert len(found.frames) * len(shown[0]) * size <= 1.01 * MOST_BYTES
    assert found.frames[0] == 0
    assert found.frames[-1] == frames - 1
    assert len(shown[0]) >= min(points, 0.99 * FEWEST_POINTS)
    # each point once, the same in all frames, evenly among neighbours
    assert (np.diff(shown[0]) > 0).all()
    assert (shown[0] == shown[1]).all()
    assert np.diff(shown[0]).max() <= 2 * max(1.0, found.points_each) + 1
    left_out = [len(found.frames) < frames, len(shown[0]) < points]
    assert [any(word in note for note in found.notes) for word in ("frames", "points")] == left_out


def test_thinned_points_are_drawn_larger(tmp_path, monkeypatch):
    monkeypatch.setattr(thinning, "FEWEST_POINTS", 100)
    run = RunFolder(few_frames(tmp_path / "run"))
    whole, thin = page_content(run), page_content(run, most_bytes=sum(page_content(run)["counts"]) * 7 // 4)
    assert sum(thin["counts"]) == pytest.approx(sum(whole["counts"]) / 4, rel=0.01)
    assert thin["spacing"] == pytest.approx(2 * whole["spacing"], rel=0.01)
    assert thin["notes"] == ["Shown is one of 4 points, drawn larger."]


def test_an_obstacle_that_stands_is_kept_once_and_one_that_moves_keeps_its_triangles():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float64)
    faces = [np.array(face) for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    shapes = Shapes(PLANE)
    stands = ObstacleFrame(0.0, False, Outline(points, faces))
    for time in (0.0, 0.1):
        shapes.add([stands, ObstacleFrame(time, False, Outline(points + 2.0 + time, faces))], in_3d=True)
    content = shapes.content([0, 1])
    assert content["frames"] == [[0, 1], [0, 2]]
    assert len(content["outlines"]) == 3
    (solid,) = content["solids"]
    assert len(unpacked(solid["edges"], "<u4")) == 2 * 6
    # of a square of two triangles the diagonal is no edge
    flat = Shapes(PLANE)
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float64)
    flat.add([ObstacleFrame(0.0, False, Outline(square, [np.array([0, 1, 2]), np.array([0, 2, 3])]))], in_3d=True)
    edges = unpacked(flat.content([0])["solids"][0]["edges"], "<u4").reshape(-1, 2).tolist()
    assert sorted(edges) == [[0, 1], [0, 3], [1, 2], [2, 3]]


def test_names_cannot_become_part_of_the_page(tmp_path):
    folder = few_frames(tmp_path / "<b>run", numbers=(0,))
    title = "</script><script>alert(1)</script> & <i>"
    (folder / "scene.toml").write_text(f"title = '{title}'\n")
    text = write_page(RunFolder(folder), tmp_path / "a.html").read_text()
    assert text.count("<script") == text.count("</script>") == 2
    assert "<b>" not in text
    assert "<i>" not in text
    content = re.search(r'<script type="application/json" id="content">(.*?)</script>', text, re.DOTALL)[1]
    assert json.loads(content)["title"] == title
    assert not re.search(r'(src|href)="(?!data:,")|@import|url\(', text)


def test_the_command_and_python_write_the_page_into_the_folder(tmp_path, monkeypatch, capsys):
    folder = few_frames(tmp_path / "run", numbers=(0,))
    HistoryWriter(folder).close()
    assert call_command_line(monkeypatch, "view", folder) == 0
    assert capsys.readouterr().out == f"  {folder / 'view.html'}\n"
    assert Run(folder).view(tmp_path / "a.html").read_bytes() == (folder / "view.html").read_bytes()
    with pytest.raises(InputError, match=r"a\.avi: a film ends in \.mp4 or \.gif"):
        Run(folder).movie(tmp_path / "a.avi")
    assert call_command_line(monkeypatch, "view", folder, "--out", tmp_path / "a.pdf") == 2
    assert capsys.readouterr().err == f"error: {tmp_path / 'a.pdf'}: the page ends in .html\n"
    assert call_command_line(monkeypatch, "view", tmp_path) == 2
    assert "holds no run.pvd" in capsys.readouterr().err


def shown(page, address, window, folder):
    """What a browser shows of a page: its pixels, shape (rows, columns, 3), and its elements after a while."""
    picture = folder / "shown.png"
    where = (f"--user-data-dir={folder / 'profile'}", f"--window-size={window[0]},{window[1]}")
    command = [CHROMIUM, *FLAGS, *where, f"--screenshot={picture}", "--dump-dom", f"{page.as_uri()}{address}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert re.search(r'id="fault"[^>]*hidden', done.stdout)
    pixels = imread(picture)[..., :3]
    assert pixels.shape == (window[1], window[0], 3)
    # nothing is wider than the window
    assert (pixels[:, -4:] > 0.99).all()
    return pixels, done.stdout


def body(picture):
    """Where a picture has the colours of the scale, from black to light brown."""
    return picture[..., 2] < 0.55


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page of a column that becomes two and a half times as wide, beside an obstacle that moves to the right."""
    folder = few_frames(tmp_path_factory.mktemp("page") / "run", numbers=range(FRAMES))
    write_domain(folder)
    add_obstacle(folder, [(-0.4 + 0.05 * number, 0.5) for number in range(FRAMES)])
    return write_page(RunFolder(folder), folder / "view.html")


needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")


@needs_browser
@pytest.mark.parametrize("window", [WIDE, NARROW], ids=["wide", "narrow"])
def test_a_browser_shows_each_frame(page, tmp_path, window):
    first, elements = shown(page, "#frame=0", window, tmp_path)
    assert 'data-frame="0"' in elements
    last, elements = shown(page, "#frame=10", window, tmp_path)
    assert 'data-frame="10"' in elements
    assert "t = 1.00 s" in elements
    panels = [panel(one) for one in (first, last)]
    widths = [np.median(body(one[-15:-5]).sum(axis=1)) for one in panels]
    np.testing.assert_allclose(widths, panels[0].shape[1] * np.array([0.4, 1.0]) / 1.06, rtol=0.05)
    moved = np.subtract(*[grey_columns(one).mean() for one in (last, first)])
    assert moved == pytest.approx(0.5 / 1.06, abs=0.02)


@needs_browser
def test_a_browser_plays_to_the_end(page, tmp_path):
    _, elements = shown(page, "#field=pressure&play", NARROW, tmp_path)
    assert 'data-frame="10"' in elements
    assert ">Play</button>" in elements
    assert re.search(r'id="quantity">pressure<', elements)


@needs_browser
def test_a_run_in_3d_is_turned_by_its_buttons(tmp_path):
    path = write_page(RunFolder(write_run_3d(tmp_path / "run")), tmp_path / "a.html")
    # as somebody would, who presses the button
    press = "<script>document.querySelector('[data-view=front]').click();</script></body>"
    path.write_text(path.read_text().replace("</body>", press))
    front, elements = shown(path, "#frame=2", WIDE, tmp_path)
    assert 'data-frame="2"' in elements
    drawn = body(front[ABOVE_SCALE])
    rows, columns = np.flatnonzero(drawn.sum(axis=1) > 200), np.flatnonzero(drawn.sum(axis=0) > 60)
    # twice as wide and a quarter as high as 1 m and 0.6 m, and balls of 0.085 m around the points
    shape = (0.25 * (HEIGHT - 0.05) + 0.085) / (2.0 * (RADIUS - 0.05) + 0.085)
    assert len(rows) / (columns[-1] - columns[0] + 1) == pytest.approx(shape, rel=0.05)
