"""Choosing how often to take each edge so that every direction gets four: a small b-matching.

Taking an edge for the first and for the second time each brings a gain, and the sum is to be
large. Exact solvers need milliseconds a star and give one answer; what is wanted is a handful
of different good answers for thousands of stars, as the gains only estimate the clearance that
a choice will allow. So all stars take the steps of one tabu search at once: each changes the
edge that helps most, counting a penalty for directions that have not four edges, and must then
leave that edge alone for a while. Every complete choice passed is a candidate.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.partition.multigraph import EDGES_EACH

# How clearances change with these constants: `python -m tests.benchmarks.tuning`.
PENALTIES, PHASE = (1.0, 2.0, 4.0, 6.0), 40
"""Gain lost by the square of the edges missing at, or too many for, a direction; each in turn for
`PHASE` steps. A low one lets the search wander, a high one brings it to an end."""
OF_FOUR = np.array([[2, 1, 1], [1, 2, 1], [1, 1, 2], [0, 2, 2], [2, 0, 2], [2, 2, 0]])
"""How often each of the three pairs of opposite edges among four directions can be taken."""
TENURE = (1, 1, 2, 8, 3, 1, 14, 5, 2)
"""Steps for which a changed edge is left alone, in turn: unequal ones avoid going in circles.

One number for all, or none above 5, leaves more poor stars: `tests.benchmarks.tuning TENURE`.
"""


def good_matchings(
    ends: Ints, first: Floats, second: Floats, valency: int, count: int, steps: int
) -> tuple[Ints, Floats]:
    """Return the best multiplicities found, (M, count, E), and their gains, (M, count).

    They come in order of falling gain; where fewer are found the gain is −∞.

    Parameters
    ----------
    ends : (M, E, 2) intp, the directions that each edge joins
    first, second : (M, E) float64, gain of taking an edge once, and of taking it again
    valency : number of directions
    count : number of different multiplicities wanted
    steps : number of changes tried

    Notes
    -----
    For four directions all choices are gone through: opposite edges are taken equally often.
    """
    if valency == 4:
        return _all_of_four(ends, first, second, count)
    search = _TabuSearch(ends, first, second, valency, count)
    for step in range(steps):
        search.change(step)
        search.record()
    order = np.argsort(-search.gains, axis=1, kind="stable")
    found = np.take_along_axis(search.found, order[..., None], axis=1)
    return found.astype(np.intp), np.take_along_axis(search.gains, order, axis=1)


def _all_of_four(ends: Ints, first: Floats, second: Floats, count: int) -> tuple[Ints, Floats]:
    """Return the best `count` of the six choices for four directions, and their gains."""
    low, high = ends.min(axis=2), ends.max(axis=2)
    pair = np.where(low == 0, high, 6 - low - high) - 1  # edges 0k and ij are opposite
    choices = OF_FOUR[:, pair].swapaxes(0, 1)  # (M, 6, 6)
    taken = np.where(choices > 0, first[:, None], 0) + np.where(choices > 1, second[:, None], 0)
    gains = taken.sum(axis=2)
    order = np.argsort(-gains, axis=1, kind="stable")[:, :count]
    best = np.take_along_axis(choices, order[..., None], axis=1)
    return best, np.take_along_axis(gains, order, axis=1)


class _TabuSearch:
    """The state of M searches, one per star."""

    def __init__(self, ends: Ints, first: Floats, second: Floats, valency: int, count: int) -> None:
        stars, edges = first.shape
        self.row = np.arange(stars)
        self.ends = ends
        self.flat_ends = ends + valency * self.row[:, None, None]
        self.first, self.second = first, second
        self.multiplicity = np.zeros((stars, edges), dtype=np.int8)
        self.missing = np.full((stars, valency), float(EDGES_EACH))
        self.more = first.copy()  # gain of taking each edge once more
        self.less = np.full((stars, edges), -np.inf)  # gain of taking it once less
        self.free_from = np.zeros((stars, edges), dtype=np.intp)
        self.gain = np.zeros(stars)
        # A choice is known by the number that has its multiplicities as digits, modulo 2**64.
        self.marks = np.cumprod(np.full(edges, 3, dtype=np.uint64))
        self.mark = np.zeros(stars, dtype=np.uint64)
        self.gains = np.full((stars, count), -np.inf)
        self.found_marks = np.zeros((stars, count), dtype=np.uint64)
        self.found = np.zeros((stars, count, edges), dtype=np.int8)

    def change(self, step: int) -> None:
        """Take or drop one edge of each star."""
        missing = self.missing.reshape(-1)
        penalty = PENALTIES[step // PHASE % len(PENALTIES)]
        relief = 2 * penalty * (missing[self.flat_ends[..., 0]] + missing[self.flat_ends[..., 1]])
        more, less = self.more + relief, self.less - relief
        value = np.maximum(more, less)
        value[self.free_from > step] = -np.inf
        row, edge = self.row, np.argmax(value, axis=1)
        sign = np.where(more[row, edge] >= less[row, edge], 1, -1).astype(np.int8)
        old = self.multiplicity[row, edge]
        new = old + sign
        first, second = self.first[row, edge], self.second[row, edge]
        self.multiplicity[row, edge] = new
        self.gain += sign * np.where(old + new == 1, first, second)
        self.mark += sign.astype(np.uint64) * self.marks[edge]
        self.more[row, edge] = np.where(new == 0, first, np.where(new == 1, second, -np.inf))
        self.less[row, edge] = np.where(new == 2, -second, np.where(new == 1, -first, -np.inf))
        self.free_from[row, edge] = step + 1 + TENURE[step % len(TENURE)]
        for end in range(2):
            self.missing[row, self.ends[row, edge, end]] -= sign

    def record(self) -> None:
        """Keep the choice of each star if it is complete, new, and among the best so far."""
        complete = np.flatnonzero(~self.missing.any(axis=1))
        worst = np.argmin(self.gains[complete], axis=1)
        known = (self.found_marks[complete] == self.mark[complete, None]).any(axis=1)
        better = ~known & (self.gain[complete] > self.gains[complete, worst])
        kept, place = complete[better], worst[better]
        self.gains[kept, place] = self.gain[kept]
        self.found_marks[kept, place] = self.mark[kept]
        self.found[kept, place] = self.multiplicity[kept]
