"""Sharp edges of a shape, for meshes of it that are made anew."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Edges, Floats, Points, UnitVectors
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import dot, length, normalize, sums_by_row
from scaffold_cad.mesh.trianglemesh import TriangleMesh

SHARP = 0.5
"""Cosine of the angle between triangles at which their edge is one of the shape: few triangles on a
curved surface are at large angles too."""

NEAREST = 8
"""How many pieces are looked at for the one nearest to a point."""

ON_EDGE = 1e-6
"""How near to a sharp edge a point is on it, in the largest extent of the shape."""


SHORTER = 0.9
"""Most length of a half of an edge along sharp ones, in whole ones: a half of a half circle's chord
has 0.71. An edge without such halves runs across, and both halves would not get shorter."""


class SharpEdges:
    """The sharp edges of a mesh whose triangles are of about one size, and their corners."""

    def __init__(self, mesh: TriangleMesh) -> None:
        edges = sharp_edges(mesh)
        self._ends = mesh.vertices[edges]  # (k, 2, 3)
        self._near = ON_EDGE * float(np.ptp(mesh.vertices, axis=0).max())
        self._tree = cKDTree(self._ends.mean(axis=1)) if len(edges) else None
        self._corners = cKDTree(mesh.vertices[_corners(mesh, edges)]) if len(edges) else None

    def nearest(self, points: Points) -> Points:
        """Return the place of a sharp edge that is nearest to each of `points` (n, 3)."""
        if self._tree is None or len(points) == 0:
            return points
        count = min(NEAREST, len(self._ends))
        piece = self._tree.query(points, k=count)[1].reshape(len(points), count)
        start, end = np.moveaxis(self._ends[piece], 2, 0)  # (n, count, 3)
        span = end - start
        along = dot(points[:, None] - start, span) / dot(span, span)
        places = start + np.clip(along, 0, 1)[..., None] * span
        best = length(places - points[:, None]).argmin(axis=1)
        found: Points = places[np.arange(len(points)), best]
        return found

    def on(self, points: Points) -> Bools:
        """Return which of `points` (n, 3) are on a sharp edge, (n,)."""
        if self._tree is None:
            return np.zeros(len(points), dtype=np.bool_)
        return np.asarray(length(self.nearest(points) - points) < self._near)

    def along(self, mesh: TriangleMesh, edges: Edges) -> Bools:
        """Return which edges (k, 2) of a mesh made anew run along sharp ones, (k,)."""
        count = len(mesh.vertices)
        if self._tree is None:
            return np.zeros(len(edges), dtype=np.bool_)
        sharp = sharp_edges(mesh)
        found: Bools = np.isin(edges.min(axis=1) * count + edges.max(axis=1), sharp @ [count, 1])
        return found & self.on(mesh.vertices)[edges].all(axis=1)

    def middles(self, mesh: TriangleMesh, edges: Edges) -> Points:
        """Return the middles of edges (k, 2), those along sharp edges moved onto them, (k, 3)."""
        ends = mesh.vertices[edges]  # (k, 2, 3)
        middles: Points = ends.mean(axis=1)
        along = np.flatnonzero(self.along(mesh, edges))
        places = self.nearest(middles[along])
        halves = length(places[:, None] - ends[along]).max(axis=1)
        kept = halves < SHORTER * length(np.diff(ends[along], axis=1)[:, 0])
        middles[along[kept]] = places[kept]
        return middles

    def ordered(self, mesh: TriangleMesh, edges: Edges) -> Edges:
        """Return edges that may be drawn together, the end first that keeps its place, (k, 2)."""
        if self._tree is None or self._corners is None:
            return edges
        on = self.on(mesh.vertices)
        corner = self._corners.query(mesh.vertices)[0] < self._near
        rank = (on.astype(np.intp) + (on & corner))[edges]  # (k, 2)
        free = (rank.min(axis=1) == 0) | ((rank.min(axis=1) == 1) & self.along(mesh, edges))
        edges, rank = edges[free], rank[free]
        return np.where((rank[:, 1] > rank[:, 0])[:, None], edges[:, ::-1], edges)


def sharp_edges(mesh: TriangleMesh) -> Edges:
    """Return the edges of a mesh between triangles at large angles, lower vertex first, (k, 2)."""
    start, end = sides_of(mesh.triangles).T
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort([high, low])
    pair = (low[order[1:]] == low[order[:-1]]) & (high[order[1:]] == high[order[:-1]])
    one, other = order[:-1][pair], order[1:][pair]
    normals = _normals(mesh)
    sharp = dot(normals[one // 3], normals[other // 3]) <= SHARP
    return np.stack([low[one], high[one]], axis=1)[sharp]


def _normals(mesh: TriangleMesh) -> UnitVectors:
    """Return the unit normal of each triangle, (t, 3)."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    areas: Floats = np.cross(b - a, c - a)
    return normalize(areas + np.finfo(float).tiny)


def _corners(mesh: TriangleMesh, edges: Edges) -> Bools:
    """Return the vertices at which sharp edges end, meet, or turn by a large angle, (v,)."""
    ends = np.concatenate([edges, edges[:, ::-1]])
    span = normalize(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])
    count = np.bincount(ends[:, 0], minlength=len(mesh.vertices))
    total = sums_by_row(span, ends[:, 0], len(count))
    # Of two unit vectors that leave a vertex the sum is 0 where the edge goes straight on.
    turns = dot(total, total) > 2 - 2 * SHARP
    found: Bools = (count > 0) & ((count != 2) | turns)
    return found
