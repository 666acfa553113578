"""Isotropic compression and unloading of a periodic cube: the deck and the pressure over the solid fraction."""

from pathlib import Path

import numpy as np

from grainlaw.materials.errors import SimulationError
from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.description import Compression, Triaxial
from grainlaw.validation.dem.liggghts import contact_values, data_file, decks, template_texts
from grainlaw.validation.dem.packing import loose, mean_volume, random_radii

Files = dict[str, str]
TABLE = "compression.csv"
COLUMNS = ("stage", "time", "solid_fraction", "pressure", "stress_xx", "stress_yy", "stress_zz")
# The final solid fraction, roughly: it sets the number of grains in the cube.
FINAL_FRACTION = 0.60
# Rate at which the gas is closed [1/s], steps between two checks of the pressure, steps of rest before loading.
FAST_RATE = 0.3
EVERY = 200
REST = 10000


def files(case: Compression, seed: int) -> Files:
    """Deck and data of the run."""
    deck = (
        decks()
        .get_template("compression.in.j2")
        .render(
            case=case,
            seed=seed,
            skin=0.2 * case.grains.mean_diameter,
            fast_rate=FAST_RATE,
            every=EVERY,
            rest=REST,
            **contact_values(case.contact, case.contact.friction),
        )
    )
    return {"grains.data": gas_in_a_cube(case, seed), "deck.in": deck}


def gas_in_a_cube(case: Compression | Triaxial, seed: int) -> str:
    """Data of a gas in a periodic cube that will have about the side of the case when it is dense."""
    random = np.random.default_rng(seed)
    number = round(FINAL_FRACTION * case.side**3 / mean_volume(case.grains))
    side = (number * mean_volume(case.grains) / case.gas_fraction) ** (1.0 / 3.0)
    space = np.array([[0.0, side]] * 3)
    gas = loose(random_radii(case.grains, number, random), space, (True, True, True), random)
    return data_file(gas, None, case.grains.density, space)


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "compression.in.j2")


def reduce(case: Compression, folder: Path) -> Reduced:
    """Write pressure over solid fraction, loading and unloading, to `compression.csv`."""
    log = finished_log(folder)
    solid = solid_volume(folder / "grains.data")
    loading, _, unloading = log.partition("\nLOADING")[2].partition("\nUNLOADING")
    rows = []
    last = 0
    for stage, part in (("loading", loading), ("unloading", unloading)):
        for step, _, volume, xx, yy, zz in rows_of_log(part, 7):
            last, mean = int(step), (xx + yy + zz) / 3.0
            values = (step * case.time_step, solid / volume, mean, xx, yy, zz)
            rows.append((stage, *(f"{value:.7g}" for value in values)))
    write_table(folder / TABLE, COLUMNS, rows)
    return Reduced(last, int(rows_of_log(unloading, 7)[0][1]), TABLE)


def finished_log(folder: Path) -> str:
    """What LIGGGHTS logged of a run. Raises SimulationError if it did not come to its end."""
    path = folder / "log.txt"
    log = path.read_text(encoding="utf-8", errors="replace")
    if "\nFINISHED" not in log:
        raise SimulationError(f"LIGGGHTS stopped before the end; see {path}")
    return log


def rows_of_log(log: str, words: int) -> list[tuple[float, ...]]:
    """Lines of the log that hold thermodynamic output in so many words; the last one, the processor time, is left out.

    Each `run` prints its first state again; only one of the two lines is kept.
    """
    rows: dict[float, tuple[float, ...]] = {}
    for line in log.splitlines():
        found = line.split()
        if len(found) == words and found[0].isdigit() and found[1].isdigit():
            values = tuple(float(word) for word in found[:-1])
            rows[values[0]] = values
    return list(rows.values())


def solid_volume(data: Path) -> float:
    """Volume of all grains of a data file [m3]."""
    lines = data.read_text(encoding="utf-8").partition("\nAtoms\n")[2].split("\n")
    diameters = np.array([float(line.split()[2]) for line in lines if line.strip()])
    return float(np.pi / 6.0 * np.sum(diameters**3))
