"""Polygons in the plane of u and v as a region that struts are cut at."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.blocks import blocks
from scaffold_cad.lattice.boxgrid import BoxGrid, Rooms

TOLERANCE = 1e-9
"""Distance within which a point is on the border, in greatest coordinates."""

SIDE_BYTES = 16
"""What a pair of a point and a side takes where a ray is followed."""

ENDLESS = 1e30
"""How far the region goes along w."""


class PolygonRegion:
    """What is inside closed polygons of u and v, by the even-odd rule, and their border.

    It is endless along w.
    """

    def __init__(self, loops: tuple[Floats, ...]) -> None:
        """Take closed polygons, shapes (k, 2); the last corner joins the first."""
        self._starts = np.concatenate(loops)
        self._ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
        low, high = self._starts.min(axis=0), self._starts.max(axis=0)
        self.bounds = np.array([[*low, -ENDLESS], [*high, ENDLESS]])
        self.tolerance = TOLERANCE * float(np.abs(self._starts).max())

    def crossings(self, nodes: Points, edges: Edges) -> tuple[Ints, Floats]:
        """Return where edges cross sides; see `Region`."""
        start, end = nodes[edges[:, 0], :2], nodes[edges[:, 1], :2]
        found_strut, found_along = [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
        for strut, side in self._grid.near(np.minimum(start, end), np.maximum(start, end)):
            a, along_side = self._starts[side], self._ends[side] - self._starts[side]
            p, span = start[strut], end[strut] - start[strut]
            turn = _cross(span, along_side)
            with np.errstate(divide="ignore", invalid="ignore"):
                along = _cross(a - p, along_side) / turn
                beside = _cross(a - p, span) / turn
            slack = self.tolerance
            met = (along > 0) & (along < 1) & (beside >= -slack) & (beside <= 1 + slack)
            found_strut.append(strut[met])
            found_along.append(along[met])
        return np.concatenate(found_strut), np.concatenate(found_along)

    def contains(self, points: Points) -> Bools:
        """Return whether each of `points` (n, 3) is inside or on the border, (n,)."""
        flat = np.ascontiguousarray(points[:, :2])
        return self._rooms.contains(
            flat, lambda near: self._is_inside(near) | self._is_on_border(near)
        )

    @cached_property
    def _grid(self) -> BoxGrid:
        # A side is a triangle with two corners at one place.
        return BoxGrid(np.stack([self._starts, self._ends, self._ends], axis=1), self.tolerance)

    @cached_property
    def _rooms(self) -> Rooms:
        return Rooms(self._grid, self._is_inside)

    def _is_inside(self, points: Floats) -> Bools:
        """Return whether a ray from each of `points` (n, 2) meets an odd number of sides, (n,)."""
        inside = np.zeros(len(points), dtype=np.bool_)
        (ax, ay), (bx, by) = self._starts.T, self._ends.T
        for block in blocks(len(points), SIDE_BYTES * len(self._starts)):
            x, y = points[block, :, None].transpose(1, 0, 2)  # (b, 1)
            spans = (ay > y) != (by > y)
            side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
            inside[block] = (spans & ((side > 0) == (by > ay))).sum(axis=1) % 2 == 1
        return inside

    def _is_on_border(self, points: Floats) -> Bools:
        on = np.zeros(len(points), dtype=np.bool_)
        for point, side in self._grid.near(points, points):
            start, span = self._starts[side], self._ends[side] - self._starts[side]
            offset = points[point] - start
            size = np.maximum((span**2).sum(axis=1), np.finfo(float).tiny)
            along = np.clip((offset * span).sum(axis=1) / size, 0, 1)
            gap = np.hypot(*(offset - along[:, None] * span).T)
            on[point[gap <= self.tolerance]] = True
        return on


def _cross(a: Floats, b: Floats) -> Floats:
    crossed: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return crossed
