"""HDF5 files that somebody else may have damaged, opened so that reading them comes to an end."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.output.damaged_files import refuse_fatal
from grainlaw.mpm_core.output.hdf5_file import is_sealed

# A byte that is packed by deflate stands for 1032 at most.
MOST_BYTES_PER_BYTE = 1032
NUMBERS = "biuf"
# What the library raises for a damaged file, and what the parts of a file of another kind lead to.
UNREADABLE = (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, MemoryError)


@contextmanager
def existing_hdf5(path: Path) -> Iterator[h5py.File]:
    """A file, open for reading.

    Raises OSError for one that is missing or no HDF5, and InputError in one line for a damaged one: one that is sealed
    and was changed, or in which the library would not come to an end or would crash.
    """
    if not is_sealed(path):
        refuse_fatal(path, "HDF5")
    with h5py.File(path) as file:
        yield file


def numbers_of(dataset: h5py.Dataset, rows: slice | tuple[()] = ()) -> NDArray[Any]:
    """The numbers of a dataset, or some rows of them.

    Raises TypeError for anything else, and ValueError for a damaged one that claims more of them than its file can
    hold.
    """
    if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in NUMBERS:
        raise TypeError(f"{dataset.name} does not hold numbers")
    elsewhere = dataset.is_virtual or dataset.external
    if not elsewhere and dataset.nbytes > MOST_BYTES_PER_BYTE * dataset.file.id.get_filesize():
        raise ValueError(f"{dataset.name} claims the shape {dataset.shape}, more than the file can hold")
    return np.asarray(dataset[rows])
