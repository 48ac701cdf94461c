"""Fillets of what overlaps: sections of the filleted union of the struts there.

What a mesh has there is the surface of a field solid, see `solid.field`. Its section at a height is
where the same function of space is negative, looked for on a grid in the plane: only where two
struts are so near that there may be a fillet between them, for elsewhere the union is the struts.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.ranges import steps
from scaffold_cad.layers.contours import contours, keys_of, unpacked, widened
from scaffold_cad.layers.loops import Loops
from scaffold_cad.layers.rounds import crossed
from scaffold_cad.layers.sweep import Sweep, sum_at
from scaffold_cad.solid.field import FieldStruts
from scaffold_cad.solid.field.union import Lists, filleted_union, values

SQUARE = 0.15
"""Side of the squares of the grid, in radii of the thinnest strut."""

BULGE = 0.3
"""How far fillets reach beyond the box around struts at most, where flat ends meet, in their radii:
1 - 1 / sqrt(2), see `solid.field.union`."""

PIECE = 4.0
"""Length of the pieces that struts are looked at in, in their radii and fillets."""

SQUARES_AS_PART = 50.0
"""Squares that take as long as a section of a strut, roughly."""

MOST_SQUARES = 2.0**21
"""Squares at a height, about: beside thick struts they are larger than a part of thin ones, whose
fillets are then left out or coarse."""


class FilletSections:
    """The sections of the fillets between the struts of crowded nodes, from the lowest up."""

    def __init__(self, fields: FieldStruts, run: Ints, own: Bools | None = None) -> None:
        """Take the struts of a field.

        Parameters
        ----------
        run : (q,) that of each, -1 for balls
        own : (k,) runs some of which are at each fillet that is wanted; by default all
        """
        self._union = filleted_union(fields, np.zeros(3), np.zeros(len(run)))
        self._own = np.ones(len(run), dtype=np.bool_)
        if own is not None:
            self._own = np.where(run >= 0, own[run], own.any())
        low, high, strut = _pieces(fields)
        near = _meeting(low, high, strut)
        self._low, self._high, self._strut = low[near], high[near], strut[near]
        self._sweep = Sweep(*self._levels)
        self._areas = (self._high - self._low)[:, :2].prod(axis=1)
        most = sum_at(self._low[:, 2], *self._levels, self._areas).max(initial=0.0)
        thin = SQUARE * float(fields.radii.min(initial=np.inf))
        self._cell = max(thin, float(np.sqrt(most / MOST_SQUARES)))

    @property
    def _levels(self) -> tuple[Floats, Floats]:
        """Where pieces begin and end, (p,) each, mm."""
        return self._low[:, 2], self._high[:, 2]

    @property
    def box(self) -> Floats:
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
        inside = (1.0 - BULGE) * self._union.blend[self._strut, None]
        low, high = self._low + inside, self._high - inside
        return np.stack([low.min(axis=0, initial=np.inf), high.max(axis=0, initial=-np.inf)])[:, :2]

    def count(self, heights: Floats) -> Ints:
        """Return how many sections of struts take as long at each height, about, shape (h,)."""
        squares = sum_at(heights, *self._levels, self._areas) / self._cell**2
        return np.ceil(squares / SQUARES_AS_PART).astype(np.intp)

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections at ascending heights (h,), above those before."""
        active = self._sweep.between(float(heights[0]), float(heights[-1]))
        piece, level = crossed(self._low[active, 2], self._high[active, 2], heights)
        if len(piece) == 0:
            return []
        keys, struts, first = self._grid(active[piece], level)
        points = self._places(keys, first, heights)
        distance, _ = self._union.distances(points, struts)
        ratio = distance / self._union.blend[struts]
        near = ratio < 1.0
        keys, struts, ratio = keys[near], struts[near], ratio[near]
        starts = np.flatnonzero(np.diff(keys, prepend=-1))
        if len(starts) == 0:
            return []
        return [self._contours(keys, struts, ratio, starts, first, heights)]

    def _contours(
        self, keys: Ints, struts: Ints, ratio: Floats, starts: Ints, first: Ints, heights: Floats
    ) -> Loops:
        """Return the polygons around the fillets.

        Parameters
        ----------
        keys, struts, ratio : (p,) a grid point, a strut near it, and its distance in fillets
        starts : (g,) where each grid point begins in these
        """
        counts = np.diff(starts, append=len(keys))
        known = keys[starts]
        several = (counts > 1) & widened(known, np.logical_or.reduceat(self._own[struts], starts))
        # Where one strut is alone its own section has what is inside.
        found = np.where(ratio[starts] > 0, ratio[starts], 1.0)
        chosen = np.repeat(several, counts)
        lists = Lists(np.concatenate([[0], np.cumsum(counts[several])]), struts[chosen])
        points = self._places(keys[starts][several], first, heights)
        found[several] = values(self._union, points, np.arange(len(points)), lists)
        found[~several & (counts > 1)] = 1.0
        every = Lists(np.append(starts, len(keys)), struts)

        def between(beside: Ints, places: Floats) -> Floats:
            level, _ = unpacked(beside)
            points = np.column_stack([(places + first) * self._cell, heights[level]])
            return values(self._union, points, np.searchsorted(known, beside), every)

        return contours(known, found, self._cell, first, between)

    def _grid(self, piece: Ints, level: Ints) -> tuple[Ints, Ints, Ints]:
        """Return the grid points in the boxes of pieces at levels (q,).

        Returns
        -------
        Key and strut of each pair, each pair once, in order, (p,); what place 0 stands for, (2,)
        """
        low = np.floor(self._low[piece, :2] / self._cell).astype(np.intp)
        high = np.ceil(self._high[piece, :2] / self._cell).astype(np.intp)
        first = low.min(axis=0) - 1
        wide, deep = (high - low + 1).T
        pair = np.repeat(np.arange(len(piece)), wide * deep)
        number = steps(wide * deep)
        across, along = np.divmod(number, deep[pair])
        places = low[pair] - first + np.stack([across, along], axis=1)
        keys, strut = keys_of(level[pair], places), self._strut[piece][pair]
        order = np.lexsort((strut, keys))
        keys, strut = keys[order], strut[order]
        once = (np.diff(keys, prepend=-1) != 0) | (np.diff(strut, prepend=-1) != 0)
        return keys[once], strut[once], first

    def _places(self, keys: Ints, first: Ints, heights: Floats) -> Points:
        """Return where grid points are, (p, 3), mm."""
        level, places = unpacked(keys)
        return np.column_stack([(places + first) * self._cell, heights[level]])


def _pieces(fields: FieldStruts) -> tuple[Points, Points, Ints]:
    """Return the boxes around pieces of struts with their fillets, (p, 3) twice, and whose, (p,).

    Along a slanting strut a box is mostly empty; those around its pieces are not.
    """
    reach = fields.radii.max(axis=1) + fields.blend
    count = np.maximum(np.ceil(fields.lengths / (PIECE * reach)), 1).astype(np.intp)
    strut = np.repeat(np.arange(len(count)), count)
    number = steps(count)
    start, end = fields.ends[strut, 0], fields.ends[strut, 1]
    at = [start + ((number + side) / count[strut])[:, None] * (end - start) for side in (0, 1)]
    margin = reach[strut, None]
    return np.minimum(*at) - margin, np.maximum(*at) + margin, strut


def _meeting(low: Points, high: Points, strut: Ints) -> Ints:
    """Return the pieces whose boxes meet that of another strut, ascending."""
    found = np.zeros(len(strut), dtype=np.bool_)
    for i, j in overlapping_boxes(low, high):
        others = strut[i] != strut[j]
        found[i[others]] = True
        found[j[others]] = True
    return np.flatnonzero(found)
