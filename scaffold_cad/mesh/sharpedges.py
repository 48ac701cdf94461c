"""Sharp edges of a shape, which remeshing keeps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.topology import chains, sides_of
from scaffold_cad.base.vectors import dot, length, normalize, sums_by_row
from scaffold_cad.mesh.trianglemesh import TriangleMesh

SHARP = 0.5
"""Cosine of the angle between triangles at which their edge is one of the shape: few triangles on a
curved surface are at large angles too."""

NEAREST = 8
"""How many pieces are looked at for the one nearest to a point."""

ON_EDGE = 1e-6
"""How near to a sharp edge a point is on it, in the largest extent of the shape."""

LEAST_AROUND = 6
"""Least vertices that are left on a sharp edge that closes, such as the rim of a hole: arcs farther
from their chords would leave quads beside them no room."""


@dataclass(frozen=True, eq=False)
class Runs(Frozen):
    """What runs from vertex to next vertex along the sharp edges, in a remeshed mesh."""

    keys: Ints
    """Its ends as lower · v + higher of v vertices, ascending, shape (k,)."""
    middles: Points
    """The place halfway along the sharp edge, shape (k, 3), mm."""
    lengths: Floats
    """Lengths along it, shape (k,), mm."""
    can_shrink: Bools
    """Whether a sharp edge that closes keeps vertices enough without it, shape (k,)."""
    vertices: int
    """Number of vertices of the mesh."""

    def of(self, edges: Edges) -> Ints:
        """Return the run that each edge (e, 2) of the mesh is, -1 for none, (e,)."""
        key = edges.min(axis=1) * self.vertices + edges.max(axis=1)
        if len(self.keys) == 0:
            return np.full(len(edges), -1)
        at = np.minimum(np.searchsorted(self.keys, key), len(self.keys) - 1)
        return np.where(self.keys[at] == key, at, -1)


class SharpEdges:
    """The sharp edges of a mesh whose triangles are of about one size, and their corners."""

    def __init__(self, mesh: TriangleMesh) -> None:
        edges = sharp_edges(mesh)
        corners = _corners(mesh, edges)
        self._near = ON_EDGE * float(np.ptp(mesh.vertices, axis=0).max())
        flat, count = edges.reshape(-1), len(mesh.vertices)
        # A corner is another node for each edge that ends there: chains go from corner to corner.
        apart = np.where(corners[flat], count + np.arange(len(flat)), flat)
        found = chains(apart.reshape(-1, 2), count + len(flat))
        half = found.half_edges
        self._starts, self._ends = mesh.vertices[flat[half]], mesh.vertices[flat[half ^ 1]]
        self._reach = np.concatenate([[0.0], np.cumsum(length(self._ends - self._starts))])
        self._closed, self._bounds = found.closed, self._reach[found.offsets]
        self._tree = cKDTree((self._starts + self._ends) / 2) if len(edges) else None
        self._corners = cKDTree(mesh.vertices[corners]) if corners.any() else None

    def on(self, points: Points) -> Bools:
        """Return which of `points` (n, 3) are on a sharp edge, (n,)."""
        return self._places(points)[1]

    def runs(self, mesh: TriangleMesh) -> Runs:
        """Return what runs along sharp edges from one vertex of a remeshed mesh to the next."""
        vertex, reach = self._stations(mesh)
        chain = np.searchsorted(self._bounds, reach, side="right") - 1
        count = np.bincount(chain, minlength=len(self._closed))
        same = np.flatnonzero(chain[1:] == chain[:-1])
        around = np.flatnonzero(self._closed & (count > 1))
        first = np.cumsum(count) - count
        one = np.concatenate([same, (first + count - 1)[around]])
        other = np.concatenate([same + 1, first[around]])
        far = reach[other] + np.diff(self._bounds)[chain[one]] * (other < one)
        low, high = np.sort(np.stack([vertex[one], vertex[other]]), axis=0)
        key, rows = np.unique(low * len(mesh.vertices) + high, return_index=True)
        has_ends = ~self._closed & (count > 0)
        has_ends[has_ends] = vertex[first[has_ends]] != vertex[(first + count - 1)[has_ends]]
        chain, one, far = chain[one[rows]], one[rows], far[rows]
        return Runs(
            key,
            self._at(chain, (reach[one] + far) / 2),
            far - reach[one],
            has_ends[chain] | (count[chain] > LEAST_AROUND),
            len(mesh.vertices),
        )

    def ordered(self, mesh: TriangleMesh, edges: Edges) -> Edges:
        """Return edges that may be drawn together, the end first that keeps its place, (k, 2)."""
        if self._tree is None:
            return edges
        on = self.on(mesh.vertices)
        rank = (on.astype(np.intp) + (on & self._is_corner(mesh.vertices)))[edges]  # (k, 2)
        runs = self.runs(mesh)
        run = runs.of(edges)
        shrinks = np.zeros(len(edges), dtype=np.bool_)
        shrinks[run >= 0] = runs.can_shrink[run[run >= 0]]
        free = (rank.min(axis=1) == 0) | ((rank.min(axis=1) == 1) & shrinks)
        edges, rank = edges[free], rank[free]
        return np.where((rank[:, 1] > rank[:, 0])[:, None], edges[:, ::-1], edges)

    def _stations(self, mesh: TriangleMesh) -> tuple[Ints, Floats]:
        """Return vertices of a mesh along sharp edges in order, and how far along each is, (k,).

        Corners come once for each sharp edge that ends there.
        """
        reach, on = self._places(mesh.vertices)
        corner = on & self._is_corner(mesh.vertices)
        inner = np.flatnonzero(on & ~corner)
        vertex, along = [inner], [reach[inner]]
        some = np.flatnonzero(~self._closed)
        if len(some) and corner.any():
            known = np.flatnonzero(corner)
            last = np.searchsorted(self._reach, self._bounds[some + 1]) - 1
            ends = self._starts[np.searchsorted(self._reach, self._bounds[some])], self._ends[last]
            # The last place of a chain is just before the first of the next one.
            reaches = self._bounds[some], np.nextafter(self._bounds[some + 1], 0.0)
            for places, far in zip(ends, reaches, strict=True):
                gap, nearest = cKDTree(mesh.vertices[known]).query(places)
                there = np.flatnonzero(gap < self._near)
                vertex.append(known[np.asarray(nearest)[there]])
                along.append(far[there])
        order = np.argsort(np.concatenate(along), kind="stable")
        return np.concatenate(vertex)[order], np.concatenate(along)[order]

    def _places(self, points: Points) -> tuple[Floats, Bools]:
        """Return how far along all sharp edges points are, and whether they are on one."""
        if self._tree is None or len(points) == 0:
            return np.zeros(len(points)), np.zeros(len(points), dtype=np.bool_)
        count = min(NEAREST, len(self._starts))
        piece = self._tree.query(points, k=count)[1].reshape(len(points), count)
        start = self._starts[piece]
        span = self._ends[piece] - start  # (n, count, 3)
        along = np.clip(dot(points[:, None] - start, span) / dot(span, span), 0, 1)
        gaps = length(start + along[..., None] * span - points[:, None])
        row, best = np.arange(len(points)), gaps.argmin(axis=1)
        first, last = self._reach[piece[row, best]], self._reach[piece[row, best] + 1]
        reach = first + along[row, best] * (last - first)
        return np.minimum(reach, np.nextafter(last, 0.0)), gaps[row, best] < self._near

    def _at(self, chain: Ints, reach: Floats) -> Points:
        """Return places so far along all sharp edges, past the end of a closed one around it."""
        low, high = self._bounds[chain], self._bounds[chain + 1]
        reach = np.where(reach < high, reach, reach - (high - low))
        piece = np.searchsorted(self._reach, reach, side="right") - 1
        share = (reach - self._reach[piece]) / np.diff(self._reach)[piece]
        start = self._starts[piece]
        places: Points = start + share[:, None] * (self._ends[piece] - start)
        return places

    def _is_corner(self, points: Points) -> Bools:
        if self._corners is None:
            return np.zeros(len(points), dtype=np.bool_)
        return np.asarray(self._corners.query(points)[0] < self._near)


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
