"""Films of runs: how many pictures, what they show where, in each space; and what is refused."""

import re
from dataclasses import replace

import imageio_ffmpeg
import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image, ImageSequence
from scenes_for_tests import BLOCK, call_command_line, changed
from synthetic_run import FRAMES, SPACING, frame, write_run
from test_output_spaces import write_run_3d

from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.obstacles.outline import Outline
from grainlaw.mpm_core.output import rendering
from grainlaw.mpm_core.output.film import rate, write_film
from grainlaw.mpm_core.output.film_contents import film_contents
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.frame_series import FrameFile, FrameSeries, write_collection
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.vtp import ObstacleFrame, write_vtp

GREY = 0.72


def few_frames(folder, growth=1.5, numbers=(0, 5, 10)):
    """A synthetic collapse with some of its frames."""
    folder.mkdir()
    series = FrameSeries(folder)
    for number in numbers:
        series.write(frame(number, growth))
    return folder


def film(path, *folders, **options):
    return write_film([(folder.name, RunFolder(folder)) for folder in folders], path, **options)


def pictures_of(path):
    """The pictures of a film, shape (pictures, rows, columns, 3), between 0 and 1."""
    if path.suffix == ".gif":
        with Image.open(path) as image:
            return np.array([np.asarray(one.convert("RGB")) for one in ImageSequence.Iterator(image)]) / 255.0
    reader = imageio_ffmpeg.read_frames(path)
    columns, rows = next(reader)["size"]
    return np.array([np.frombuffer(one, np.uint8).reshape(rows, columns, 3) for one in reader]) / 255.0


def panel(picture):
    """The part of a picture inside the frame of its axes, which the longest black lines are."""
    dark = picture.max(axis=2) < 0.3
    rows = np.flatnonzero(dark.mean(axis=1) > 0.5)
    columns = np.flatnonzero(dark[rows[0] : rows[-1]].all(axis=0))
    return picture[rows[0] + 2 : rows[-1] - 1, columns[0] + 2 : columns[-1] - 1]


def extent(drawn):
    """The share of the width over which something is drawn, by the first and last column with it."""
    columns = np.flatnonzero((drawn.min(axis=2) < 0.9).any(axis=0))
    return columns[0] / drawn.shape[1], (columns[-1] + 1) / drawn.shape[1]


def test_a_video_is_h264_with_a_picture_for_each_frame(tmp_path, monkeypatch, capsys):
    folder = few_frames(tmp_path / "run")
    assert call_command_line(monkeypatch, "movie", folder) == 0
    path = folder / "movie.mp4"
    assert capsys.readouterr().out == f"  {path}\n"
    described = next(imageio_ffmpeg.read_frames(path))
    assert described["codec"] == "h264"
    assert described["pix_fmt"].startswith("yuv420p")
    assert described["fps"] == rate(3) == 10.0
    pictures = pictures_of(path)
    assert len(pictures) == 3
    assert pictures.shape[2] == 1280
    assert pictures.shape[1] % 2 == 0
    # the body stands from -0.2 to 0.2 m, at the end over the whole width of 1 m, less some air
    widths = [np.subtract(*extent(panel(picture))[::-1]) for picture in pictures]
    np.testing.assert_allclose(widths, np.array([0.4, 0.7, 1.0]) / 1.06, atol=0.02)
    assert [path.name for path in folder.glob(".partial*")] == []


def test_colours_mean_the_same_in_all_pictures(tmp_path):
    pictures = pictures_of(film(tmp_path / "a.gif", few_frames(tmp_path / "run")))
    copper = colormaps["copper"]([0.0, 0.5, 1.0])[:, :3]
    for picture, last in zip(pictures, copper, strict=True):
        drawn = panel(picture)
        left, right = extent(drawn)
        row = drawn[-8]
        np.testing.assert_allclose(row[int(right * len(row)) - 3], last, atol=0.05)
        np.testing.assert_allclose(row[len(row) // 2], copper[0], atol=0.05)
        assert left == pytest.approx(1.0 - right, abs=0.01)
    # the bar on the right stays, and so does what is around the panel but for the time above it
    assert (pictures[:, :, -90:] == pictures[0, :, -90:]).all()
    assert (pictures[:, -30:, :-90] == pictures[0, -30:, :-90]).all()
    assert (pictures[1:, :20, :120] != pictures[:-1, :20, :120]).any(axis=(1, 2, 3)).all()


def test_runs_stand_side_by_side_or_below_one_another_at_equal_times(tmp_path):
    folders = [few_frames(tmp_path / name, growth) for name, growth in (("a", 1.5), ("b", 0.0))]
    row = pictures_of(film(tmp_path / "row.gif", *folders, side_by_side=True))
    column = pictures_of(film(tmp_path / "column.gif", *folders))
    assert len(row) == len(column) == 3
    assert row.shape[2] == column.shape[2] == 900
    assert column.shape[1] > 2.5 * row.shape[1]
    brown = (np.ptp(row, axis=3) > 0.15) & (np.arange(900) < 760)
    # the second one does not spread, but strains
    counts = [[half.sum() for half in np.split(one, [400], axis=1)] for one in brown]
    assert counts[0] == [0, 0]
    assert min(counts[2]) > 100


def add_obstacle(folder, places):
    """A square of 0.1 m at a place for each frame, as a run with obstacles writes it."""
    corners = np.array([(-0.05, -0.05, 0.0), (0.05, -0.05, 0.0), (0.05, 0.05, 0.0), (-0.05, 0.05, 0.0)])
    files = []
    for number, (time, place) in enumerate(zip(RunFolder(folder).frame_times, places, strict=True)):
        files.append(FrameFile(float(time), folder / f"obstacle_it_{number:06d}.vtp"))
        outline = Outline(np.add(corners, [*place, 0.0]), [np.arange(4)])
        write_vtp(files[-1].path, ObstacleFrame(float(time), False, outline))
    write_collection(folder / "obstacles.pvd", files)
    return folder


def write_domain(folder, space="plane_strain"):
    (folder / "scene.toml").write_text(f'space = "{space}"\n[grid]\nlower = [0.0, 0.0]\nupper = [1.0, 0.7]\n')


def grey_columns(picture):
    """Where in its panel the left half of a picture has the colour of obstacles, as shares of the width."""
    drawn = panel(picture)
    is_grey = (np.abs(drawn - GREY) < 0.04).all(axis=2)
    return np.flatnonzero(is_grey.sum(axis=0) > 10) / drawn.shape[1]


def test_obstacles_are_where_they_are_at_that_time_and_sections_are_mirrored(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    series = FrameSeries(folder)
    for number in (0, 10):
        one = frame(number)
        is_right = one.positions[:, 0] > 0
        fields = tuple(replace(field, values=field.values[is_right]) for field in one.fields)
        series.write(replace(one, positions=one.positions[is_right], fields=fields))
    write_domain(folder, "axisymmetric")
    add_obstacle(folder, [(0.1, 0.6), (0.4, 0.6)])
    pictures = pictures_of(film(tmp_path / "a.gif", folder))
    for picture, radius in zip(pictures, (0.1, 0.4), strict=True):
        columns = grey_columns(picture)
        # 1 m of body and 6 % of air
        left, right = columns[columns < 0.5], columns[columns > 0.5]
        assert right.mean() - 0.5 == pytest.approx(radius / 1.06, abs=0.01)
        assert 0.5 - left.mean() == pytest.approx(radius / 1.06, abs=0.01)


def test_a_run_whose_material_has_all_left_is_shown_to_its_end(tmp_path):
    folder = few_frames(tmp_path / "run", numbers=(0,))
    empty = Frame(0.1, 1, np.empty((0, 3)), (Field("shear_strain", "1", "", np.empty(0)),))
    FrameSeries(folder).write(empty)
    pictures = pictures_of(film(tmp_path / "a.gif", folder))
    assert extent(panel(pictures[0]))
    assert panel(pictures[1]).min() > 0.9


@pytest.mark.parametrize("can_draw", [True, False])
def test_a_run_in_3d_is_seen_from_one_place(tmp_path, monkeypatch, can_draw):
    if not can_draw:
        broken = tmp_path / "render_points.py"
        broken.write_text("import os; os.abort()")
        monkeypatch.setattr(rendering, "PROGRAM", broken)
    pictures = pictures_of(film(tmp_path / "a.gif", write_run_3d(tmp_path / "run")))
    assert len(pictures) == 3
    body = (np.ptp(pictures, axis=3) > 0.15) & (np.arange(900) < 740) & (np.arange(900) > 100)
    assert 300 < body[1].sum() < body[2].sum()
    # its middle, at the corner of the quarter, does not move
    first_columns = [np.flatnonzero(one.any(axis=0))[0] for one in body[1:]]
    assert abs(first_columns[0] - first_columns[1]) < 60


def refusals(tmp_path):
    run_a = few_frames(tmp_path / "a")
    shorter = few_frames(tmp_path / "b", numbers=(0, 5))
    axisymmetric = few_frames(tmp_path / "c")
    write_domain(axisymmetric, "axisymmetric")
    nothing = tmp_path / "d"
    nothing.mkdir()
    return {
        "ending": ((run_a, "--out", tmp_path / "f.avi"), r"f\.avi: a film ends in \.mp4 or \.gif"),
        "field": ((run_a, "--field", "presure"), r"/a: no field 'presure'.*did you mean 'pressure'\?"),
        "frames": ((nothing,), "d holds no run.pvd: no frame of a run was written there"),
        "folder": ((tmp_path / "e",), "run folder .*e does not exist"),
        "times": ((run_a, shorter), r"b has 2 frames up to 0\.5 s, .*a 3 frames up to 1 s: a film shows runs at equal"),
        "spaces": ((run_a, axisymmetric), "c is in axisymmetric, .*a in plane_strain: a film shows runs in one space"),
    }


def test_what_makes_no_film_is_refused_in_a_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for arguments, message in refusals(tmp_path).values():
        assert call_command_line(monkeypatch, "movie", *arguments) == 2
        printed = capsys.readouterr()
        assert printed.err.count("\n") == 1
        assert re.search(message, printed.err)
    assert [*tmp_path.rglob("movie.*")] == []


def test_without_an_encoder_a_line_says_so_and_the_old_film_stays(tmp_path, monkeypatch):
    folder, path = few_frames(tmp_path / "run"), tmp_path / "a.mp4"
    path.write_text("old")
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "none"))
    with pytest.raises(InputError, match=r"a\.mp4: a film in \.mp4 needs ffmpeg.*\.gif needs none"):
        film(path, folder)
    fails = tmp_path / "fails"
    fails.write_text("#!/bin/sh\nexit 1\n")
    fails.chmod(0o755)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(fails))
    with pytest.raises(SimulationError, match=r"a\.mp4: ffmpeg (stopped|wrote 0 of 3 frames)"):
        film(path, folder)
    assert path.read_text() == "old"
    assert [*tmp_path.glob(".partial*")] == []


def test_the_scale_of_a_field_is_that_of_all_frames(tmp_path):
    runs = [(name, RunFolder(write_run(tmp_path / name, growth))) for name, growth in (("a", 1.5), ("b", 0.5))]
    contents = film_contents(runs, ["velocity", "shear_strain"])
    (_, velocity), (_, strain) = contents.fields
    # speeds are those of places, the largest at the top of the column at the start
    assert 0.3 < velocity.upper < 0.5
    assert (strain.lower, strain.upper) == (0.0, 3.0)
    assert contents.box[1] == pytest.approx(0.5 + 0.03 * 1.0, abs=2 * SPACING)
    assert len(contents.times) == FRAMES
    assert contents.decimals == 2


QUICK = changed(BLOCK, {"time.end": 0.02, "output": {"pictures": False, "movie": True, "interval": 0.01}})


def test_a_scene_may_ask_for_a_film_and_a_run_is_not_lost_with_it(tmp_path, monkeypatch):
    run(Scene.from_dict(QUICK), tmp_path / "run")
    assert imageio_ffmpeg.count_frames_and_secs(tmp_path / "run" / "movie.mp4")[0] == 3
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "none"))
    with pytest.warns(InputWarning, match="run is finished, its film is not made: .* needs ffmpeg"):
        run(Scene.from_dict(QUICK), tmp_path / "run", overwrite=True)
    assert RunFolder(tmp_path / "run").summary.simulated_time == 0.02
    assert not (tmp_path / "run" / "movie.mp4").exists()
    with pytest.raises(InputError, match="movie = true needs the frames"):
        Scene.from_dict(changed(QUICK, {"output.vtu": False}))
