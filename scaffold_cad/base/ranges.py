"""Rows of different lengths, one after another in one array."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Ints


def ranges(first: Ints, counts: Ints) -> Ints:
    """Return `first[k]`, `first[k]` + 1, ... (`counts[k]` of them), for each k in turn.

    Examples
    --------
    >>> ranges(np.array([7, 20]), np.array([3, 2])).tolist()
    [7, 8, 9, 20, 21]
    """
    before = np.cumsum(counts) - counts
    return np.repeat(first - before, counts) + np.arange(int(counts.sum()))


def steps(counts: Ints) -> Ints:
    """Return 0, 1, ... (`counts[k]` of them), for each k in turn.

    Examples
    --------
    >>> steps(np.array([3, 2])).tolist()
    [0, 1, 2, 0, 1]
    """
    return ranges(np.zeros_like(counts), counts)
