"""A made-up collapse whose frames and history are known in closed form, written as a run writes its folder."""

import numpy as np

from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.history import HistoryWriter, history_columns
from grainlaw.mpm_core.output.quantities import write_quantities

FRAMES = 11
FRAME_INTERVAL = 0.1
COLUMN_WIDTH, COLUMN_HEIGHT, SPACING = 0.2, 0.4, 0.01


def frame(number, growth=1.5):
    """A rectangular column that is stretched to (1 + growth) times its width while it keeps its area."""
    share = number / (FRAMES - 1)
    stretch = 1 + growth * share
    x, y = np.meshgrid(
        np.arange(-COLUMN_WIDTH + SPACING / 2, COLUMN_WIDTH, SPACING),
        np.arange(SPACING / 2, COLUMN_HEIGHT, SPACING),
    )
    positions = np.stack([x.ravel() * stretch, y.ravel() / stretch, 0 * x.ravel()], axis=1)
    velocity = positions * [1.0, -1.0, 0.0]
    return Frame(
        number * FRAME_INTERVAL,
        100 * number,
        positions,
        (
            Field("shear_strain", "1", "accumulated shear strain", 3 * share * np.abs(x.ravel()) / COLUMN_WIDTH),
            Field("pressure", "Pa", "mean pressure, positive in compression", 1e4 * (COLUMN_HEIGHT - y.ravel())),
            Field("velocity", "m/s", "velocity", velocity),
        ),
    )


def history_row(step, growth=1.5):
    """The scalars at a step of 1 ms."""
    share = step / (100 * (FRAMES - 1))
    row = {column.name: 0 if column.whole_number else 0.0 for column in history_columns()}
    row |= {"t": step * FRAME_INTERVAL / 100, "step": step, "dt": 1e-3, "runout": COLUMN_WIDTH * (1 + growth * share)}
    row |= {"height": COLUMN_HEIGHT / (1 + growth * share), "kinetic_energy": share * (1 - share)}
    return row


def write_run(folder, growth=1.5):
    """All frames, the table of quantities and a history with ten rows per frame; return the folder."""
    folder.mkdir(parents=True)
    series, history = FrameSeries(folder), HistoryWriter(folder)
    write_quantities(folder, frame(0).fields)
    for number in range(FRAMES):
        series.write(frame(number, growth))
    for step in range(0, 100 * (FRAMES - 1) + 1, 10):
        history.append(history_row(step, growth))
    history.close()
    return folder
