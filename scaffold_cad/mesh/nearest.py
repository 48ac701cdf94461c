"""The place of a surface that is nearest to a point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.counts import tracked
from scaffold_cad.base.vectors import dot, leading_dot, length, normalize
from scaffold_cad.mesh.trianglemesh import TriangleMesh

NEAREST = 8
"""How many triangles of about one size are looked at for the one nearest to a point."""

ALIKE = 4.0
"""How many times larger than others triangles of about one size are at most."""

FACING = 0.5
"""Least cosine of the angle between a direction and a triangle that faces it."""

TRIANGLE_BYTES = 500
"""What a point and a triangle near it take where they are looked at."""

EPSILON, TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)
"""Rounding of a number of size 1; the least number, which keeps divisors above 0."""


@dataclass(frozen=True, eq=False)
class _Size:
    """Triangles of about one size."""

    rows: Ints
    """Their numbers, shape (k,)."""
    reach: Floats
    """How far their corners are from their middles at most, shape (k,), mm."""
    tree: cKDTree
    """Of their middles."""

    def near(self, points: Points, bound: float = np.inf) -> tuple[Floats, Ints]:
        """Return how far the nearest middles are from points, and which these are, both (n, c).

        Those that are further than the bound are infinitely far.
        """
        count = min(NEAREST, len(self.rows))
        far, place = self.tree.query(points, k=count, distance_upper_bound=bound)
        shape = len(points), count
        return np.reshape(far, shape), np.reshape(place, shape)


def _by_size(corners: Floats) -> list[_Size]:
    """Return triangles (t, 3, 3) by size, the largest ones first.

    Among many small ones a large one that is nearer would not be looked at.
    """
    middles = corners.mean(axis=1)
    reach = length(corners - middles[:, None]).max(axis=1)
    most = reach.max(initial=TINY)
    kind = np.floor(np.log(most / np.maximum(reach, EPSILON * most)) / np.log(ALIKE))
    parts = [np.flatnonzero(kind == each) for each in np.unique(kind)]
    return [_Size(rows, reach[rows], cKDTree(middles[rows])) for rows in parts]


class NearestPlace:
    """The surface of a mesh whose triangles are not much longer than wide, for nearest places."""

    def __init__(self, mesh: TriangleMesh) -> None:
        self._corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
        self._sizes = _by_size(self._corners)

    def nearest(self, points: Points, facing: UnitVectors | None = None) -> Points:
        """Return the nearest place of the mesh to each of `points` (n, 3), among near triangles.

        Parameters
        ----------
        facing : (n, 3) directions that triangles are to face, where one of the near ones does: the
            place is then not beyond a sharp edge
        """
        return self._found(points, facing)[0]

    def with_normals(self, points: Points) -> tuple[Points, UnitVectors]:
        """Return the nearest places to `points` (n, 3), and the normals of their triangles."""
        places, triangles = self._found(points, None)
        return places, self._normals[triangles]

    def nearer(self, points: Points, limit: float) -> tuple[Ints, Points, Ints]:
        """Return which of `points` (n, 3) are nearer than `limit`, their places and triangles.

        Returns
        -------
        rows (k,), nearest places (k, 3), and their triangles (k,)
        """
        count = len(points) if len(self._corners) else 0
        parts = list(blocks(count, NEAREST * TRIANGLE_BYTES, CACHE))
        made = (self._some_nearer(points[part], limit) for part in parts)
        found = list(tracked("nearest places", made, [part.stop - part.start for part in parts]))
        none = np.zeros(0, dtype=np.intp), np.zeros((0, 3)), np.zeros(0, dtype=np.intp)
        shifted = [
            (part.start + each[0], *each[1:]) for part, each in zip(parts, found, strict=True)
        ]
        rows, places, triangles = zip(none, *shifted, strict=True)
        return np.concatenate(rows), np.concatenate(places), np.concatenate(triangles)

    def _found(self, points: Points, facing: UnitVectors | None) -> tuple[Points, Ints]:
        """Return the nearest places (n, 3) and their triangles (n,)."""
        parts = list(blocks(len(points), NEAREST * TRIANGLE_BYTES, CACHE))
        ways = (None if facing is None else facing[part] for part in parts)
        made = (self._some(points[part], way) for part, way in zip(parts, ways, strict=True))
        found = list(tracked("nearest places", made, [part.stop - part.start for part in parts]))
        none = np.zeros((0, 3)), np.zeros(0, dtype=np.intp)
        places, triangles = zip(none, *found, strict=True)
        return np.concatenate(places), np.concatenate(triangles)

    def _some(self, points: Points, facing: UnitVectors | None) -> tuple[Points, Ints]:
        """Do as `_found` for a few points."""
        near = [each.rows[each.near(points)[1]] for each in self._sizes]
        triangles = np.concatenate(near, axis=1)
        count = triangles.shape[1]
        every = np.repeat(points, count, axis=0)
        feet = nearest_on_triangles(every, self._corners[triangles.reshape(-1)])
        gaps = length(feet - every).reshape(-1, count)
        if facing is not None:
            faces: Bools = dot(self._normals[triangles], facing[:, None]) > FACING  # (n, count)
            gaps = np.where(faces | ~faces.any(axis=1, keepdims=True), gaps, np.inf)
        best = gaps.argmin(axis=1)
        row = np.arange(len(points))
        places: Points = feet.reshape(-1, count, 3)[row, best]
        return places, triangles[row, best]

    def _some_nearer(self, points: Points, limit: float) -> tuple[Ints, Points, Ints]:
        """Do as `nearer` for a few points: most triangles have a plane that is further away."""
        rows, triangles = [], []
        for each in self._sizes:
            far, place = each.near(points, limit + float(each.reach.max()))
            row, column = np.nonzero(np.isfinite(far))
            place = place[row, column]
            some: Bools = np.asarray(far[row, column] < limit + each.reach[place])
            rows.append(row[some])
            triangles.append(each.rows[place[some]])
        row, triangle = np.concatenate(rows), np.concatenate(triangles)
        away = dot(points[row], self._normals[triangle]) - self._heights[triangle]
        beside = np.flatnonzero(np.abs(away) < limit)
        row, triangle = row[beside], triangle[beside]
        feet = nearest_on_triangles(points[row], self._corners[triangle])
        gap = length(feet - points[row])
        order = np.lexsort((gap, row))
        order = order[gap[order] < limit]
        first = order[np.flatnonzero(np.diff(row[order], prepend=-1))]
        return row[first], feet[first], triangle[first]

    @cached_property
    def _normals(self) -> UnitVectors:
        a, b, c = np.moveaxis(self._corners, 1, 0)
        return normalize(np.cross(b - a, c - a) + np.finfo(float).tiny)

    @cached_property
    def _heights(self) -> Floats:
        """How far the planes of triangles are along their normals, (t,), mm."""
        return dot(self._corners[:, 0], self._normals)


def nearest_on_triangles(points: Points, corners: Floats) -> Points:
    """Return the place of each triangle (n, 3, 3) that is nearest to its point (n, 3), (n, 3)."""
    a, b, c, point = (np.ascontiguousarray(rows.T) for rows in (*corners.swapaxes(0, 1), points))
    to_b, to_c, to_point = b - a, c - a, point - a  # (3, n), as all vectors here
    best, least = _on_side(to_point, to_b)
    for start, span in ((0.0, to_c), (to_b, to_c - to_b)):
        place, far = _on_side(to_point - start, span)
        closer = far < least
        best, least = np.where(closer, place + start, best), np.where(closer, far, least)
    # The foot in the plane is taken only where it is closer: for needles it is badly rounded.
    along_b, along_c = leading_dot(to_point, to_b), leading_dot(to_point, to_c)
    b_b, b_c, c_c = leading_dot(to_b, to_b), leading_dot(to_b, to_c), leading_dot(to_c, to_c)
    size = np.maximum(b_b * c_c - b_c * b_c, EPSILON * b_b * c_c + TINY)
    of_b = (c_c * along_b - b_c * along_c) / size
    of_c = (b_b * along_c - b_c * along_b) / size
    foot = of_b * to_b + of_c * to_c
    off = to_point - foot
    inside = (of_b >= 0) & (of_c >= 0) & (of_b + of_c <= 1) & (leading_dot(off, off) < least)
    return np.asarray((a + np.where(inside, foot, best)).T)


def _on_side(to_points: Floats, span: Floats) -> tuple[Floats, Floats]:
    """Return the place on each side from 0 to `span` (3, n) nearest to a point (3, n), (3, n).

    The squares of the distances, shape (n,), are returned, too.
    """
    along = leading_dot(to_points, span) / np.maximum(leading_dot(span, span), TINY)
    place = along.clip(0, 1) * span
    off = to_points - place
    return place, leading_dot(off, off)
