"""Catmull-Clark subdivision of closed quad meshes, with creases, and its limit surface.

References
----------
Catmull, Clark, Recursively generated B-spline surfaces, Computer-Aided Design 10(6), 1978.
Halstead, Kass, DeRose, Efficient, fair interpolation using Catmull-Clark surfaces, SIGGRAPH 1993.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array

from scaffold_cad.arguments import as_count, check_kind
from scaffold_cad.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    Quads,
    UnitVectors,
    read_only,
)
from scaffold_cad.errors import MeshError
from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.vectors import normalize

NO_CREASES: Edges = np.zeros((0, 2), dtype=np.intp)
"""The creases of a surface that is smooth everywhere."""
read_only(NO_CREASES)


@dataclass(frozen=True, eq=False)
class Subdivision(Frozen):
    """A subdivided mesh, and where its quads come from."""

    mesh: QuadMesh
    """The subdivided mesh: the vertices of the mesh before come first, then one an edge and one
    a quad."""
    creases: Edges
    """Vertex pairs across which it stays sharp, shape (k, 2)."""
    quad_of_quad: Ints
    """Quad of the mesh before that each quad is a part of, shape (f,)."""


@dataclass(frozen=True, eq=False)
class Limit(Frozen):
    """Where the vertices of a mesh lie on its Catmull-Clark limit surface."""

    points: Points
    """Limit position of each vertex, shape (v, 3), mm."""
    normals: UnitVectors
    """Outward normal of the limit surface there, shape (v, 3); at a vertex on a crease the mean
    of the normals of its quads."""


@dataclass(frozen=True, eq=False)
class Connectivity(Frozen):
    """The edges of a closed quad mesh, in any order, and which of them are creases."""

    quads: Quads
    """Vertex indices of each quad, shape (f, 4)."""
    count: int
    """Number of vertices."""
    edges: Edges
    """Vertex pairs, shape (e, 2)."""
    edge_of_side: Ints
    """Edge of each quad's four sides in turn, shape (f, 4)."""
    is_crease: Bools
    """Whether each edge is a crease, shape (e,)."""

    @classmethod
    def of(cls, mesh: QuadMesh, creases: Edges) -> Connectivity:
        """Return the connectivity of `mesh`.

        Raises
        ------
        MeshError
            If the mesh is not closed, or a crease is no edge of it.
        """
        mesh.check_closed()
        is_crease = np.zeros(len(mesh.edges), dtype=np.bool_)
        is_crease[_rows_of(mesh, creases)] = True
        edge_of_side = mesh.edge_of_half_edge.reshape(-1, 4)
        return cls(mesh.quads, len(mesh.vertices), mesh.edges, edge_of_side, is_crease)

    @cached_property
    def valence(self) -> Ints:
        """Number of edges at each vertex, shape (v,)."""
        return np.bincount(self.quads.reshape(-1), minlength=self.count)

    @cached_property
    def crease_valence(self) -> Ints:
        """Number of creases at each vertex, shape (v,)."""
        return np.bincount(self.edges[self.is_crease].reshape(-1), minlength=self.count)

    @cached_property
    def sides_of_edge(self) -> Ints:
        """The two sides of quads that run along each edge, shape (e, 2).

        Side `4 i + k` runs from corner k of quad i to the next corner. Twice the same where part
        of a mesh ends.
        """
        order = np.argsort(self.edge_of_side, axis=None, kind="stable")
        if len(order) == 2 * len(self.edges):
            return order.reshape(-1, 2)
        last = np.cumsum(np.bincount(self.edge_of_side.reshape(-1)))
        first = np.concatenate([[0], last[:-1]])
        sides: Ints = order[np.stack([first, last - 1], axis=1)]
        return sides

    @cached_property
    def twin(self) -> Ints:
        """Side on which the neighbouring quad runs back along each side, shape (4 f,)."""
        twin = np.empty(self.quads.size, dtype=np.intp)
        twin[self.sides_of_edge[:, 0]] = self.sides_of_edge[:, 1]
        twin[self.sides_of_edge[:, 1]] = self.sides_of_edge[:, 0]
        return twin

    @cached_property
    def turn(self) -> Ints:
        """Number of edges between each side and the first one that leaves its vertex, (4 f,).

        Counted counter-clockwise seen from outside.
        """
        sides = np.arange(4 * len(self.quads))
        # Counter-clockwise about its vertex, a side is followed by the twin of the side before it.
        following = self.twin[(sides & ~3) | ((sides - 1) & 3)]
        side = np.full(self.count, -1, dtype=np.intp)
        side[self.quads.reshape(-1)[::-1]] = sides[::-1]
        side = side[side >= 0]  # one a vertex: the first
        first = side.copy()
        turn = np.empty(len(sides), dtype=np.intp)
        steps = 0
        while len(side):
            turn[side] = steps
            steps += 1
            side = following[side]
            going = side != first
            side, first = side[going], first[going]
        return turn

    def sum_at_vertices(self, owners: Ints, values: Floats) -> Points:
        """Return the sum at each vertex of the rows of `values` that it owns, shape (v, 3).

        Parameters
        ----------
        owners : (k, j) intp, the j vertices that each row is added to
        values : (k, 3) float64
        """
        starts = np.arange(len(owners) + 1) * owners.shape[1]
        scatter = csc_array(
            (np.ones(owners.size), owners.reshape(-1), starts), shape=(self.count, len(owners))
        )
        return np.asarray(scatter @ values)

    def sum_of_crease_neighbours(self, points: Points) -> Points:
        """Return the sum of the other ends of the creases at each vertex, shape (v, 3)."""
        ends = self.edges[self.is_crease]
        sums = self.sum_at_vertices(ends, points[ends[:, 0]] + points[ends[:, 1]])
        return sums - self.crease_valence[:, None] * points

    def subdivided(self) -> Connectivity:
        """Return the connectivity of the mesh whose quads are cut in four.

        The old vertices come first, then one an edge and one a quad. Quad `4 i + k` is the part
        of quad i at its corner k. Edges `2 i` and `2 i + 1` are the halves of edge i; then come
        four a quad, from its sides to its middle.
        """
        edge, count = self.edge_of_side, len(self.edges)
        at_edge = self.count + edge  # (f, 4)
        at_quad = np.repeat(self.count + count + np.arange(len(edge)), 4).reshape(-1, 4)
        spoke = 2 * count + np.arange(edge.size).reshape(-1, 4)
        forward = self.edges[:, 0][edge] == self.quads
        ahead, back = 2 * edge + ~forward, np.roll(2 * edge + forward, 1, axis=1)

        quads = _columns(self.quads, at_edge, at_quad, np.roll(at_edge, 1, axis=1))
        edge_of_side = _columns(ahead, spoke, np.roll(spoke, 1, axis=1), back)
        halves = _columns(self.edges, np.repeat(self.count + np.arange(count), 2))
        edges = np.concatenate([halves, _columns(at_edge, at_quad)])
        is_crease = np.zeros(len(edges), dtype=np.bool_)
        is_crease[: 2 * count] = np.repeat(self.is_crease, 2)
        return Connectivity(quads, self.count + count + len(edge), edges, edge_of_side, is_crease)


def grid_places(levels: int) -> Ints:
    """Return where the corners of a quad's parts are on its grid, (4^levels, 4, 2).

    The parts are in the order of `Connectivity.subdivided`. Corner 0 of the quad is at [0, 0],
    corner 1 at [2^levels, 0].
    """
    places = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]]])
    for _ in range(levels):
        corner = 2 * places
        ahead = places + np.roll(places, -1, axis=1)
        middle = np.broadcast_to(places.sum(axis=1, keepdims=True) // 2, places.shape)
        before = np.roll(ahead, 1, axis=1)
        places = np.stack([corner, ahead, middle, before], axis=2).reshape(-1, 4, 2)
    return places


def as_grids(corners: Floats, levels: int) -> Floats:
    """Return what `corners` of the parts of quads are, on a grid a quad.

    Parameters
    ----------
    corners : (f · 4^levels, 4, 3) float64, of the parts in the order of `Connectivity.subdivided`

    Returns
    -------
    (f, 2^levels + 1, 2^levels + 1, 3) float64
    """
    places = grid_places(levels)
    count = 2**levels + 1
    grids = np.empty((len(corners) // 4**levels, count, count, 3))
    grids[:, places[..., 0], places[..., 1]] = corners.reshape(-1, *places.shape[:2], 3)
    return grids


def _columns(*columns: Ints) -> Ints:
    """Return the arrays, flattened, as columns."""
    table = np.empty((columns[0].size, len(columns)), dtype=np.intp)
    for k, column in enumerate(columns):
        table[:, k] = column.reshape(-1)
    return table


def catmull_clark(mesh: QuadMesh, levels: int = 1, creases: Edges = NO_CREASES) -> Subdivision:
    """Return `mesh` subdivided `levels` times.

    Parameters
    ----------
    mesh : closed
    levels : ≥ 0; each one cuts every quad in four
    creases : (k, 2) intp, vertex pairs of edges that stay sharp; a chain of them tends to a
        cubic B-spline curve, and a vertex where three or more meet does not move

    Raises
    ------
    MeshError
        If the mesh is not closed, or a crease is no edge of it.
    OptionError
        If `mesh` is none, or `levels` is no whole number ≥ 0.
    """
    check_kind(mesh, QuadMesh)
    connectivity, points = Connectivity.of(mesh, creases), mesh.vertices
    connectivity, points = subdivided(connectivity, points, levels)
    return as_subdivision(connectivity, points, levels)


def subdivided(
    connectivity: Connectivity, points: Points, levels: int
) -> tuple[Connectivity, Points]:
    """Return the connectivity and the vertices of a mesh subdivided `levels` times."""
    for _ in range(as_count(levels, "levels")):
        points = subdivided_points(connectivity, points)
        connectivity = connectivity.subdivided()
    return connectivity, points


def as_subdivision(connectivity: Connectivity, points: Points, levels: int) -> Subdivision:
    """Return the mesh with `points` (v, 3) that is the `levels`-th subdivision of another."""
    return Subdivision(
        mesh=QuadMesh(points, connectivity.quads),
        creases=connectivity.edges[connectivity.is_crease],
        quad_of_quad=np.arange(len(connectivity.quads)) // 4**levels,
    )


def subdivided_points(connectivity: Connectivity, points: Points) -> Points:
    """Return the vertices of the mesh whose quads are cut in four, (v + e + f, 3)."""
    quads, edges = connectivity.quads, connectivity.edges
    middles = _sum_of_corners(quads, points) / 4  # (f, 3)
    ends = points.take(edges[:, 0], axis=0) + points.take(edges[:, 1], axis=0)  # (e, 3)
    beside = connectivity.sides_of_edge >> 2
    at_edges = ends + middles.take(beside[:, 0], axis=0) + middles.take(beside[:, 1], axis=0)
    at_edges /= 4

    valence = np.maximum(connectivity.valence, 1)[:, None]
    around = connectivity.sum_at_vertices(edges, ends) + connectivity.sum_at_vertices(
        quads, middles
    )
    at_vertices = ((valence - 3) * points + around / valence) / valence
    creases = connectivity.crease_valence[:, None]
    if connectivity.is_crease.any():
        at_edges[connectivity.is_crease] = ends[connectivity.is_crease] / 2
        along = (6 * points + connectivity.sum_of_crease_neighbours(points)) / 8
        at_vertices = np.where(creases == 2, along, at_vertices)
        at_vertices = np.where(creases > 2, points, at_vertices)
    return np.concatenate([at_vertices, at_edges, middles])


def limit(mesh: QuadMesh, creases: Edges = NO_CREASES) -> Limit:
    """Return where the vertices of `mesh` lie on its Catmull-Clark limit surface.

    Parameters
    ----------
    mesh : closed
    creases : (k, 2) intp, vertex pairs of edges that stay sharp

    Raises
    ------
    MeshError
        If the mesh is not closed, or a crease is no edge of it.
    """
    connectivity = Connectivity.of(mesh, creases)
    first, second = limit_tangents(connectivity, mesh.vertices)
    normals = np.cross(first, second)
    creased = connectivity.crease_valence > 1
    if creased.any():
        normals[creased] = sum_of_normals(connectivity, mesh.vertices)[creased]
    return Limit(limit_points(connectivity, mesh.vertices), normalize(normals))


def limit_points(connectivity: Connectivity, points: Points) -> Points:
    """Return the limit positions of the vertices, (v, 3)."""
    quads, edges = connectivity.quads, connectivity.edges
    ends = points.take(edges[:, 0], axis=0) + points.take(edges[:, 1], axis=0)  # (e, 3)
    valence = np.maximum(connectivity.valence, 1)[:, None]
    around = 2 * connectivity.sum_at_vertices(edges, ends)
    around += connectivity.sum_at_vertices(quads, _sum_of_corners(quads, points))
    limits: Points = ((valence - 3) * points + around / valence) / (valence + 5)
    if connectivity.is_crease.any():
        creases = connectivity.crease_valence[:, None]
        along = (4 * points + connectivity.sum_of_crease_neighbours(points)) / 6
        limits = np.where(creases == 2, along, limits)
        limits = np.where(creases > 2, points, limits)
    return limits


def _sum_of_corners(quads: Quads, points: Points) -> Points:
    """Return the sum of the corners of each quad, (f, 3)."""
    # Four gathers are several times as fast as a sum along the middle axis of one.
    total = points.take(quads[:, 0], axis=0)
    for corner in range(1, 4):
        total += points.take(quads[:, corner], axis=0)
    return total


def limit_tangents(connectivity: Connectivity, points: Points) -> tuple[Floats, Floats]:
    """Return two vectors a vertex that span the limit surface's tangent plane there, (v, 3) each.

    The first points along the first side that leaves the vertex; their cross product points
    outwards. Creases are not heeded.
    """
    step = 2 * np.pi / np.maximum(connectivity.valence, 1)  # (v,)
    weight = 1 + np.cos(step) + np.cos(step / 2) * np.sqrt(2 * (9 + np.cos(step)))
    owners = connectivity.quads.reshape(-1)  # (4 f,)
    angle = connectivity.turn * step[owners]
    ahead = points[np.roll(connectivity.quads, -1, axis=1).reshape(-1)]
    across = points[np.roll(connectivity.quads, -2, axis=1).reshape(-1)]

    def tangent(now: Floats, then: Floats) -> Floats:
        terms = (weight[owners] * now)[:, None] * ahead + (now + then)[:, None] * across
        return connectivity.sum_at_vertices(owners[:, None], terms)

    after = angle + step[owners]
    return tangent(np.cos(angle), np.cos(after)), tangent(np.sin(angle), np.sin(after))


def sum_of_normals(connectivity: Connectivity, points: Points) -> Floats:
    """Return the sum of the cross products of the sides at each vertex, (v, 3), mm²."""
    corners = points[connectivity.quads]
    ahead = np.roll(corners, -1, axis=1) - corners
    products = np.cross(ahead, -np.roll(ahead, 1, axis=1)).reshape(-1, 3)
    return connectivity.sum_at_vertices(connectivity.quads.reshape(-1, 1), products)


def _rows_of(mesh: QuadMesh, creases: Edges) -> Ints:
    """Return the rows of `creases` (k, 2) in `mesh.edges`, (k,)."""
    low, high = np.sort(creases, axis=1).T
    keys = mesh.edges[:, 0] * len(mesh.vertices) + mesh.edges[:, 1]  # ascending
    wanted = low * len(mesh.vertices) + high
    rows: Ints = np.searchsorted(keys, wanted)
    rows[rows == len(keys)] = 0
    strange = np.flatnonzero(keys[rows] != wanted)
    if len(strange):
        raise MeshError(f"crease {creases[strange[0]].tolist()} is no edge of the mesh")
    return rows
