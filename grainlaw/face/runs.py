"""Running a scene from a script or notebook, and reading what a run left in its folder."""

from base64 import b64encode
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from grainlaw.face.display import html_table
from grainlaw.face.scenes import SceneSource, as_scene
from grainlaw.face.tables import data_frame
from grainlaw.materials.errors import InputError, nearest_name
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.history import HISTORY_NAME, history_columns
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.summary import RunSummary

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from pyvista import PolyData


class Run:
    """What a run left in its folder; each part is read when it is first asked for.

    Raises InputError if there is no run in such a folder, and on access if a part is missing or broken.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = RunFolder(Path(folder))
        """The folder opened for reading."""
        if not (self.path / HISTORY_NAME).is_file():
            raise InputError(f"{self.path} holds no run")

    @property
    def path(self) -> Path:
        """Where the folder lies."""
        return self.folder.path

    @property
    def summary(self) -> RunSummary:
        """What the run was, what it led to and what it cost; the keys of summary.json."""
        return self.folder.summary

    @property
    def history(self) -> dict[str, NDArray[Any]]:
        """Scalars of the whole run by name: t, runout, height, energies, ...; each of shape (rows,)."""
        history = self.folder.history
        return {name: history[name] for name in history.dtype.names or ()}

    @property
    def units(self) -> dict[str, str]:
        """The SI unit of each column of the history by name."""
        return {column.name: column.unit for column in history_columns(self.folder.space)}

    def to_frame(self) -> "DataFrame":
        """The history as a pandas table, with the units in its `attrs`. Raises InputError without pandas."""
        return data_frame(self.history, self.units)

    @property
    def frame_times(self) -> NDArray[Any]:
        """The times [s] at which all points were written, shape (frames,)."""
        return self.folder.frame_times

    def frame(self, index: int = -1) -> Frame:
        """The points at one of the frame times, by default the last: positions, and fields by name."""
        return self.folder.load_frame(index)

    def to_pyvista(self, index: int = -1) -> "PolyData":
        """The same as points of pyvista, with a point array for each field."""
        from grainlaw.face.point_cloud import point_cloud

        return point_cloud(self.frame(index))

    @property
    def pictures(self) -> dict[str, Path]:
        """The files of the pictures that the run drew, by name: final, history, snapshots."""
        return {path.stem: path for path in sorted(self.path.glob("*.png"))}

    def movie(self, path: str | Path | None = None, field: str | None = None) -> Path:
        """Make a film of the frames and return its file: .mp4 or .gif, by default movie.mp4 in the folder.

        `field` is what colours show, by default that of the pictures. Raises InputError for another ending, an unknown
        field, and where nothing encodes the film.
        """
        from grainlaw.mpm_core.output.film import FILM_NAME, write_film

        return write_film([(self.path.resolve().name, self.folder)], Path(path or self.path / FILM_NAME), field)

    def view(self, path: str | Path | None = None) -> Path:
        """Write the page that plays the frames in a browser and return its file, by default view.html in the folder."""
        from grainlaw.player.page import PAGE_NAME, write_page

        return write_page(self.folder, Path(path or self.path / PAGE_NAME))

    def plot(self, *names: str, path: str | Path | None = None) -> "Figure":
        """Columns of the history over time, by default runout and heights; written to `path` if one is given."""
        from grainlaw.face.figure import NotebookFigure

        history = self.history
        chosen = names or ("runout", "height", "center_of_mass_height")
        figure = NotebookFigure(figsize=(6.4, 3.6), layout="constrained")
        axes = figure.subplots()
        for name in chosen:
            if name not in history:
                raise InputError(f"no column '{name}' in the history of {self.path}; {nearest_name(name, history)}")
            axes.plot(history["t"], history[name], label=f"{name.replace('_', ' ')} [{self.units.get(name, '1')}]")
        axes.set_xlabel("t [s]")
        axes.legend(frameon=False)
        if path is not None:
            figure.savefig(path)
        return figure

    def __repr__(self) -> str:
        return f"Run({str(self.path)!r}): " + ", ".join(f"{name} {value}" for name, value in self._facts())

    def _repr_html_(self) -> str:
        table = html_table(["run", str(self.path)], [list(fact) for fact in self._facts()])
        picture = self.pictures.get("final")
        if picture is None:
            return table
        data = b64encode(picture.read_bytes()).decode("ascii")
        return table + f'<img alt="{escape(str(picture))}" style="max-width: 40em" src="data:image/png;base64,{data}">'

    def _facts(self) -> list[tuple[str, str]]:
        try:
            summary = self.summary
        except InputError:
            return [("state", "not finished")]
        final = summary.final
        return [
            ("scene", summary.scene),
            ("material", summary.material),
            ("points", f"{summary.points}"),
            ("time", f"{summary.simulated_time:g} s"),
            ("steps", f"{summary.steps} in {summary.wall_time:.1f} s"),
            ("runout", f"{final.runout:.4f} m"),
            ("height", f"{final.height:.4f} m"),
        ]


def run(
    scene: SceneSource,
    folder: str | Path,
    *,
    threads: int | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> Run:
    """Run a scene into a folder, with a progress bar in terminals and notebooks; return what it left there.

    scene      tables, the path of a TOML file, the name of a shipped scene, or a Scene
    threads    by default the idle cores; the results are the same for any number
    overwrite  replace the run that the folder holds
    resume     go on from the folder's checkpoint

    Raises InputError for what cannot be run or would overwrite a run, and SimulationError, naming the time, the point
    and the last checkpoint, where the computation goes wrong.
    """
    from grainlaw.mpm_core.parallel.threads import usable_threads
    from grainlaw.mpm_core.stepping.run import run as run_scene
    from grainlaw.progress import shown_progress

    described = as_scene(scene)
    with shown_progress(described.time.end) as progress:
        run_scene(
            described,
            Path(folder),
            threads=usable_threads(threads),
            overwrite=overwrite,
            resume=resume,
            progress=progress,
        )
    return Run(folder)


def read_run(folder: str | Path) -> Run:
    """Open a run's folder, finished or still running. Raises InputError if there is none."""
    return Run(folder)
