"""Cutting long stacks of arrays into blocks, which bounds memory and stays in the cache."""

from __future__ import annotations

from collections.abc import Iterator

from scaffold_cad.base.arrays import Ints


def blocks(count: int, width: int, size: int) -> Iterator[slice]:
    """Return slices that cut `count` rows of `width` elements into blocks of about `size`.

    >>> [(part.start, part.stop) for part in blocks(5, 10, 20)]
    [(0, 2), (2, 4), (4, 5)]
    """
    rows = max(1, size // max(width, 1))
    return (slice(start, min(start + rows, count)) for start in range(0, count, rows))


def cut(rows: Ints, size: int) -> Iterator[Ints]:
    """Return `rows` (k, ...) cut into parts of at most `size` rows.

    >>> import numpy as np
    >>> [part.tolist() for part in cut(np.arange(5), 2)]
    [[0, 1], [2, 3], [4]]
    """
    return (rows[part] for part in blocks(len(rows), 1, size))
