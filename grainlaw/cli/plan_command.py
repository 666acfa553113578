"""`grainlaw plan`: what a scene will use and cost."""

from typing import Annotated

import typer

from grainlaw.cli.options import PluginFiles, counted, load_plugins
from grainlaw.cli.scene_options import SceneFile, SetValues, load_scene


def plan(
    scene_file: SceneFile,
    set_values: SetValues = None,
    threads: Annotated[
        int | None, typer.Option("--threads", min=1, metavar="N", help="Threads; default: idle cores.")
    ] = None,
    plugins: PluginFiles = None,
) -> None:
    """Print size, memory, time step and expected duration of a scene without running it."""
    load_plugins(plugins)
    scene = load_scene(scene_file, set_values)

    from rich.console import Console
    from rich.table import Table

    from grainlaw.mpm_core.parallel.threads import usable_threads
    from grainlaw.mpm_core.stepping.compilation import noticed_compilation
    from grainlaw.mpm_core.stepping.plan import plan as plan_scene
    from grainlaw.progress import say_that_it_compiles

    with noticed_compilation(say_that_it_compiles):
        planned = plan_scene(scene, usable_threads(threads))
    mean_points = 0.5 * (planned.points + planned.points_at_end)
    table = Table(title=scene.title or scene_file.stem, show_header=False)
    rows = {
        "laws": ", ".join(planned.laws),
        "points": _points(planned.points, planned.points_at_end),
        "cells of the domain": f"{planned.cells:,}",
        "active nodes": f"{planned.active_nodes:,}",
        "memory": f"{_megabytes(planned.memory_bytes)}; {planned.bytes_per_point:.0f} bytes per point in arrays",
        "basis, transfer": f"{scene.transfer.basis}, {scene.transfer.scheme}, time constant {scene.blend_time:g} s",
        "time step": f"{planned.step:.3g} s at the start (stable: {planned.critical_time_step:.3g} s)",
        "steps": f"about {planned.steps:,}",
        "rate": f"{mean_points / planned.seconds_per_step / 1e6:.1f} million point-steps/s, "
        f"{counted(planned.threads, 'thread')}",
        "expected duration": f"{planned.wall_time:.1f} s, of which output {planned.output_time:.1f} s",
        "kernels": _kernels(planned.compile_time),
        "frames": f"{planned.frames}",
        "fields of a frame": ", ".join(planned.fields),
        "saved": "; ".join(planned.savings),
    }
    if scene.obstacle:
        near = counted(planned.near_obstacles, "point")
        rows["obstacles"] = f"{near} near {len(scene.obstacle)}, {planned.obstacle_share:.0%} of a step"
    for name, value in rows.items():
        table.add_row(name, value)
    Console(width=110, markup=False).print(table)


def _points(at_start: int, at_end: int) -> str:
    return f"{at_start:,}" if at_end == at_start else f"{at_start:,} at the start, up to {at_end:,} at the end"


def _kernels(compile_time: float) -> str:
    return f"compiled just now, in {compile_time:.0f} s; a run finds them on disk" if compile_time else "on disk"


def _megabytes(memory: int) -> str:
    return f"{memory / 1e6:.0f} MB, all included" if memory else "not told by this system"
