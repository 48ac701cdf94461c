"""Spans: the stretches of runs that are part of a field, between which struts are their own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.struts.runs import Runs

WINDOW = 0.35
"""How far past the end of a span its field may be cut off, in the strut's radii."""

ZIP = 0.5
"""From the end of that window to the ring that is joined to the field, in the strut's radii."""

BAND = 0.1
"""Least length of a band between rings, in the strut's radii."""

CUT = WINDOW + ZIP
"""Length of strut that a cut takes, in the strut's radii."""

TAIL = 0.1
"""How far the struts of a field go on past the windows of their cuts, in radii, before the ball
at their end."""

ROUND = 1.2
"""From there to where nothing of that ball is any more, in its radii."""

FACING = WINDOW + TAIL + ROUND
"""Length of strut that a cut takes where it faces another: what is cut off keeps apart."""


@dataclass(frozen=True, eq=False)
class Spans(Frozen):
    """Stretches of runs; places are distances from the run's first node."""

    run: Ints
    """Shape (q,)."""
    low: Floats
    """Where each begins, mm, shape (q,); at 0 the node, or the end of the strut, is part of it."""
    high: Floats
    """Where each ends, mm, shape (q,); at the run's length the last node is part of it."""

    def __len__(self) -> int:
        return len(self.run)

    def chosen(self, keep: Bools) -> Spans:
        """Return some of them."""
        return Spans(self.run[keep], self.low[keep], self.high[keep])

    def areas(self, runs: Runs) -> Floats:
        """Return the area of each strut's round side and half of a ball at each end, (q,), mm²."""
        both = radii_at(runs, self.run, self.low) + radii_at(runs, self.run, self.high)
        return np.asarray(np.pi * both * (self.high - self.low + both))

    def nodes(self, runs: Runs) -> Bools:
        """Return the nodes that are part of spans, shape (n,)."""
        found = np.zeros(len(runs.nodes), dtype=np.bool_)
        found[runs.edges[self.run[self.low == 0], 0]] = True
        found[runs.edges[self.run[self.high == runs.lengths[self.run]], 1]] = True
        return found

    def covers(self, other: Spans, slack: Floats) -> Bools:
        """Return whether each of some other spans is within one of these, but for `slack`, mm.

        These keep apart, and stand in order.
        """
        if len(self) == 0:
            return np.zeros(len(other), dtype=np.bool_)
        size = 1.0 + max(self.high.max(), other.high.max(initial=0.0))
        place = (other.low + other.high) / 2
        row = np.searchsorted(self.run * size + self.low, other.run * size + place, side="right")
        row = np.maximum(row - 1, 0)
        within = (self.low[row] <= other.low + slack) & (other.high <= self.high[row] + slack)
        return np.asarray((self.run[row] == other.run) & within)

    @staticmethod
    def joined(parts: list[Spans]) -> Spans:
        """Return spans one after the other."""
        return Spans(
            np.concatenate([part.run for part in parts]),
            np.concatenate([part.low for part in parts]),
            np.concatenate([part.high for part in parts]),
        )


def no_spans() -> Spans:
    """Return no span at all."""
    return Spans(np.zeros(0, dtype=np.intp), np.zeros(0), np.zeros(0))


def whole_runs(runs: Runs) -> Spans:
    """Return all runs from end to end."""
    return Spans(np.arange(len(runs.lengths)), np.zeros(len(runs.lengths)), runs.lengths)


def merged(spans: Spans, runs: Runs, free: Floats) -> Spans:
    """Return spans that leave room for a strut of its own between them, by run and place.

    Parameters
    ----------
    free : (k, 2) where the strut may begin and end beside nodes that are in no cluster, as
        distances from the first node, mm
    """
    whole = runs.lengths[spans.run]
    low, high = np.clip(spans.low, 0.0, whole), np.clip(spans.high, 0.0, whole)
    order = np.lexsort((low, spans.run))
    run, low, high = spans.run[order], low[order], high[order]
    if len(run) == 0:
        return no_spans()
    # On one line, run after run, with what each span needs before and behind.
    length = runs.lengths[run]
    facing = FACING + np.abs(runs.slopes[2 * run])
    before, behind = (facing * radii_at(runs, run, place) / length for place in (low, high))
    gap = BAND * runs.radii.min(axis=1)[run] / length
    line = 4.0 * run
    reach = np.maximum.accumulate(line + np.minimum(high / length + behind, 2.0))
    start = line + np.maximum(low / length - before - gap, -1.0)
    begins = np.append(True, start[1:] > reach[:-1])
    first = np.flatnonzero(begins)
    run, low, high = run[first], low[first], np.maximum.reduceat(high, first)
    room = [(CUT + BAND) * radii_at(runs, run, place) for place in (low, high)]
    low = np.where(low - room[0] < free[run, 0], 0.0, low)
    high = np.where(high + room[1] > free[run, 1], runs.lengths[run], high)
    return Spans(run, low, high)


def tail_length(radius: Floats, slope: Floats) -> Floats:
    """Return how far the axes of a field's struts go on past their spans, mm."""
    return np.asarray((WINDOW + TAIL + np.abs(slope)) * radius)


def free_length(radius: Floats, slope: Floats) -> Floats:
    """Return how far past their spans nothing of a field's struts is any more, mm."""
    tail = tail_length(radius, slope)
    return np.asarray(tail + ROUND * (radius + np.maximum(slope, 0.0) * tail))


def radii_at(runs: Runs, run: Ints, place: Floats) -> Floats:
    """Return the radius of runs at distances from their first nodes, mm, shape (q,)."""
    return runs.radii_at(2 * run, place)
