"""The place of a surface that is nearest to a point."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.counts import counted
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.mesh.trianglemesh import TriangleMesh

NEAREST = 8
"""How many triangles are looked at for the one nearest to a point."""


FACING = 0.5
"""Least cosine of the angle between a direction and a triangle that faces it."""

TRIANGLE_BYTES = 500
"""What a point and a triangle near it take where they are looked at."""


class NearestPlace:
    """The surface of a mesh whose triangles are of about one size, for its nearest places."""

    def __init__(self, mesh: TriangleMesh) -> None:
        self._corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
        self._tree = cKDTree(self._corners.mean(axis=1))

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

    def _found(self, points: Points, facing: UnitVectors | None) -> tuple[Points, Ints]:
        """Return the nearest places (n, 3) and their triangles (n,)."""
        parts = list(blocks(len(points), NEAREST * TRIANGLE_BYTES))
        ways = (None if facing is None else facing[part] for part in parts)
        made = (self._some(points[part], way) for part, way in zip(parts, ways, strict=True))
        found = list(counted("nearest places", made, [part.stop - part.start for part in parts]))
        none = np.zeros((0, 3)), np.zeros(0, dtype=np.intp)
        places, triangles = zip(none, *found, strict=True)
        return np.concatenate(places), np.concatenate(triangles)

    def _some(self, points: Points, facing: UnitVectors | None) -> tuple[Points, Ints]:
        """Do as `_found` for a few points."""
        count = min(NEAREST, len(self._corners))
        _, triangles = self._tree.query(points, k=count)
        triangles = triangles.reshape(len(points), count)
        every = np.repeat(points, count, axis=0)
        feet = nearest_on_triangles(every, self._corners[triangles.reshape(-1)])
        gaps = length(feet - every).reshape(-1, count)
        if facing is not None:
            faces: Bools = dot(self._normals[triangles], facing[:, None]) > FACING  # (n, count)
            gaps = np.where(faces | ~faces.any(axis=1, keepdims=True), gaps, np.inf)
        row, best = np.arange(len(points)), gaps.argmin(axis=1)
        places: Points = feet.reshape(-1, count, 3)[row, best]
        return places, triangles[row, best]

    @cached_property
    def _normals(self) -> UnitVectors:
        a, b, c = np.moveaxis(self._corners, 1, 0)
        return normalize(np.cross(b - a, c - a) + np.finfo(float).tiny)


def nearest_on_triangles(points: Points, corners: Floats) -> Points:
    """Return the place of each triangle (n, 3, 3) that is nearest to its point (n, 3), (n, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    size = np.maximum(dot(normal, normal), np.finfo(float).tiny)
    foot = points - (dot(points - a, normal) / size)[:, None] * normal
    inside = np.ones(len(points), dtype=np.bool_)
    best, gap = foot, np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        span = end - start
        inside &= dot(np.cross(span, foot - start), normal) >= 0
        square = np.maximum(dot(span, span), np.finfo(float).tiny)
        along = np.clip(dot(points - start, span) / square, 0, 1)
        place = start + along[:, None] * span
        far = length(place - points)
        best = np.where((far < gap)[:, None], place, best)
        gap = np.minimum(gap, far)
    return np.where((inside & normal.any(axis=1))[:, None], foot, best)
