"""Rows of text made of whole arrays: numbers as digits in columns of bytes, a row per line.

A byte 0 stands for nothing and is taken out at the end: so rows may be of different lengths.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Floats, Ints

Columns: TypeAlias = NDArray[np.uint8]
"""Characters of a part of each row, shape (rows, width)."""

_GROUP = 10_000
_DIGITS = np.array([list(f"{number:04d}".encode()) for number in range(_GROUP)], dtype=np.uint8)
"""The digits of each group of four, shape (10 000, 4)."""


def rows_of(*parts: bytes | Columns) -> bytes:
    """Return rows of text: each has the same constant parts, and its own of the columns.

    Parameters
    ----------
    parts : from left to right; at least one is of columns, and these have as many rows

    Examples
    --------
    >>> import numpy as np
    >>> rows_of(b"<", whole(np.array([7, 12])), b">").decode()
    '<7><12>'
    """
    count = next(len(part) for part in parts if not isinstance(part, bytes))
    widths = [len(part) if isinstance(part, bytes) else part.shape[1] for part in parts]
    table = np.empty((count, sum(widths)), dtype=np.uint8)
    start = 0
    for part, width in zip(parts, widths, strict=True):
        given = np.frombuffer(part, dtype=np.uint8) if isinstance(part, bytes) else part
        table[:, start : start + width] = given
        start += width
    return table.tobytes().translate(None, b"\0")


def whole(values: Ints) -> Columns:
    """Return the digits of whole numbers ≥ 0, shape (n, width)."""
    width = len(str(int(values.max(initial=0))))
    columns = _padded(values, width)
    least = int(values.min(initial=0))
    for place in range(1, width):
        if least < 10**place:
            columns[values < 10**place, width - 1 - place] = 0
    return columns


def decimal(values: Floats, decimals: int) -> Columns:
    """Return numbers rounded to `decimals` places, without zeros at their ends, shape (n, width).

    Parameters
    ----------
    values : (n,) float64, below 2**63 in units of the last place
    """
    units = np.rint(values * 10.0**decimals).astype(np.int64)
    ahead, after = np.divmod(np.abs(units), 10**decimals)
    columns = [whole(ahead), np.full((len(values), 1), ord("."), np.uint8)]
    columns.append(_padded(after, decimals))
    if (units < 0).any():
        columns.insert(0, np.where(units < 0, ord("-"), 0).astype(np.uint8)[:, None])
    made = np.concatenate(columns, axis=1)
    blank = np.ones(len(values), dtype=np.bool_)
    for column in range(made.shape[1] - 1, made.shape[1] - 1 - decimals, -1):
        blank &= made[:, column] == ord("0")
        if not blank.any():
            return made
        made[blank, column] = 0
    made[blank, made.shape[1] - 1 - decimals] = 0  # no point after a whole number
    return made


def _padded(values: Ints, width: int) -> Columns:
    """Return the last `width` digits of whole numbers ≥ 0, with zeros before them, (n, width)."""
    groups = -(-width // 4)
    columns = np.empty((len(values), 4 * groups), dtype=np.uint8)
    rest = values
    for group in range(groups - 1, -1, -1):
        rest, last = np.divmod(rest, _GROUP)
        columns[:, 4 * group : 4 * group + 4] = _DIGITS[last]
    return columns[:, 4 * groups - width :]
