"""Polygons of a few cells of a lattice, repeated for all of its cells.

A lattice of a few cells along each side has all that one of many cells has: what is near its
sides, and, in its middle cell, what is repeated in all cells further inside. So polygons whose
middles are there are copied, and those before and after them are moved to the sides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.ranges import ranges, steps

WIDEST = 1.5
"""Extent of the widest polygon that is repeated, in cells that a strut reaches into."""


@dataclass(frozen=True, eq=False)
class Stamp(Frozen):
    """How a lattice of few cells becomes one of many, in the plane."""

    origin: Floats
    """A corner of the first cell, shape (2,), mm."""
    sides: Floats
    """Steps from cell to cell along both sides of a layer, rows, shape (2, 2), mm."""
    made: Ints
    """Cells along both sides that polygons are made of, shape (2,)."""
    counts: Ints
    """Cells along both sides that they are wanted for, not fewer, shape (2,)."""
    reach: int
    """Cells that a strut reaches into."""

    def repeated(self, points: Floats, offsets: Ints) -> tuple[Floats, Ints] | None:
        """Return polygons for all cells, or None where one is too wide to be told whose it is.

        Parameters
        ----------
        points, offsets : polygons of the few cells, see `Layer`
        """
        if len(points) == 0 or (self.made == self.counts).all():
            return points, offsets
        places = (points - self.origin) @ np.linalg.inv(self.sides)  # in cells
        low = np.minimum.reduceat(places, offsets[:-1])  # (l, 2)
        high = np.maximum.reduceat(places, offsets[:-1])
        fewer = self.made < self.counts
        if ((high - low).max(axis=0) > WIDEST * self.reach)[fewer].any():
            return None
        copies = np.ones((2, len(low)), dtype=np.intp)
        first = np.zeros((2, len(low)), dtype=np.intp)
        for axis in np.flatnonzero(fewer).tolist():
            middle, more = self.made[axis] // 2, self.counts[axis] - self.made[axis]
            centers = (low[:, axis] + high[:, axis]) / 2
            cell = np.floor(centers - _widest_gap(centers)).astype(np.intp)
            copies[axis, cell == middle] += more
            first[axis, cell > middle] = more
        return self._copied(points, offsets, first, copies)

    def _copied(
        self, points: Floats, offsets: Ints, first: Ints, copies: Ints
    ) -> tuple[Floats, Ints]:
        """Return polygons moved by `first` (2, l) cells and on, `copies` (2, l) times."""
        number = copies[0] * copies[1]
        polygon = np.repeat(np.arange(len(number)), number)  # (k,)
        step = steps(number)
        along, across = np.divmod(step, copies[1, polygon])
        cells = np.stack([first[0, polygon] + along, first[1, polygon] + across], axis=1)
        shifts = cells @ self.sides  # (k, 2), mm
        corners = np.diff(offsets)[polygon]
        moved = points[ranges(offsets[:-1][polygon], corners)]
        for axis in (0, 1):  # a column at once: with 10⁷ corners copies would take gigabytes
            moved[:, axis] += np.repeat(shifts[:, axis], corners)
        return moved, np.concatenate([[0], np.cumsum(corners)])


def _widest_gap(values: Floats) -> float:
    """Return the middle of the widest gap between the parts of numbers after the point.

    It is between -1/2 and 1/2: near a middle rounding would tell whose a polygon is.
    """
    parts = np.unique(values % 1.0)
    gaps = np.diff(parts, append=parts[0] + 1.0)
    widest = int(gaps.argmax())
    return float((parts[widest] + gaps[widest] / 2 + 0.5) % 1.0 - 0.5)
