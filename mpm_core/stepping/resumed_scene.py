"""The scene of a run that goes on: the one in its folder, to the same end or a later one."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.recorder import frame_interval, history_interval
from grainlaw.mpm_core.output.run_folder import SCENE_NAME
from grainlaw.mpm_core.output.summary import SUMMARY_NAME, read_summary
from grainlaw.mpm_core.scene.model import Scene

INTERVALS = ("interval", "history_interval")
# More differences are counted.
MOST_NAMED = 5


def resumed_scene(scene: Scene, folder: Path) -> Scene:
    """The scene with the intervals of the run in a folder, where it leaves them open.

    By default they follow from the end: frames of a run that is made longer would fall on other times.
    Raises InputError if the folder holds no run, and, naming the keys, where it holds that of another scene.
    """
    path = folder / SCENE_NAME
    if not path.is_file():
        raise InputError(f"{folder} holds no run to resume")
    begun = Scene.load(path)
    if scene.time.end != begun.time.end:
        begun = _with_intervals(begun, frame_interval(begun), history_interval(begun))
    output = {name: getattr(begun.output, name) for name in INTERVALS if getattr(scene.output, name) is None}
    goes_on = scene.model_copy(update={"output": scene.output.model_copy(update=output)})
    _refuse_another_scene(goes_on, begun, folder)
    return goes_on


def _with_intervals(scene: Scene, frames: float, history: float) -> Scene:
    output = scene.output.model_copy(update=dict(zip(INTERVALS, (frames, history), strict=True)))
    return scene.model_copy(update={"output": output})


def is_finished(scene: Scene, folder: Path) -> bool:
    """Whether the run in a folder has come to the end of its scene."""
    return (folder / SUMMARY_NAME).is_file() and read_summary(folder).simulated_time >= scene.time.end


def _refuse_another_scene(scene: Scene, begun: Scene, folder: Path) -> None:
    there, here = (dict(_by_key(of.model_dump(mode="json"))) for of in (begun, scene))
    if scene.time.end > begun.time.end:
        there["time.end"] = here["time.end"]
    different = [key for key in {**there, **here} if there.get(key) != here.get(key)]
    if not different:
        return
    named = "; also ".join(f"{key} = {there.get(key)} there, {here.get(key)} here" for key in different[:MOST_NAMED])
    more = f" (and {len(different) - MOST_NAMED} more)" if len(different) > MOST_NAMED else ""
    later = "; a time.end may only be later" if "time.end" in different else ""
    raise InputError(f"{folder} holds a run of another scene than the one to resume: {named}{more}{later}")


def _by_key(content: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """The values of nested tables and lists of tables, by dotted key."""
    if isinstance(content, dict):
        entries = list(content.items())
    elif isinstance(content, list) and content and isinstance(content[0], dict):
        entries = [(str(number), entry) for number, entry in enumerate(content)]
    else:
        yield key, content
        return
    for name, entry in entries:
        yield from _by_key(entry, f"{key}.{name}" if key else name)
