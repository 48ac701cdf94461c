"""Loops: closed polygons of several heights in flat arrays, and those of closed meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.ranges import ranges
from scaffold_cad.base.topology import neighbors
from scaffold_cad.layers.sweep import Sweep, count_at
from scaffold_cad.mesh.trianglemesh import TriangleMesh


@dataclass(frozen=True, eq=False)
class Loops(Frozen):
    """Closed polygons at some of several heights; they may cross."""

    points: Floats
    """Corners, polygon by polygon, shape (p, 2), mm."""
    offsets: Ints
    """Where each polygon begins in `points`, and their number at the end, shape (l + 1,)."""
    levels: Ints
    """Number of the height of each polygon, ascending where it is not said, shape (l,)."""

    def taken(self, polygons: Ints) -> Loops:
        """Return some of the polygons (k,) in another order."""
        counts = np.diff(self.offsets)[polygons]
        points = self.points[ranges(self.offsets[:-1][polygons], counts)]
        return Loops(points, np.concatenate([[0], np.cumsum(counts)]), self.levels[polygons])

    def moved(self, steps: Floats, levels: Ints) -> Loops:
        """Return the polygons moved by `steps` (l, 2), mm, to other levels (l,), ascending."""
        points = self.points + np.repeat(steps, np.diff(self.offsets), axis=0)
        return Loops(points, self.offsets, levels)

    def by_level(self, count: int) -> Iterator[list[Floats]]:
        """Yield the polygons at each of `count` heights, each (k, 2)."""
        ends = np.searchsorted(self.levels, np.arange(count + 1)).tolist()
        offsets = self.offsets.tolist()
        for first, last in pairwise(ends):
            marks = offsets[first : last + 1]
            yield [self.points[a:b] for a, b in pairwise(marks)]


def joined(parts: list[Loops]) -> Loops:
    """Return the polygons of all of `parts` at the same heights."""
    levels = np.concatenate([part.levels for part in parts])
    order = np.argsort(levels, kind="stable")
    before = np.cumsum([0, *(len(part.points) for part in parts)])
    starts = [part.offsets[:-1] + at for part, at in zip(parts, before[:-1], strict=True)]
    offsets = np.concatenate([*starts, before[-1:]])
    return Loops(np.concatenate([part.points for part in parts]), offsets, levels).taken(order)


class Surface:
    """A closed surface of triangles, to be cut at heights."""

    def __init__(self, mesh: TriangleMesh) -> None:
        """Take a mesh, each side of whose triangles is that of one other."""
        self._xy, self._z = mesh.vertices[:, :2], mesh.vertices[:, 2]
        self._triangles = mesh.triangles
        self._across = neighbors(mesh.triangles, len(mesh.vertices))
        corners = self._z[mesh.triangles]  # (t, 3)
        self.low: Floats = corners.min(axis=1)
        """Lowest height of each triangle, shape (t,), mm."""
        self.high: Floats = corners.max(axis=1)
        """Highest height of each triangle, shape (t,), mm."""
        # Of the pairs of a triangle and a height: the first of each triangle, less its height.
        self._pair = np.zeros(len(self.low), dtype=np.intp)

    @property
    def box(self) -> Floats:
        """Lowest and highest corner of a box that holds all polygons, shape (2, 2), mm."""
        return np.stack([self._xy.min(axis=0), self._xy.max(axis=0)])

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest vertex, mm."""
        return float(self.low.min()), float(self.high.max())

    def cut(self, heights: Floats, active: Ints) -> Loops:
        """Return the sections at ascending heights (h,), counter-clockwise around the inside.

        A vertex at a height counts as above it: so each section is a whole number of loops.

        Parameters
        ----------
        active : the triangles that reach there, and any others, ascending
        """
        first = np.searchsorted(heights, self.low[active], side="right")
        count = np.searchsorted(heights, self.high[active], side="right") - first
        self._pair[active] = np.cumsum(count) - count - first
        triangle = np.repeat(active, count)  # (q,)
        level = ranges(first, count)
        height = heights[level]
        corners = self._triangles[triangle]
        above = self._z[corners] >= height[:, None]  # (q, 3)
        # A loop leaves a triangle, whose inside is to the left, where a side goes up.
        side = (~above & np.roll(above, -1, axis=1)).argmax(axis=1)
        beyond = self._across[triangle, side]
        after = self._pair[beyond] + level  # (q,)
        row = np.arange(len(side))
        ends = corners[row, side], corners[row, (side + 1) % 3]
        share = (height - self._z[ends[0]]) / (self._z[ends[1]] - self._z[ends[0]])
        points = self._xy[ends[0]] + share[:, None] * (self._xy[ends[1]] - self._xy[ends[0]])
        label, rank = cycles(after)
        order = np.lexsort((rank, label, level))
        begins = np.flatnonzero(rank[order] == 0)
        offsets = np.append(begins, len(order))
        return Loops(points[order], offsets, level[order[begins]])


class MeshSections(Surface):
    """The sections of a closed triangle mesh, from the lowest up."""

    def __init__(self, mesh: TriangleMesh) -> None:
        """Take a mesh, each side of whose triangles is that of one other."""
        super().__init__(mesh)
        self._sweep = Sweep(self.low, self.high)

    def count(self, heights: Floats) -> Ints:
        """Return how many triangles there are at each height, shape (h,)."""
        return count_at(heights, self.low, self.high)

    def loops(self, heights: Floats) -> list[Loops]:
        """Return the sections at ascending heights (h,), above those before."""
        active = self._sweep.between(float(heights[0]), float(heights[-1]))
        return [self.cut(heights, active)]


def cycles(after: Ints) -> tuple[Ints, Ints]:
    """Return the least item of the cycle of each item, and its steps from there, both (q,).

    Parameters
    ----------
    after : (q,) the item after each, a permutation
    """
    label, jump = np.arange(len(after)), after
    while True:
        least = np.minimum(label, label[jump])
        if np.array_equal(least, label):
            break
        label, jump = least, jump[jump]
    is_first = label == np.arange(len(after))
    ahead = np.where(is_first, 0, 1)  # steps to the next first item, 0 at one
    jump = np.where(is_first, np.arange(len(after)), after)
    while not is_first[jump].all():
        ahead, jump = ahead + ahead[jump], jump[jump]
    size = np.bincount(label, minlength=len(after))[label]
    return label, np.where(is_first, 0, size - ahead)
