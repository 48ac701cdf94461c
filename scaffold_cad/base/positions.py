"""Points at the very same position."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Ints, Points


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
