"""`grainlaw predict`: a scene with what a calibration left open, as bands."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.options import PluginFiles, counted, load_plugins, stops_told
from grainlaw.cli.scene_options import SceneFile, SetValues, load_scene

if TYPE_CHECKING:
    from grainlaw.studies.predict import Prediction


def predict(
    scene_file: SceneFile,
    source: Annotated[
        Path,
        typer.Option("--from", metavar="parameters.toml", help="What `grainlaw calibrate --out` wrote for a law."),
    ],
    samples: Annotated[int, typer.Option("--samples", metavar="N", help="Draws of the parameters; 19 or more.")] = 64,
    seed: Annotated[int, typer.Option("--seed", metavar="N", help="Of the draws.")] = 0,
    dem: Annotated[
        list[Path] | None,
        typer.Option("--dem", metavar="FILE", help="Grains or an experiment to draw beside; as for `compare --dem`."),
    ] = None,
    set_values: SetValues = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder; default: runs/predict_NAME of the scene.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler; default: processes on this machine."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, metavar="N", help="Processes on this machine; default: its cores.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the runs that are finished.")] = False,
    plugins: PluginFiles = None,
) -> None:
    """Run a scene with draws of what a calibration left open, and show profile, runout and height as bands.

    What parameters and what the resolution of the computation contribute is told apart.
    """
    load_plugins(plugins)
    scene = load_scene(scene_file, set_values)

    from grainlaw.materials.calibration.parameter_file import read_calibrated
    from grainlaw.studies.predict import check_samples
    from grainlaw.studies.predict import predict as predicted
    from grainlaw.studies.prediction_page import write_prediction
    from grainlaw.validation.report.write import prepare

    check_samples(samples)
    calibrated = read_calibrated(source)
    folder = out or Path("runs") / f"predict_{scene_file.stem}"
    prepare(folder)
    with stops_told():
        found = predicted(
            scene,
            calibrated,
            folder,
            samples=samples,
            seed=seed,
            grains=dem or (),
            scheduler=scheduler,
            workers=workers,
            resume=resume,
        )
    references = "".join(f" --dem {path}" for path in dem or ())
    changes = "".join(f" --set {text}" for text in set_values or ())
    command = f"grainlaw predict {scene_file} --from {source} --samples {samples} --seed {seed}{references}{changes}"
    paths = write_prediction(found, folder, f"{command} --out {folder}")
    _print_prediction(found)
    for path in paths[:-1]:
        typer.echo(f"  {path}")


def _print_prediction(found: "Prediction") -> None:
    from grainlaw.cli.dem_report_command import print_table
    from grainlaw.studies.prediction_page import grains_table, notes, result_table

    typer.echo(f"{counted(found.finished_draws, 'draw')} of {', '.join(found.calibrated.table.drawn)}")
    print_table(result_table(found))
    if found.grains:
        print_table(grains_table(found))
    for note in notes(found):
        typer.echo(f"note: {note}")
