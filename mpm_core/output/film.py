"""Films of runs: their frames one after the other, of several runs together at equal times."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.film_contents import film_contents
from grainlaw.mpm_core.output.film_file import ENDINGS, refuse_without_encoder, write_pictures
from grainlaw.mpm_core.output.film_pictures import Picture, film_pictures
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.shown_field import shown_field

FILM_NAME = "movie.mp4"
# A film lasts this long [s], within the rates that look like motion.
DURATION, SLOWEST, FASTEST = 6.0, 10.0, 30.0
Report = Callable[[int, int], None]


def write_film(
    runs: Sequence[tuple[str, RunFolder]],
    path: Path,
    field: str | None = None,
    *,
    side_by_side: bool = False,
    report: Report | None = None,
) -> Path:
    """Write the film of each (label, run), below one another or side by side; return its path.

    The ending of `path` is that of an H.264 video, `.mp4`, or of an image that moves, `.gif`. `field` is what the
    bodies are coloured by, by default that of the pictures of the first run; the colours mean the same in all frames.
    `report(done, all)` is called after each frame.

    Raises InputError for another ending or no encoder, a field or frames that a run does not have, and runs whose
    frames are of different times or spaces.
    """
    _refuse_path(path)
    refuse_without_encoder(path)
    first = runs[0][1]
    contents = film_contents(runs, [field or shown_field(first, first.load_frame(0))])
    count = len(contents.times)
    path.parent.mkdir(parents=True, exist_ok=True)

    def pictures() -> Iterator[Picture]:
        drawn = film_pictures(contents, ENDINGS[path.suffix.lower()], side_by_side=side_by_side)
        for number, picture in enumerate(drawn):
            yield picture
            if report is not None:
                report(number + 1, count)

    write_pictures(path, pictures(), count, rate(count))
    return path


def rate(frames: int) -> float:
    """The frames per second of a film [1/s]."""
    return min(max(frames / DURATION, SLOWEST), FASTEST)


def _refuse_path(path: Path) -> None:
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: a film ends in {' or '.join(ENDINGS)}")
    if path.is_dir():
        raise InputError(f"{path} is a folder; a film is a file")
