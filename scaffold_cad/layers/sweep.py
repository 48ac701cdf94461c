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
