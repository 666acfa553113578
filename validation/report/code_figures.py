"""Piles of other codes over ours."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from grainlaw.validation.mpm.piles import Pile, PileDistance
from grainlaw.validation.report.grain_figures import COLORS, WIDTH
from grainlaw.validation.report.plots import data_uri

THEIRS = "#222222"
MARGIN = 1.12
# For the names of the runs above the piles.
HEADROOM = 1.3


def pile_figure(found: Sequence[PileDistance]) -> str:
    """One panel for each code: its surface black, our runs in colours; as a data URI."""
    return data_uri(drawn_piles(found))


def drawn_piles(found: Sequence[PileDistance]) -> Figure:
    """The figure of `pile_figure`, to be saved."""
    codes = list(dict.fromkeys((one.code, one.time) for one in found))
    columns = min(2, len(codes))
    rows = -(-len(codes) // columns)
    figure = Figure(figsize=(WIDTH, 0.7 + 1.75 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    colors = {run: COLORS[number % len(COLORS)] for number, run in enumerate(dict.fromkeys(one.run for one in found))}
    for axes, (code, time) in zip(panels.flat, codes, strict=False):
        beside = [one for one in found if (one.code, one.time) == (code, time)]
        _fill(axes, beside[0].theirs)
        for one in beside:
            label = f"{one.run}: E_A {100.0 * one.distances[0].distance:.1f} %"
            axes.plot(one.ours.x, one.ours.h, color=colors[one.run], lw=1.3, label=label)
        axes.set_title(f"{code}, t = {time:g} s", fontsize=9)
        axes.tick_params(labelsize=8)
        axes.grid(visible=True, color="#e5e5e5", lw=0.5)
        axes.legend(frameon=False, fontsize=7, loc="upper left")
    for number in range(len(codes), rows * columns):
        panels.flat[number].set_visible(False)
        panels.flat[number - columns].tick_params(labelbottom=True)
    reach = MARGIN * max(max(one.ours.half_width, one.theirs.half_width) for one in found)
    is_round = found[0].theirs.x.min() >= 0.0
    panels[0, 0].set_xlim(0.0 if is_round else -reach, reach)
    panels[0, 0].set_ylim(0.0, HEADROOM * max(max(one.ours.top, one.theirs.top) for one in found))
    for axes in panels[-1]:
        axes.set_xlabel("r [m]" if is_round else "x [m]", fontsize=9)
    for axes in panels[:, 0]:
        axes.set_ylabel("h [m]", fontsize=9)
    return figure


def _fill(axes: Axes, pile: Pile) -> None:
    axes.fill_between(pile.x, 0.0, pile.h, color="#dddddd", lw=0)
    axes.plot(pile.x, pile.h, color=THEIRS, lw=1.1)
