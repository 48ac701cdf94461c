"""Quads from a plane multigraph on the directions, drawn along Delaunay edges.

A multigraph whose every direction has four edges is the dual of a quadrangulation: each
direction is a quad, each edge an arc between two quads, and each face a vertex. The edges are
Delaunay edges taken 0, 1 or 2 times: where one is left out the faces beside it merge, and where
one is doubled a face of two sides lies between the copies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Ints, UnitVectors
from scaffold_cad.base.vectors import normalize, sums_by_row
from scaffold_cad.partition.arcs import is_closed
from scaffold_cad.partition.delaunay import Triangulations

EDGES_EACH = 4
"""Edges of the multigraph at each direction: its quad has as many sides."""


@dataclass(frozen=True, eq=False)
class Quadrangulations:
    """Quads around each direction, not yet certified."""

    vertices: UnitVectors
    """First guess at the vertices, near the Voronoi vertices that merge there, (K, N + 2, 3)."""
    quads: Ints
    """Vertices of the quad around each direction, counter-clockwise, shape (K, N, 4)."""

    def __getitem__(self, chosen: Ints | Bools | slice) -> Quadrangulations:
        return Quadrangulations(self.vertices[chosen], self.quads[chosen])

    def __len__(self) -> int:
        return len(self.quads)


def quadrangulations(
    triangulations: Triangulations, stars: UnitVectors, multiplicity: Ints
) -> tuple[Quadrangulations, Ints]:
    """Return the duals of those multigraphs that have one, and which these are.

    Parameters
    ----------
    triangulations : K of them
    stars : (K, N, 3) float64, the directions triangulated
    multiplicity : (K, 6 N − 12) intp, how often each half-edge's edge is taken; the edges at
        each direction must add up to four

    Notes
    -----
    A multigraph has no dual made of arcs of great circles if it is not connected, or if it
    falls apart without two of its edges: two faces would meet along both.
    """
    valency = triangulations.triangles.shape[1] // 2 + 2
    faces, count = _merged_triangles(triangulations, multiplicity)  # (K, 2 N - 4), (K,)
    doubled = (multiplicity == 2) & _is_first(triangulations.twins)
    pockets = count[:, None] + np.cumsum(doubled, axis=1) - 1
    pockets = np.take_along_axis(pockets, _lower(triangulations.twins), axis=1)
    connected = np.flatnonzero(count + doubled.sum(axis=1) == valency + 2)

    triangulations = triangulations[connected]
    quads = _quads(triangulations, multiplicity[connected], faces[connected], pockets[connected])
    vertices = _vertices(
        triangulations, stars[connected], faces[connected], pockets[connected], doubled[connected]
    )
    kept = is_closed(quads)
    return Quadrangulations(vertices[kept], quads[kept]), connected[kept]


def _is_first(twins: Ints) -> Bools:
    """Return whether each half-edge is the lower one of its edge."""
    return np.arange(twins.shape[1]) < twins


def _lower(twins: Ints) -> Ints:
    """Return the lower half-edge of each half-edge's edge."""
    return np.minimum(np.arange(twins.shape[1]), twins)


def _merged_triangles(triangulations: Triangulations, multiplicity: Ints) -> tuple[Ints, Ints]:
    """Return the face that each triangle belongs to, (K, 2 N − 4), and the number of faces."""
    rows, triangles = triangulations.triangles.shape[:2]
    offset = triangles * np.arange(rows)[:, None]
    half_edges = np.arange(3 * triangles)
    open_ = multiplicity == 0
    here = (offset + half_edges // 3)[open_]
    there = (offset + triangulations.twins // 3)[open_]
    size = rows * triangles
    links = coo_array((np.ones(len(here), dtype=np.int8), (here, there)), shape=(size, size))
    _, labels = connected_components(links, directed=False)
    lowest = np.full(size, size)
    np.minimum.at(lowest, labels, np.arange(size))
    lowest = lowest[labels].reshape(rows, triangles)
    is_lowest = lowest == offset + np.arange(triangles)
    rank = np.cumsum(is_lowest, axis=1) - 1
    return np.take_along_axis(rank, lowest - offset, axis=1), is_lowest.sum(axis=1)


def _quads(triangulations: Triangulations, multiplicity: Ints, faces: Ints, pockets: Ints) -> Ints:
    """Return the faces around each direction in counter-clockwise order, shape (K, N, 4)."""
    rows, triangles = faces.shape
    valency = triangles // 2 + 2
    half_edge = np.arange(3 * triangles)
    # Counter-clockwise around its tail, a half-edge is followed by the twin of the one before it.
    turned = triangulations.twins[:, half_edge - half_edge % 3 + (half_edge + 2) % 3]
    first = np.empty((rows, valency), dtype=np.intp)
    np.put_along_axis(first, triangulations.tails, half_edge[None], axis=1)

    flat = np.empty(rows * valency * 4, dtype=np.intp)
    place = 4 * np.arange(rows * valency).reshape(rows, valency)
    last = place + 3
    current, turning = first, np.ones((rows, valency), dtype=np.bool_)
    while turning.any():
        copies = np.where(turning, np.take_along_axis(multiplicity, current, axis=1), 0)
        double, some = copies == 2, copies > 0
        flat[place[double]] = np.take_along_axis(pockets, current, axis=1)[double]
        place = np.minimum(place + double, last)
        flat[place[some]] = np.take_along_axis(faces, current // 3, axis=1)[some]
        place = np.minimum(place + some, last)
        current = np.take_along_axis(turned, current, axis=1)
        turning &= current != first
    return flat.reshape(rows, valency, 4)


def _vertices(
    triangulations: Triangulations, stars: UnitVectors, faces: Ints, pockets: Ints, doubled: Bools
) -> UnitVectors:
    """Return the mean of the Voronoi vertices of each face, shape (K, N + 2, 3).

    A face between two copies of an edge gets the middle of the edge's Voronoi arc, which bisects
    the edge's directions and its own ends; the ends may be opposite, as in a coplanar star.
    """
    rows, triangles = faces.shape
    count = triangles // 2 + 4
    vertex = faces + count * np.arange(rows)[:, None]
    sums = sums_by_row(triangulations.centers, vertex, rows * count)
    row, half_edge = np.nonzero(doubled)
    tail, head = triangulations.tails[row, half_edge], triangulations.heads[row, half_edge]
    left = triangulations.centers[row, half_edge // 3]
    right = triangulations.centers[row, triangulations.twins[row, half_edge] // 3]
    middles = np.cross(stars[row, tail] - stars[row, head], right - left)
    sums[count * row + pockets[row, half_edge]] = middles
    return normalize(sums).reshape(rows, count, 3)
