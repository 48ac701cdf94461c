"""Connectivity of closed quad meshes, with creases, and of their subdivisions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array

from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    Quads,
    as_indices,
    read_only,
)
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh

NO_CREASES: Edges = np.zeros((0, 2), dtype=np.intp)
"""The creases of a surface that is smooth everywhere."""
read_only(NO_CREASES)


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
    def of(cls, mesh: QuadMesh, creases: ArrayLike) -> Connectivity:
        """Return the connectivity of `mesh`; `creases` are pairs of its vertices, (k, 2).

        Raises
        ------
        MeshError
            If the mesh is not closed, or `creases` are not pairs of vertices that an edge joins.
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
        """Side on which the neighboring quad runs back along each side, shape (4 f,)."""
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
        side = side[side >= 0]  # one per vertex: the first
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

    def sum_of_crease_neighbors(self, points: Points) -> Points:
        """Return the sum of the other ends of the creases at each vertex, shape (v, 3)."""
        ends = self.edges[self.is_crease]
        sums = self.sum_at_vertices(ends, points[ends[:, 0]] + points[ends[:, 1]])
        return sums - self.crease_valence[:, None] * points

    def sum_of_corners(self, points: Points) -> Points:
        """Return the sum of the corners of each quad, shape (f, 3)."""
        # Four gathers are several times as fast as a sum along the middle axis of one.
        total = points.take(self.quads[:, 0], axis=0)
        for corner in range(1, 4):
            total += points.take(self.quads[:, corner], axis=0)
        return total

    def subdivided(self) -> Connectivity:
        """Return the connectivity of the mesh whose quads are cut in four.

        The old vertices come first, then one per edge and one per quad. Quad `4 i + k` is the part
        of quad i at its corner k. Edges `2 i` and `2 i + 1` are the halves of edge i; then come
        four per quad, from its sides to its middle.
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


def _columns(*columns: Ints) -> Ints:
    """Return the arrays, flattened, as columns."""
    table = np.empty((columns[0].size, len(columns)), dtype=np.intp)
    for k, column in enumerate(columns):
        table[:, k] = column.reshape(-1)
    return table


def _rows_of(mesh: QuadMesh, creases: ArrayLike) -> Ints:
    """Return the rows of `creases` (k, 2) in `mesh.edges`, (k,)."""
    pairs = as_indices(creases, "creases", MeshError)
    if pairs.size == 0:
        return pairs.reshape(-1)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise MeshError(f"creases has shape {pairs.shape}; need (k, 2)")
    count = len(mesh.vertices)
    low, high = np.sort(pairs, axis=1).T
    keys = mesh.edges[:, 0] * count + mesh.edges[:, 1]  # ascending
    # Beyond the vertices a key would be another edge's.
    wanted = np.where((low >= 0) & (high < count), low * count + high, -1)
    rows: Ints = np.searchsorted(keys, wanted)
    rows[rows == len(keys)] = 0
    strange = np.flatnonzero(keys[rows] != wanted)
    if len(strange):
        raise MeshError(f"crease {pairs[strange[0]].tolist()} is not an edge of the mesh")
    return rows
