"""The tetrahedra on the faces between cells, and the triangles that cut them.

Two leaves of one size that share a face span four tetrahedra: both centers and a side of the face,
or eight where finer leaves put corners at the middles of sides. A leaf beside a coarser one has two
pyramids on its face, one to each center, of two tetrahedra each; the face is cut from the coarse
face's center. Where a neighbor was left out, all of it is on one side of the surface and a center
is put in where that of an equal leaf would be. So tetrahedra match across all their faces that the
surface can pass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.threads import in_order
from scaffold_cad.solid.field.cells import CHILDREN, packed
from scaffold_cad.solid.field.grid import Grid, rim_corners, rim_of
from scaffold_cad.solid.field.marching import Polygons, cut
from scaffold_cad.solid.field.slots import Slots

FACE_BYTES = 512
"""What a face takes where it is looked at."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells on one side of some faces of one size."""

    numbers: Ints | None
    """Cell of each face, shape (f,); None where they were left out."""
    inside: Bools
    """Whether their centers are inside, shape (f,)."""
    rim: Ints
    """Corners 0..7 of the cells on the face, shape (4,)."""


def polygons_of(grid: Grid, slots: Slots) -> list[Polygons]:
    """Return the triangles and quads of the surface, whose corners are numbers of edges."""
    return list(in_order(lambda job: job(), Faces(grid, slots).jobs()))


class Faces:
    """Goes through the faces of all leaves."""

    def __init__(self, grid: Grid, slots: Slots) -> None:
        self.grid = grid
        self.slots = slots
        self.inside = grid.field < 0  # (v,)
        used = [k for k, level in enumerate(grid.levels) if len(level.groups)]
        self.finest = min(used, default=0)

    def jobs(self) -> Iterator[partial[Polygons]]:
        """Yield what is to be done, in pieces that do not depend on each other."""
        for k, level in enumerate(self.grid.levels):
            for block in blocks(len(level.groups), FACE_BYTES):
                groups = np.arange(block.start, block.stop)
                for axis in range(3):
                    yield from self._along(k, groups, axis)

    def _along(self, k: int, groups: Ints, axis: int) -> Iterator[partial[Polygons]]:
        step = np.eye(3, dtype=np.intp)[axis]
        places, register = self.grid.levels[k].groups, self.grid.registers[k]
        ahead = register.find(places[groups] + step)
        behind = register.find(places[groups] - step)
        for child in range(8):
            if child >> axis & 1:
                yield partial(self.forward, k, groups, child, axis, ahead)
                yield partial(self.backward, k, groups, child, axis, groups)
            else:
                yield partial(self.forward, k, groups, child, axis, groups)
                yield partial(self.backward, k, groups, child, axis, behind)

    def forward(self, k: int, groups: Ints, child: int, axis: int, beside: Ints) -> Polygons:
        """Return what is between a child of groups and what is ahead of it, in groups `beside`."""
        level = self.grid.levels[k]
        other = child ^ (1 << axis)
        own = level.has_leaves(groups, child)
        groups, beside = groups[own], beside[own]
        met = level.has_leaves(beside, other)
        equal = self._equal(k, groups[met], child, beside[met], other, axis)
        return Polygons.joined([equal, self._border(k, groups[~met], child, axis, ahead=True)])

    def backward(self, k: int, groups: Ints, child: int, axis: int, beside: Ints) -> Polygons:
        """Return what is between a child of groups and no equal leaf behind it."""
        level = self.grid.levels[k]
        met = level.has_leaves(beside, child ^ (1 << axis))
        unmet = level.has_leaves(groups, child) & ~met
        return self._border(k, groups[unmet], child, axis, ahead=False)

    def _equal(self, k: int, low: Ints, child: int, high: Ints, other: int, axis: int) -> Polygons:
        first, corners = self.grid.first[k], self.grid.corners
        before, behind = 8 * (low + first) + child, 8 * (high + first) + other
        rim = self.grid.corner_of[(low + first)[:, None], rim_of(child, axis, True)]
        return self._spanned(
            k,
            axis,
            rim,
            Cells(before, self.inside[corners + before], rim_corners(axis, True)),
            Cells(behind, self.inside[corners + behind], rim_corners(axis, False)),
        )

    def _border(self, k: int, groups: Ints, child: int, axis: int, ahead: bool) -> Polygons:
        """Return what is between leaves and a finer or coarser leaf, or none."""
        if len(groups) == 0:
            return Polygons.joined([])
        grid = self.grid
        step = (1 if ahead else -1) * np.eye(3, dtype=np.intp)[axis]
        beside = 2 * grid.levels[k].groups[groups] + CHILDREN[child] + step
        if k > 0:  # finer leaves there see to it
            unmet = grid.registers[k - 1].find(beside) < 0
            groups, beside = groups[unmet], beside[unmet]
        coarse = np.full(len(groups), -1)
        if k + 1 < len(grid.levels):
            coarse = grid.registers[k + 1].find(beside >> 2)
            inner = (beside >> 1 & 1) @ np.array([1, 2, 4])
            coarse[~grid.levels[k + 1].has_leaves(coarse, inner)] = -1
        met = coarse >= 0
        owner = coarse[met] + (grid.first[k + 1] if k + 1 < len(grid.levels) else 0)
        other = 8 * owner + (beside[met] >> 1 & 1) @ np.array([1, 2, 4])
        return Polygons.joined(
            [
                self._beside_nothing(k, groups[~met], child, axis, ahead),
                self._beside_coarse(k, groups[met], child, axis, ahead, other),
            ]
        )

    def _beside_nothing(self, k: int, groups: Ints, child: int, axis: int, ahead: bool) -> Polygons:
        numbers = groups + self.grid.first[k]
        rim = self.grid.corner_of[numbers[:, None], rim_of(child, axis, ahead)]
        cells = 8 * numbers + child
        own = Cells(cells, self.inside[self.grid.corners + cells], rim_corners(axis, ahead))
        other = Cells(None, self.inside[rim[:, 0]], rim_corners(axis, not ahead))
        before, behind = (own, other) if ahead else (other, own)
        return self._spanned(k, axis, rim, before, behind)

    def _spanned(self, k: int, axis: int, rim: Ints, before: Cells, behind: Cells) -> Polygons:
        """Return what cuts the tetrahedra of two centers and each side of the rim between them."""
        inside = self.inside[rim]  # (f, 4)
        some = (before.inside != behind.inside) | (inside != before.inside[:, None]).any(axis=1)
        middles = self._middles(k, rim)
        if middles is not None:
            inner = (middles >= 0) & (self.inside[middles] != before.inside[:, None])
            some |= inner.any(axis=1)
            middles = middles[some]
        rim, inside = rim[some].astype(np.intp), inside[some]
        before, behind = _some(before, some), _some(behind, some)
        across = self._across(axis, before, behind)
        spokes = [self._spokes(cells, len(rim)) for cells in (before, behind)]
        cells = before.numbers if before.numbers is not None else behind.numbers
        owner = cells // 8 if cells is not None else np.zeros(0, dtype=np.intp)
        found = []
        for i in range(4):
            j = (i + 1) % 4
            along = (axis + 1 + i % 2) % 3
            low, high = (i, j) if i < 2 else (j, i)
            rows = np.arange(len(rim)) if middles is None else np.flatnonzero(middles[:, i] < 0)
            side = self.slots.side(rim[rows, low], rim[rows, high], along, owner[rows])
            edges = [across, spokes[0][i], spokes[0][j], spokes[1][i], spokes[1][j]]
            signs = [before.inside, behind.inside, inside[:, i], inside[:, j]]
            found.append(cut([s[rows] for s in signs], [*(e[rows] for e in edges), side]))
            if middles is None or len(rows) == len(rim):
                continue
            rows = np.flatnonzero(middles[:, i] >= 0)
            middle = middles[rows, i]
            to_middle = [self._to_middle(cells, i, j, rows) for cells in (before, behind)]
            for end in (i, j):
                side = self.slots.between(rim[rows, end], middle, owner[rows])
                inner = [before.inside[rows], behind.inside[rows]]
                outer = [self.inside[rim[rows, end]], self.inside[middle]]
                legs = [(spokes[n][end][rows], to_middle[n]) for n in (0, 1)]
                if end == j:
                    outer, legs = outer[::-1], [leg[::-1] for leg in legs]
                found.append(cut([*inner, *outer], [across[rows], *legs[0], *legs[1], side]))
        return Polygons.joined(found)

    def _across(self, axis: int, before: Cells, behind: Cells) -> Ints:
        if before.numbers is not None:
            return self.slots.across(before.numbers, axis, True)
        return self.slots.across(behind.numbers, axis, False)  # type: ignore[arg-type]

    def _spokes(self, cells: Cells, count: int) -> list[Ints]:
        """Return the edges from centers to the rim; no surface cuts those of cells left out."""
        if cells.numbers is None:
            return [np.full(count, -1)] * 4
        return [self.slots.to_corner(cells.numbers, corner) for corner in cells.rim.tolist()]

    def _to_middle(self, cells: Cells, i: int, j: int, rows: Ints) -> Ints:
        if cells.numbers is None:
            return np.full(len(rows), -1)
        point = (CHILDREN[cells.rim[i]] + CHILDREN[cells.rim[j]]) @ np.array([1, 3, 9])
        return self.slots.to_middle(cells.numbers[rows], int(point))

    def _middles(self, k: int, rim: Ints) -> Ints | None:
        """Return the corners at the middles of the rims' sides, -1 where none, shape (f, 4)."""
        if k <= self.finest or len(rim) == 0:
            return None
        ends = self.grid.places[rim]  # (f, 4, 3)
        keys = packed((ends + np.roll(ends, -1, axis=1)) >> 1)
        at = np.minimum(np.searchsorted(self.grid.keys, keys), len(self.grid.keys) - 1)
        return np.where(self.grid.keys[at] == keys, at, -1)

    def _beside_coarse(
        self, k: int, groups: Ints, child: int, axis: int, ahead: bool, other: Ints
    ) -> Polygons:
        """Return what cuts the pyramids on the faces between leaves and coarser ones `other`."""
        numbers = groups + self.grid.first[k]
        cells = 8 * numbers + child
        rim = self.grid.corner_of[numbers[:, None], rim_of(child, axis, ahead)].astype(np.intp)
        # The corner of the rim at the center of the coarse face goes first.
        places = self.grid.places
        apart = np.abs(places[rim] - places[self.grid.corners + other][:, None])  # (f, 4, 3)
        apart[:, :, axis] = 0
        turn = np.argmin(apart.sum(axis=2), axis=1)
        rim = np.take_along_axis(rim, (turn[:, None] + np.arange(4)) % 4, axis=1)
        diagonal = self.slots.diagonal(cells, axis, ahead, turn % 2)
        return Polygons.joined(
            [
                self._pyramids(cells, rim, diagonal, ahead),
                self._pyramids(other, rim, diagonal, not ahead),
            ]
        )

    def _pyramids(self, apex: Ints, rim: Ints, diagonal: Ints, ahead: bool) -> Polygons:
        """Return what cuts the two tetrahedra of pyramids, whose rim is ahead or behind."""
        owner = apex // 8
        top = self.inside[self.grid.corners + apex]
        inside = [self.inside[rim[:, i]] for i in range(4)]
        spokes = [self.slots.to_point(apex, rim[:, i]) for i in range(4)]
        sides = [self.slots.between(rim[:, i], rim[:, (i + 1) % 4], owner) for i in range(4)]
        found = []
        for i, j in ((1, 2), (2, 3)):
            # edges from the rim's first corner to corner i and j, and between them
            first = {1: sides[0], 2: diagonal, 3: sides[3]}
            p, q = (i, j) if ahead else (j, i)
            edges = [spokes[0], spokes[p], spokes[q], first[p], first[q], sides[i]]
            found.append(cut([top, inside[0], inside[p], inside[q]], edges))
        return Polygons.joined(found)


def _some(cells: Cells, rows: Bools) -> Cells:
    numbers = None if cells.numbers is None else cells.numbers[rows]
    return Cells(numbers, cells.inside[rows], cells.rim)
