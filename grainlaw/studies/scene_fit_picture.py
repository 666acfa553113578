"""The picture of a calibration on a whole scene: profiles of grains, of the start and of the fit, and the residuals."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from grainlaw.materials.atomic import replacing
from grainlaw.materials.calibration.findings import Findings
from grainlaw.studies.ensemble import ESTIMATE
from grainlaw.studies.scene_fit import SceneFit
from grainlaw.validation.grains.distance import surface_at

DATA_COLOUR, FIT_COLOUR, START_COLOUR = "#333333", "#d95f02", "#7570b3"


def draw(findings: Findings, fit: SceneFit, path: Path) -> None:
    """Write the picture, whole or not at all."""
    model = fit.model
    start = model.how.observe(model.folder(f"start-{ESTIMATE}"))
    figure = Figure(figsize=(max(5.2, 4.4 * len(model.places)), 5.0), layout="constrained")
    axes = figure.subplots(2, len(model.places), squeeze=False, sharex="col", height_ratios=(3, 1))
    ends = np.cumsum([len(places.x) for places in model.places])[:-1]
    for places, residuals, (upper, lower) in zip(model.places, np.split(fit.residuals, ends), axes.T, strict=True):
        x = places.grains.x
        upper.plot(x, surface_at(places.grains, places.time, x), color=DATA_COLOUR, lw=1.0, label="grains")
        upper.plot(places.x, places.heights, "o", color=DATA_COLOUR, ms=4, label="measurements")
        upper.plot(x, surface_at(start, places.time, x), color=START_COLOUR, lw=1.0, ls="--", label="start")
        upper.plot(
            places.x, places.heights + residuals * places.size, "o-", color=FIT_COLOUR, ms=3, lw=1.2, label="fit"
        )
        upper.set_title(f"{places.grains.label}, t = {places.time:g} s", fontsize=9)
        upper.set_ylabel("h [m]", fontsize=9)
        upper.legend(frameon=False, fontsize=8)
        lower.axhline(0.0, color=DATA_COLOUR, lw=0.8)
        lower.plot(places.x, 100.0 * residuals, "o", color=FIT_COLOUR, ms=4)
        lower.set_ylabel("(fit - grains)/\nsize [%]", fontsize=9)
        lower.set_xlabel("r [m]" if places.grains.space.hoop else "x [m]", fontsize=9)
        reach = 1.2 * float(np.abs(places.x).max())
        lower.set_xlim(0.0 if places.grains.space.hoop else -reach, reach)
        for one in (upper, lower):
            one.tick_params(labelsize=8)
            one.grid(visible=True, color="#e5e5e5", lw=0.5)
    found = ", ".join(
        f"{one.name} = {one.value:.3g}{'' if one.determined else ' (undetermined)'}" for one in findings.estimates
    )
    figure.suptitle(f"{fit.law.name}: {found}", fontsize=10)
    with replacing(path) as partial:
        figure.savefig(partial, dpi=130)


def notes(fit: SceneFit) -> list[str]:
    """What was done about the noise of the runs."""
    steps = ", ".join(
        f"{100.0 * step:.0f} % of {at.name}" for at, step in zip(fit.coordinates, fit.steps.tolist(), strict=True)
    )
    return [
        f"the profile of a run has a noise of {100.0 * fit.noise:.2g} % of its size from the places of its points; "
        f"differences over {steps}"
    ]
