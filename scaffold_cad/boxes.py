"""Pairs of overlapping axis-aligned boxes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scaffold_cad.arrays import Floats, Ints


def overlapping_boxes(low: Floats, high: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Yield blocks of pairs i < j of boxes (k, 3) that overlap. TEMPORARY sweep."""
    order = np.argsort(low[:, 0], kind="stable")
    lo, hi = low[order], high[order]
    stop = np.searchsorted(lo[:, 0], hi[:, 0], side="right")
    for s in range(0, len(order), 512):
        i = np.arange(s, min(s + 512, len(order)))
        n = stop[i] - i - 1
        a = np.repeat(i, n)
        b = np.arange(n.sum()) - np.repeat(np.cumsum(n) - n, n) + a + 1
        ok = ((lo[a, 1:] <= hi[b, 1:]) & (lo[b, 1:] <= hi[a, 1:])).all(axis=1)
        p, q = order[a[ok]], order[b[ok]]
        yield np.minimum(p, q), np.maximum(p, q)
