"""Numbers for grid edges, so that those of neighboring tetrahedra agree without a search.

A cell has 14 edges of its own: from its center to its 8 corners and to the centers across its 6
faces. A corner has 3: to the next corner ahead along each axis. These have places in one table.
Rare edges, from a center to the middles of sides and faces, and diagonals of faces beside a coarser
cell, are numbered behind it.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints
from scaffold_cad.solid.field.cells import packed
from scaffold_cad.solid.field.grid import AROUND, Grid, rim_of

OWN = 14
"""Edges of a cell: 8 to its corners, 6 to the centers across its faces."""


class Slots:
    """Numbers of the edges of a grid, and the ends of those that were asked for."""

    def __init__(self, grid: Grid) -> None:
        self.grid = grid
        self.sides = OWN * grid.cells
        self.rare = self.sides + 3 * grid.corners
        self.diagonals = self.rare + 27 * grid.cells
        self.ahead = np.zeros(3 * grid.corners, dtype=np.int32)
        """The corner that each side of a cell leads to, once it was asked for."""
        self.owner = np.zeros(3 * grid.corners, dtype=np.int32)
        """A group at that side."""

    def to_corner(self, cells: Ints, corner: Ints | int) -> Ints:
        """Return the edges from centers of cells to their corners 0..7."""
        return OWN * cells + corner

    def across(self, cells: Ints, axis: int, ahead: bool) -> Ints:
        """Return the edges from centers of cells to those across a face."""
        return OWN * cells + (8 + 2 * axis + ahead)

    def to_middle(self, cells: Ints, point: int) -> Ints:
        """Return the edges from centers of cells to one of the 27 points around, in half cells."""
        return self.rare + 27 * cells + point

    def side(self, low: Ints, high: Ints, axis: Ints | int, owner: Ints) -> Ints:
        """Return the edges from corners to the next along an axis."""
        slot = 3 * low + axis
        self.ahead[slot] = high
        self.owner[slot] = owner
        return self.sides + slot

    def diagonal(self, cells: Ints, axis: int, ahead: bool, odd: Ints) -> Ints:
        """Return the diagonals of faces of cells, between rim corners 0, 2 or, if odd, 1, 3."""
        return self.diagonals + 2 * (6 * cells + 2 * axis + ahead) + odd

    def to_point(self, cells: Ints, points: Ints) -> Ints:
        """Return the edges from centers of cells to corners of the grid on them."""
        way = np.sign(self.grid.places[points] - self.grid.places[self.grid.corners + cells])
        own = (way != 0).all(axis=1)
        corner = (way > 0) @ np.array([1, 2, 4])
        return np.where(
            own, self.to_corner(cells, corner), self.rare + 27 * cells + (way + 1) @ [1, 3, 9]
        )

    def between(self, a: Ints, b: Ints, owner: Ints) -> Ints:
        """Return the edges between corners that are neighbors along any axis."""
        way = self.grid.places[b] - self.grid.places[a]
        axis = np.argmax(np.abs(way), axis=1)
        ahead = way.sum(axis=1) > 0
        return self.side(np.where(ahead, a, b), np.where(ahead, b, a), axis, owner)

    def ends(self, slots: Ints) -> tuple[Ints, Ints, Ints, Bools]:
        """Return the ends of edges, a group at each, and whether the end was put in.

        An end that was put in is a center across a face in a cell that was left out; it is given
        as the number of the direction, 2 axis + ahead, in place of a grid point.
        """
        start, end = np.zeros(len(slots), dtype=np.intp), np.zeros(len(slots), dtype=np.intp)
        owner, put_in = np.zeros(len(slots), dtype=np.intp), np.zeros(len(slots), dtype=np.bool_)
        own = np.flatnonzero(slots < self.sides)
        cell, number = np.divmod(slots[own], OWN)
        start[own], owner[own] = self.grid.corners + cell, cell // 8
        corner = number < 8
        end[own[corner]] = self._corner(cell[corner], number[corner])
        across, way = own[~corner], number[~corner] - 8
        end[across], put_in[across] = self._across(cell[~corner], way)
        side = np.flatnonzero((slots >= self.sides) & (slots < self.rare))
        slot = slots[side] - self.sides
        start[side], end[side], owner[side] = slot // 3, self.ahead[slot], self.owner[slot]
        rare = np.flatnonzero((slots >= self.rare) & (slots < self.diagonals))
        cell, point = np.divmod(slots[rare] - self.rare, 27)
        start[rare], owner[rare] = self.grid.corners + cell, cell // 8
        end[rare] = self._point(cell, point)
        odd = np.flatnonzero(slots >= self.diagonals)
        start[odd], end[odd], owner[odd] = self._diagonal(slots[odd] - self.diagonals)
        return start, end, owner, put_in

    def _corner(self, cell: Ints, number: Ints) -> Ints:
        child = cell % 8
        around = sum(((child >> a & 1) + (number >> a & 1)) * 3**a for a in range(3))
        corners: Ints = self.grid.corner_of[cell // 8, around].astype(np.intp)
        return corners

    def _across(self, cell: Ints, way: Ints) -> tuple[Ints, Bools]:
        """Return the centers across faces, or the directions where no cell is."""
        group, child = np.divmod(cell, 8)
        axis, ahead = way >> 1, way & 1
        inner = (child >> axis & 1) != ahead
        other = child ^ (1 << axis)
        end, put_in = way.copy(), np.ones(len(cell), dtype=np.bool_)
        level = np.searchsorted(self.grid.first, group, side="right") - 1
        for k in np.unique(level).tolist():
            these = np.flatnonzero(level == k)
            beside = group[these] - self.grid.first[k]
            step = (
                np.where(ahead[these] > 0, 1, -1)[:, None] * np.eye(3, dtype=np.intp)[axis[these]]
            )
            out = ~inner[these]
            at = self.grid.levels[k].groups[beside[out]] + step[out]
            beside[out] = self.grid.registers[k].find(at)
            there = self.grid.levels[k].has_leaves(beside, other[these])
            rows = these[there]
            end[rows] = self.grid.corners + 8 * (beside[there] + self.grid.first[k]) + other[rows]
            put_in[rows] = False
        return end, put_in

    def _point(self, cell: Ints, point: Ints) -> Ints:
        """Return the corners of the grid at some of the 27 points around cells."""
        level = np.searchsorted(self.grid.first, cell // 8, side="right") - 1
        half = (1 << level)[:, None]
        places = self.grid.places[self.grid.corners + cell] + (AROUND[point] - 1) * half
        return np.searchsorted(self.grid.keys, packed(places))

    def _diagonal(self, numbers: Ints) -> tuple[Ints, Ints, Ints]:
        face, odd = np.divmod(numbers, 2)
        cell, way = np.divmod(face, 6)
        start, end = np.zeros_like(cell), np.zeros_like(cell)
        for number in np.unique(way).tolist():
            these = np.flatnonzero(way == number)
            for child in np.unique(cell[these] % 8).tolist():
                rows = these[cell[these] % 8 == child]
                around = rim_of(child, number >> 1, bool(number & 1))
                rim = self.grid.corner_of[(cell[rows] // 8)[:, None], around]
                first = np.arange(len(rows))
                start[rows], end[rows] = rim[first, odd[rows]], rim[first, odd[rows] + 2]
        return start, end, cell // 8
