"""Heights of the ground on a square grid, from files: ESRI ASCII grid, GeoTIFF, CSV, NumPy."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Of the spacing, by which places of a regular grid may be off in a file of few digits.
SAME_PLACE = 1e-3
_CORNERS, _CENTERS = ("xllcorner", "yllcorner"), ("xllcenter", "yllcenter")


class Heights(NamedTuple):
    """Heights on a square grid.

    lower    place of the first height along x and y [m]
    spacing  between neighbours [m]
    values   heights [m], shape (along x, along y)
    """

    lower: tuple[float, float]
    spacing: float
    values: Floats

    @property
    def upper(self) -> tuple[float, float]:
        """The place of the last height [m]."""
        x, y = (low + self.spacing * (count - 1) for low, count in zip(self.lower, self.values.shape, strict=True))
        return x, y

    def at(self, x: Floats, y: Floats) -> Floats:
        """Heights of places along x and y, shape (len(x), len(y)) [m].

        On two triangles per square; beyond the outermost heights the slope goes on.
        """
        i, u = _cell((x - self.lower[0]) / self.spacing, self.values.shape[0])
        j, v = _cell((y - self.lower[1]) / self.spacing, self.values.shape[1])
        i, u, j, v = i[:, np.newaxis], u[:, np.newaxis], j[np.newaxis], v[np.newaxis]
        first, last = self.values[i, j], self.values[i + 1, j + 1]
        along_x, along_y = self.values[i + 1, j], self.values[i, j + 1]
        below = first + u * (along_x - first) + v * (last - along_x)
        above = first + v * (along_y - first) + u * (last - along_y)
        return np.asarray(np.where(u >= v, below, above))


def _cell(places: Floats, count: int) -> tuple[NDArray[np.int64], Floats]:
    cells = np.clip(np.floor(places), 0, count - 2).astype(np.int64)
    return cells, places - cells


def read_heights(file: Path, lower: tuple[float, float] | None, spacing: float | None) -> Heights:
    """The heights in a file, of the kind that its name says; the first one at `lower` [m] where that is given.

    `spacing` [m] belongs to NumPy files, which do not tell it.
    Raises ValueError, naming the file, for what cannot be read, gaps, and cells that are not square.
    """
    reader = _READERS.get(file.suffix.lower())
    if reader is None:
        raise ValueError(f"file {file}: no kind of terrain; allowed: {', '.join(_READERS)}")
    if reader is not _read_numpy and spacing is not None:
        raise ValueError(f"file {file}: a spacing belongs to .npy, other files tell theirs")
    try:
        found = reader(file, lower, spacing)
    except OSError as error:
        raise ValueError(f"file {file} cannot be read: {error.strerror or error}") from error
    if min(found.values.shape) < 2:
        raise ValueError(
            f"file {file} holds {found.values.shape[0]} x {found.values.shape[1]} heights; allowed: 2 x 2 on"
        )
    _refuse_gaps(file, found)
    return found if lower is None else found._replace(lower=lower)


def _refuse_gaps(file: Path, found: Heights) -> None:
    gaps = np.argwhere(~np.isfinite(found.values))
    if len(gaps) > 0:
        x, y = (low + found.spacing * number for low, number in zip(found.lower, gaps[0].tolist(), strict=True))
        raise ValueError(f"file {file} has no height (NODATA) at {len(gaps)} places, the first at x = {x:g}, y = {y:g}")


def _read_ascii(file: Path, lower: Any, spacing: Any) -> Heights:
    """Esri ASCII raster: a header of names and values, then heights row after row from the north."""
    words, header = _text(file).split(), {}
    while words and words[0][0].isalpha() and words[0].lower() not in ("nan", "inf"):
        name, *rest = words
        header[name.lower()] = _number(file, name, rest[0] if rest else "")
        words = rest[1:]
    sizes = [header.get(name, header.get("cellsize")) for name in ("dx", "dy")]
    corner = next((names for names in (_CORNERS, _CENTERS) if set(names) <= header.keys()), None)
    if corner is None or None in sizes or not {"ncols", "nrows"} <= header.keys():
        raise ValueError(f"file {file}: its header needs ncols, nrows, xllcorner, yllcorner and cellsize")
    size = _square(file, float(sizes[0] or 0.0), float(sizes[1] or 0.0))
    shape = int(header["nrows"]), int(header["ncols"])
    if len(words) != shape[0] * shape[1]:
        raise ValueError(f"file {file} has {len(words)} heights; its header says {shape[0]} rows of {shape[1]}")
    try:
        rows = np.array(words, np.float64).reshape(shape)
    except ValueError as error:
        raise ValueError(f"file {file}: {error}") from error
    rows[rows == header.get("nodata_value", -9999.0)] = np.nan
    middle = 0.5 * size if corner is _CORNERS else 0.0
    return Heights((header[corner[0]] + middle, header[corner[1]] + middle), size, rows[::-1].T.copy())


def _read_csv(file: Path, lower: Any, spacing: Any) -> Heights:
    """Columns x, y, z in any order of rows, on a regular grid."""
    lines = _text(file).splitlines()
    names = [name.strip().lower() for name in lines[0].split(",")] if lines else []
    if not {"x", "y", "z"} <= set(names):
        raise ValueError(f"file {file} needs the columns x, y and z in its first line")
    try:
        table = np.atleast_2d(np.loadtxt(lines[1:], delimiter=",", dtype=np.float64))
    except ValueError as error:
        raise ValueError(f"file {file}: {error}") from error
    if table.size == 0:
        raise ValueError(f"file {file} has no row below its first line")
    x, y, z = (table[:, names.index(name)] for name in ("x", "y", "z"))
    (first_x, step_x, i), (first_y, step_y, j) = (_on_grid(file, name, at) for name, at in (("x", x), ("y", y)))
    size = _square(file, step_x, step_y)
    values = np.full((int(i.max()) + 1, int(j.max()) + 1), np.nan)
    values[i, j] = z
    return Heights((first_x, first_y), size, values)


def _on_grid(file: Path, name: str, places: Floats) -> tuple[float, float, NDArray[np.int64]]:
    """The first of regular places along an axis, their distance, and which of them each one is."""
    distinct = np.unique(places)
    steps = np.diff(distinct)
    steps = steps[steps > SAME_PLACE * steps.max(initial=0.0)]
    if len(steps) == 0:
        raise ValueError(f"file {file}: all {name} are {places[0]:g}; allowed: a grid of x and y")
    # of many steps, but for a gap as long as several
    step = float(steps.min())
    numbers = (places - distinct[0]) / step
    step = float(np.ptp(distinct) / max(round(float(numbers.max())), 1))
    numbers = (places - distinct[0]) / step
    off = np.abs(numbers - np.round(numbers))
    if not off.max() < 0.01:
        raise ValueError(f"file {file}: {name} = {places[int(off.argmax())]:g} is on no grid of {step:g} m")
    return float(distinct[0]), step, np.round(numbers).astype(np.int64)


def _read_numpy(file: Path, lower: tuple[float, float] | None, spacing: float | None) -> Heights:
    """An array of heights, the first index along x, the second along y."""
    if lower is None or spacing is None:
        raise ValueError(f"file {file} does not tell where it lies; allowed: with lower = [x, y] and spacing")
    try:
        values = np.load(file, allow_pickle=False)
    except ValueError as error:
        raise ValueError(f"file {file} cannot be read: {error}") from error
    if not isinstance(values, np.ndarray) or values.ndim != 2 or values.dtype.kind not in "iuf":
        raise ValueError(f"file {file} does not hold a table of numbers, along x and along y")
    return Heights(lower, spacing, values.astype(np.float64))


def _read_geotiff(file: Path, lower: Any, spacing: Any) -> Heights:
    """The first band of a GeoTIFF in metres, through rasterio."""
    try:
        import rasterio
    except ImportError:
        raise ValueError(
            f"file {file}: GeoTIFF is read with the library rasterio, which is not installed; install it, or convert "
            "the file to an ESRI ASCII grid (.asc)"
        ) from None
    try:
        with rasterio.open(file) as source:
            if source.crs is not None and source.crs.is_geographic:
                raise ValueError(f"file {file} lies in degrees; allowed: a projection in metres")
            place, rows = source.transform, source.read(1, masked=True).astype(np.float64).filled(np.nan)
    except rasterio.errors.RasterioError as error:
        raise ValueError(f"file {file} cannot be read: {error}") from error
    if place.b != 0.0 or place.d != 0.0 or place.e >= 0.0:
        raise ValueError(f"file {file} is turned; allowed: rows from north to south")
    size = _square(file, place.a, -place.e)
    return Heights((place.c + 0.5 * size, place.f - (len(rows) - 0.5) * size), size, rows[::-1].T.copy())


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"file {file} is no text") from None


def _number(file: Path, name: str, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise ValueError(f"file {file}: {name} is '{word:.40}', no number") from None


def _square(file: Path, along_x: float, along_y: float) -> float:
    if not (0.0 < along_x < np.inf and abs(along_x - along_y) <= SAME_PLACE * along_x):
        raise ValueError(f"file {file}: its cells are {along_x:g} m by {along_y:g} m; allowed: squares")
    return along_x


_READERS: dict[str, Callable[[Path, Any, Any], Heights]] = {
    ".asc": _read_ascii,
    ".csv": _read_csv,
    ".npy": _read_numpy,
    ".tif": _read_geotiff,
    ".tiff": _read_geotiff,
}
