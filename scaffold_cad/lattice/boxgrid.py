"""Boxes sorted into the cells of a uniform grid, to find those near given places."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.ndimage import label

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.blocks import blocks, uneven_blocks
from scaffold_cad.base.ranges import ranges, steps

CELLS_ACROSS = (32, 128)
"""Least and most cells along the longest side of a grid."""

QUERY_BYTES = 256
"""What a query box takes where it is looked at."""

PAIR_BYTES = 32
"""What a pair of a query box and a triangle takes."""


class BoxGrid:
    """A uniform grid over triangles in two or three dimensions, and which of them each cell has."""

    def __init__(self, corners: Floats, margin: float = 0.0) -> None:
        """Sort triangles into cells of about their size.

        Parameters
        ----------
        corners : (t, 3, d) float64, mm
        margin : mm; what lies no further from a triangle is in a cell that has it
        """
        self._low = corners.min(axis=(0, 1)) - margin
        extent = corners.max(axis=(0, 1)) + margin - self._low
        size = float(np.ptp(corners, axis=1).max(axis=1).mean())
        self._pitch = float(np.clip(size, *sorted(float(extent.max()) / np.array(CELLS_ACROSS))))
        self._shape = np.floor(extent / self._pitch).astype(np.intp) + 1
        low, high, triangle = _small_boxes(corners, self._pitch)
        box, cell = self._cells(low - margin, high + margin)
        # A triangle's boxes may share a cell: it must be found there once.
        keys = np.sort(cell * len(corners) + triangle[box])
        cells, self._triangles = np.divmod(keys[np.diff(keys, prepend=-1) > 0], len(corners))
        counts = np.bincount(cells, minlength=int(self._shape.prod()))
        self._offsets = np.concatenate([[0], np.cumsum(counts)])

    @property
    def is_empty(self) -> Bools:
        """Whether each cell has no triangle, with the grid's own shape."""
        empty: Bools = np.diff(self._offsets) == 0
        return empty.reshape(self._shape)

    def centers(self, cells: Ints) -> Floats:
        """Return the centers of cells, numbered in the order of `is_empty`, shape (k, d), mm."""
        steps = np.stack(np.unravel_index(cells, tuple(self._shape)), axis=1)
        centers: Floats = self._low + (steps + 0.5) * self._pitch
        return centers

    def cell_of(self, points: Points) -> Ints:
        """Return the number of the cell of each of `points` (n, d), -1 for those in none, (n,)."""
        steps = self._steps(points)
        number = np.zeros(len(points), dtype=np.intp)
        there = np.ones(len(points), dtype=np.bool_)
        for axis, size in enumerate(self._shape.tolist()):
            there &= (steps[:, axis] >= 0) & (steps[:, axis] < size)
            number = number * size + steps[:, axis]
        return np.where(there, number, -1)

    def near(self, low: Floats, high: Floats) -> Iterator[tuple[Ints, Ints]]:
        """Yield blocks of pairs of a query box and a triangle in a cell that it touches.

        A pair comes once a cell; a query point so has no pair twice.

        Parameters
        ----------
        low, high : (q, d) float64, corners of the query boxes, mm
        """
        for rows in blocks(len(low), QUERY_BYTES):
            query, cell = self._cells(low[rows], high[rows])
            query += rows.start
            found = self._offsets[cell + 1] - self._offsets[cell]
            for part in uneven_blocks(found, PAIR_BYTES):
                first, count = self._offsets[cell[part]], found[part]
                yield np.repeat(query[part], count), self._triangles[ranges(first, count)]

    def _cells(self, low: Floats, high: Floats) -> tuple[Ints, Ints]:
        """Return pairs of a box and a cell of the grid that it touches; boxes may be outside."""
        first = np.maximum(self._steps(low), 0)
        last = np.minimum(self._steps(high), self._shape - 1)
        spans = np.maximum(last - first + 1, 0)  # (q, d)
        counts = spans.prod(axis=1)
        box = np.repeat(np.arange(len(counts)), counts)
        rest = steps(counts)
        cell = np.zeros(len(box), dtype=np.intp)
        for axis, size in enumerate(self._shape.tolist()):
            rest, step = np.divmod(rest, spans[box, axis])
            cell = cell * size + first[box, axis] + step
        return box, cell

    def _steps(self, points: Floats) -> Ints:
        """Return how many cells each point (n, d) is from the lowest one along each axis."""
        steps: Ints = np.floor((points - self._low) / self._pitch).astype(np.intp)
        return steps


class Rooms:
    """The sets of adjacent cells without triangles of a grid: all of a room is on one side.

    Where many points are, most are so known to be inside or not without a look at triangles.
    """

    def __init__(self, grid: BoxGrid, is_inside: Callable[[Floats], Bools]) -> None:
        """Ask once for each room, by a point of it, (k, d) to (k,)."""
        self._grid = grid
        labels, _ = label(grid.is_empty)
        self._room_of_cell = labels.reshape(-1).astype(np.intp) - 1  # -1 where there are triangles
        rooms, first = np.unique(self._room_of_cell, return_index=True)
        self._inside = is_inside(grid.centers(first[rooms >= 0]))

    def contains(self, points: Floats, near_triangles: Callable[[Floats], Bools]) -> Bools:
        """Return whether each of `points` (n, d) is inside, by a question for those in no room."""
        inside = np.zeros(len(points), dtype=np.bool_)
        cell = self._grid.cell_of(points)
        there = np.flatnonzero(cell >= 0)
        room = self._room_of_cell[cell[there]]
        in_room = room >= 0
        inside[there[in_room]] = self._inside[room[in_room]]
        near = there[~in_room]
        inside[near] = near_triangles(points[near])
        return inside


def _small_boxes(corners: Floats, pitch: float) -> tuple[Floats, Floats, Ints]:
    """Return boxes (k, d) no larger than two cells around the parts of triangles, and whose.

    The box around a large slanting triangle is mostly empty, that around its parts is not.
    """
    triangle = np.arange(len(corners))
    lows, highs, owners = [], [], []
    while len(corners):
        low, high = corners.min(axis=1), corners.max(axis=1)
        small = (high - low).max(axis=1) <= 2 * pitch
        lows.append(low[small])
        highs.append(high[small])
        owners.append(triangle[small])
        corners, triangle = _quartered(corners[~small]), np.tile(triangle[~small], 4)
    return np.concatenate(lows), np.concatenate(highs), np.concatenate(owners)


def _quartered(corners: Floats) -> Floats:
    """Return the four triangles between the corners and side middles of each, (4 t, 3, d)."""
    a, b, c = (corners[:, k] for k in range(3))
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])
