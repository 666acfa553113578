"""The picture of what acts on the obstacles of a run, over time."""

from pathlib import Path

from grainlaw.mpm_core.output.forces import forces_along, read_forces, torques_about
from grainlaw.mpm_core.output.picture_style import PAPER_WIDTH, paper_picture, quantity_label
from grainlaw.mpm_core.output.run_folder import RunFolder

_STYLES = ("-", "--", ":")


def draw_forces(run: RunFolder, path: Path) -> None:
    """Write a picture of the forces and the torques on each obstacle: components by style, obstacles by colour.

    Raises InputError if the run holds no forces.
    """
    forces, space = read_forces(run.path), run.space
    names = [column.removesuffix("_force_x") for column in forces.dtype.names or () if column.endswith("_force_x")]
    panels = [("force on obstacles", f"N{space.amount}", forces_along(space))]
    if torques_about(space):
        panels.append(("torque on obstacles", f"N m{space.amount}", torques_about(space)))
    with paper_picture(path, 0.45 * PAPER_WIDTH, "constrained") as figure:
        for axes, (label, unit, components) in zip(
            figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True
        ):
            for number, name in enumerate(names):
                for component, style in zip(components, _STYLES, strict=False):
                    _, _, direction = component.partition("_")
                    shown = f"{name}, {direction}" if direction else name
                    # The first row is of no interval.
                    time, values = forces["t"][1:], forces[f"{name}_{component}"][1:]
                    axes.plot(time, values, style, color=f"C{number % 10}", label=shown)
            axes.axhline(0.0, color="black", linewidth=0.5)
            axes.set(xlabel="$t$ [s]", ylabel=quantity_label(label, unit))
            axes.legend(fontsize="small", frameon=False)
