"""Cutting long stacks of arrays into blocks, which bounds memory and stays in the cache.

How large a block is follows from the bytes that one row takes while it is worked on.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from scaffold_cad.base.arrays import Ints

CACHE = 1 << 21
"""Bytes of the arrays of a block that is to stay in the processor's cache."""

MEMORY = 1 << 26
"""Bytes of the arrays of a block where only the memory taken is to be bounded."""


def blocks(count: int, row: float, within: int = MEMORY) -> Iterator[slice]:
    """Return slices that cut `count` rows into blocks, each of one row at least.

    Parameters
    ----------
    row : bytes that one row takes while it is worked on
    within : bytes that a block takes, about: `MEMORY` or `CACHE`

    Examples
    --------
    >>> [(part.start, part.stop) for part in blocks(5, row=80, within=160)]
    [(0, 2), (2, 4), (4, 5)]
    """
    rows = max(1, int(within / max(row, 1)))
    return (slice(start, min(start + rows, count)) for start in range(0, count, rows))


def uneven_blocks(sizes: Ints, item: int, within: int = MEMORY) -> Iterator[slice]:
    """Return slices that cut rows of different `sizes` (k,) into blocks.

    Parameters
    ----------
    sizes : number of items of each row
    item : bytes that one item takes while it is worked on
    within : bytes that a block takes, about; one row may take more

    Examples
    --------
    >>> [(part.start, part.stop) for part in uneven_blocks(np.array([3, 1, 9, 2]), 8, within=40)]
    [(0, 2), (2, 3), (3, 4)]
    """
    number = np.cumsum(sizes) // max(1, within // item)  # (k,) of the block that the row is in
    bounds = [0, *(np.flatnonzero(np.diff(number)) + 1).tolist(), len(sizes)]
    return (slice(a, b) for a, b in pairwise(bounds) if a < b)


def cut(rows: Ints, row: float, within: int = MEMORY) -> Iterator[Ints]:
    """Return `rows` (k, ...) cut into such blocks.

    >>> [part.tolist() for part in cut(np.arange(5), row=80, within=160)]
    [[0, 1], [2, 3], [4]]
    """
    return (rows[part] for part in blocks(len(rows), row, within))
