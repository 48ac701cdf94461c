"""Short edges of triangle meshes, such as unions leave, drawn together to points."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Points, Triangles
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted, have_distinct_corners

LEAST_TURN = 0.2
"""Cosine of the angle that drawing an edge together may turn a triangle by."""

Lengths: TypeAlias = "float | Callable[[Points], Floats]"
"""A length everywhere, or a function of positions (n, 3) that returns lengths (n,), mm."""


def lengths_at(size: Lengths, points: Points) -> float | Floats:
    """Return the length that is asked for at positions (n, 3), mm."""
    return size(points) if callable(size) else size


def without_short_edges(
    mesh: TriangleMesh,
    shortest: Lengths,
    *,
    is_open: bool = False,
    near: Bools | None = None,
    order: Callable[[TriangleMesh, Edges], Edges] | None = None,
    longest: Lengths = np.inf,
    keep_vertices: bool = False,
) -> TriangleMesh:
    """Return a closed mesh with its edges shorter than `shortest` at their middles drawn together.

    An edge stays where drawing it together would pinch the surface: where a vertex beside both of
    its ends belongs to neither of its two triangles. The lower end of an edge keeps its place.

    Parameters
    ----------
    is_open : whether the mesh has a border, whose vertices keep their places
    near : (v,) bool; only edges between two of these vertices are drawn together
    order : function that returns those of a mesh's edges that may be drawn together, the end first
        that keeps its place; with it edges stay too that would turn a triangle over
    longest : edges stay whose drawing together would make others longer than this, with `order`
    keep_vertices : whether vertices keep their numbers, those that no triangle has any more too
    """
    triangles = mesh.triangles
    looked_at = np.ones(len(triangles), dtype=np.bool_)
    if near is not None:
        looked_at &= near[triangles].any(axis=1)
    while True:
        part = TriangleMesh(mesh.vertices, triangles[looked_at])
        edges = _short_edges(part, shortest)
        if near is not None:
            edges = edges[near[edges].all(axis=1)]
        if order is not None:
            edges = order(part, edges)
        if is_open:
            edges = _beside_border(part, edges)
        if order is not None:
            edges = edges[_stay_up(part, edges, longest)]
        chosen = _independent(part.triangles, edges)
        if len(chosen) == 0:
            if keep_vertices:
                return TriangleMesh(mesh.vertices, triangles)
            return compacted(mesh.vertices, triangles)
        target = np.arange(len(mesh.vertices))
        target[chosen[:, 1]] = chosen[:, 0]
        triangles = target[triangles]
        stays = have_distinct_corners(triangles)
        triangles, looked_at = triangles[stays], looked_at[stays]


def _short_edges(mesh: TriangleMesh, shortest: Lengths) -> Edges:
    """Return the edges shorter than `shortest`, lower vertex first, the shortest first, (k, 2)."""
    ends = sides_of(mesh.triangles)
    ends = ends[ends[:, 0] < ends[:, 1]]  # each edge once: its other triangle runs back along it
    spans = length(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])
    least = lengths_at(shortest, mesh.vertices[ends].mean(axis=1)) if len(ends) else 0.0
    short = np.flatnonzero(spans < least)
    return ends[short[np.argsort(spans[short], kind="stable")]]


def _beside_border(mesh: TriangleMesh, edges: Edges) -> Edges:
    """Return those of `edges` that have no more than one end on the border, that end first."""
    on_border = np.zeros(len(mesh.vertices), dtype=np.bool_)
    on_border[mesh.faulty_sides()[1]] = True
    ends = on_border[edges]  # (k, 2)
    edges, ends = edges[~ends.all(axis=1)], ends[~ends.all(axis=1)]
    return np.where(ends[:, 1:], edges[:, ::-1], edges)


def _stay_up(mesh: TriangleMesh, edges: Edges, longest: Lengths) -> Bools:
    """Return which edges, drawn together at their first end, leave good triangles, (k,).

    None is turned by much, and no side is longer than `longest`.
    """
    corner = mesh.triangles.reshape(-1)
    by_vertex = np.argsort(corner, kind="stable")
    count = np.bincount(corner, minlength=len(mesh.vertices))
    first = np.cumsum(count) - count
    of_edge = np.repeat(np.arange(len(edges)), count[edges[:, 1]])
    rank = steps(count[edges[:, 1]])
    side = by_vertex[first[edges[of_edge, 1]] + rank]
    moved, fixed = corner[side], edges[of_edge, 0]
    after, last = (corner[side // 3 * 3 + (side % 3 + k) % 3] for k in (1, 2))
    stays = (after != fixed) & (last != fixed)  # the others go
    b, c = mesh.vertices[after[stays]], mesh.vertices[last[stays]]
    before, now = (
        normalize(np.cross(b - a, c - a) + np.finfo(float).tiny)
        for a in (mesh.vertices[moved[stays]], mesh.vertices[fixed[stays]])
    )
    found = np.ones(len(edges), dtype=np.bool_)
    found[of_edge[stays][dot(before, now) < LEAST_TURN]] = False
    end = mesh.vertices[fixed[stays]]
    long = length(b - end) > lengths_at(longest, (b + end) / 2)
    found[of_edge[stays][long]] = False
    return found


def _independent(triangles: Triangles, edges: Edges) -> Edges:
    """Return those of `edges` that may be drawn together at once, (k, 2)."""
    touched: set[int] = set()
    chosen = []
    ends = set(edges.reshape(-1).tolist())
    near = np.flatnonzero(np.isin(triangles, edges).any(axis=1))
    neighbors: dict[int, set[int]] = {vertex: set() for vertex in ends}
    for row in triangles[near].tolist():
        for vertex in row:
            if vertex in neighbors:
                neighbors[vertex] |= set(row)
    for a, b in edges.tolist():
        around = neighbors[a] | neighbors[b]
        # Two common neighbors besides the ends themselves: the link condition.
        if len(neighbors[a] & neighbors[b]) == 4 and not around & touched:
            touched |= around
            chosen.append((a, b))
    return np.asarray(chosen, dtype=np.intp).reshape(-1, 2)
