"""Points at the very same position, and positions as files hold them."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points


def equal_positions(points: Points) -> tuple[Ints, Ints]:
    """Return the place of each of `points` (n, 3), and the first point at each place.

    Places are numbered in order of their first point.
    """
    order = np.lexsort(points.T)
    ordered = points[order]
    new = np.ones(len(points), dtype=np.bool_)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    # The sort is stable: the first of a run of equals is the one of the lowest index.
    first = order[new]
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    place = np.empty(len(points), dtype=np.intp)
    place[order] = rank[np.cumsum(new) - 1]
    return place, np.sort(first)


def in_single_precision(points: Points, factor: float = 1.0) -> Points:
    """Return positions as a file with 32-bit coordinates holds them, in its unit, (..., 3).

    Parameters
    ----------
    factor : what lengths in mm are multiplied with before they are written

    Examples
    --------
    >>> import numpy as np
    >>> in_single_precision(np.array([[1.0, 0.1, 0.0]])).tolist()
    [[1.0, 0.10000000149011612, 0.0]]
    """
    rounded: Points = (points * factor).astype(np.float32).astype(np.float64)
    return rounded


def single_steps(points: Points, factor: float = 1.0) -> Floats:
    """Return how far apart 32-bit coordinates are at positions (..., 3), mm, (...).

    Parameters
    ----------
    factor : what lengths in mm are multiplied with before they are written

    Examples
    --------
    >>> single_steps(np.array([[1e6, 0.0, 0.0]])).tolist()
    [0.0625]
    """
    largest = np.abs(points * factor).max(axis=-1)
    steps: Floats = np.spacing(largest.astype(np.float32)).astype(np.float64) / factor
    return steps
