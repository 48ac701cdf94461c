"""Numbers of binary files."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Floats


def as_doubles(values: NDArray[Any]) -> Floats:
    """Return numbers as float64: NaN of any kind, as damaged files hold it, is NaN."""
    with np.errstate(invalid="ignore"):
        return values.astype(np.float64)
