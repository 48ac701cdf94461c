"""Sweep: what is between two heights, asked for from the lowest up."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints


class Sweep:
    """Which things are at heights that are asked for from the lowest up."""

    def __init__(self, low: Floats, high: Floats) -> None:
        """Take things, each from `low` to `high` (k,), mm."""
        self._order = np.argsort(low, kind="stable")
        self._low, self._high = low[self._order], high
        self._next = 0
        self._active: Ints = np.zeros(0, dtype=np.intp)

    def between(self, low: float, high: float) -> Ints:
        """Return the things that reach into heights from `low` to `high`, ascending."""
        after = int(np.searchsorted(self._low, high, side="right"))
        fresh = self._order[self._next : after]
        self._next = max(self._next, after)
        active = np.concatenate([self._active, fresh])
        self._active = np.sort(active[self._high[active] >= low])
        return self._active


def count_at(heights: Floats, low: Floats, high: Floats) -> Ints:
    """Return how many things, each from `low` to `high` (k,), are at each height, shape (h,)."""
    below = np.searchsorted(np.sort(low), heights)
    count: Ints = below - np.searchsorted(np.sort(high), heights)
    return count


def sum_at(heights: Floats, low: Floats, high: Floats, values: Floats) -> Floats:
    """Return the sum of the values (k,) of the things that are at each height, shape (h,)."""
    found = np.zeros(len(heights))
    for bound, sign in ((low, 1.0), (high, -1.0)):
        order = np.argsort(bound, kind="stable")
        sums = np.concatenate([[0.0], np.cumsum(values[order])])
        found += sign * sums[np.searchsorted(bound[order], heights)]
    return np.maximum(found, 0.0)
