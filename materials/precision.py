"""What numbers are stored as and computed with."""

from typing import Any

import numpy as np

PRECISIONS: dict[str, Any] = {"double": np.float64, "single": np.float32}
