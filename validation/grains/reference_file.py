"""Whatever a user has of grains as an observation: a run's folder, one of its dumps, HDF5, or a table of surfaces."""

from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.validation.grains.observation import Observation, is_observation, read_observation
from grainlaw.validation.grains.observe import observe_dumps, observe_folder
from grainlaw.validation.grains.run_description import RUN_DESCRIPTION_NAME, read_run_description
from grainlaw.validation.grains.surface_table import is_surface_table, read_surface_table


def load_reference(path: Path, grain_diameter: float | None = None) -> Observation:
    """The observation of a folder with run.json, a dump beside one, an HDF5 observation, or a CSV of t, x, h.

    `grain_diameter` [m] is that of a CSV which names none.

    Raises InputError in one line for a missing, damaged or unknown file.
    """
    if path.is_dir():
        return observe_folder(path)
    if not path.is_file():
        raise InputError(f"{path} does not exist")
    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty")
    if is_observation(path):
        return read_observation(path)
    if is_surface_table(path):
        return read_surface_table(path, grain_diameter)
    if not (path.parent / RUN_DESCRIPTION_NAME).is_file():
        raise InputError(
            f"{path} is neither an observation nor a table of t, x, h; a dump of grains needs a {RUN_DESCRIPTION_NAME} "
            "beside it, with depth and grain_density"
        )
    description = read_run_description(path.parent).model_copy(update={"frames": None, "grains_files": path.name})
    return observe_dumps(path.parent, description, path.stem)
