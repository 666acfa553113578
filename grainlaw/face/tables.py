"""Columns as a pandas table, where pandas is there."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from grainlaw.materials.errors import InputError

if TYPE_CHECKING:
    from pandas import DataFrame


def data_frame(columns: Mapping[str, NDArray[Any]], units: Mapping[str, str]) -> "DataFrame":
    """The columns as a pandas table with their units in `attrs["units"]`. Raises InputError without pandas."""
    try:
        import pandas
    except ImportError:
        raise InputError("to_frame() needs pandas, which is not installed: pip install pandas") from None
    frame = pandas.DataFrame(dict(columns))
    frame.attrs["units"] = dict(units)
    return frame
