"""QuadMesh: vertices and quads, and what can be asked of them without a skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    Quads,
    Triangles,
    as_points,
    as_quads,
)
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.summaries import counted, size_text
from scaffold_cad.base.vectors import dot
from scaffold_cad.errors import MeshError


@checks_keywords()
@dataclass(frozen=True, eq=False)
class QuadMesh(Frozen, Shown):
    """A mesh of quads, each counter-clockwise seen from outside.

    Examples
    --------
    >>> from scaffold_cad import QuadMesh
    >>> square = QuadMesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> print(square)
    QuadMesh: 4 vertices, 1 quad, 1 x 1 x 0 mm
    """

    vertices: Points
    """Vertex positions, shape (v, 3), mm."""
    quads: Quads
    """Vertex indices of each quad, shape (f, 4)."""

    def __init__(self, vertices: ArrayLike, quads: ArrayLike) -> None:
        points = as_points(vertices, "vertices", MeshError)
        self._keep(vertices=points, quads=as_quads(quads, "quads", count=len(points)))

    def __str__(self) -> str:
        vertices = counted(len(self.vertices), "vertex", "vertices")
        quads = counted(len(self.quads), "quad")
        return f"QuadMesh: {vertices}, {quads}, {size_text(self.vertices)}"

    def moved(self, vertices: ArrayLike) -> QuadMesh:
        """Return the same quads, split along the same diagonals, on other vertices (v, 3), mm.

        Raises
        ------
        MeshError
            If there are not as many vertices as before, or one is not finite.
        """
        points = as_points(vertices, "vertices", MeshError)
        if len(points) != len(self.vertices):
            raise MeshError(f"{len(points)} vertices given; need {len(self.vertices)}")
        mesh = object.__new__(QuadMesh)
        mesh._keep(vertices=points, quads=self.quads)
        mesh.__dict__["fans"] = self.fans
        return mesh

    @cached_property
    def half_edges(self) -> Edges:
        """Start and end vertex of each quad's four sides in turn, shape (4 f, 2)."""
        pairs = np.stack([self.quads, np.roll(self.quads, -1, axis=1)], axis=2)
        return pairs.reshape(-1, 2)

    @cached_property
    def _undirected(self) -> tuple[Edges, Ints]:
        low, high = np.sort(self.half_edges, axis=1).T
        keys, edge_of_half_edge = np.unique(low * len(self.vertices) + high, return_inverse=True)
        edges = np.stack(np.divmod(keys, max(len(self.vertices), 1)), axis=1)
        return edges, edge_of_half_edge

    @property
    def edges(self) -> Edges:
        """Vertex pairs, each edge once, lower index first, in ascending order, shape (e, 2)."""
        return self._undirected[0]

    @property
    def edge_of_half_edge(self) -> Ints:
        """Row of `edges` of each of `half_edges`, shape (4 f,)."""
        return self._undirected[1]

    @property
    def euler_characteristic(self) -> int:
        """Vertices used by a quad − edges + quads: 2 − 2 genus, summed over closed components."""
        return len(np.unique(self.quads)) - len(self.edges) + len(self.quads)

    @cached_property
    def triangles(self) -> Triangles:
        """Two triangles per quad, shape (2 f, 3), split along its shorter diagonal.

        Where only the other diagonal gives two triangles that are not folded onto each other, as
        in a quad with a corner that points inwards, that one is taken. At a tie it is the first:
        the same mesh always gives the same triangles.
        """
        return self.fans[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)

    @cached_property
    def fans(self) -> Quads:
        """The quads, each from a corner of the diagonal that `triangles` splits it along, (f, 4).

        A reader that cuts each face of a file into a fan from its first corner, as most do, has
        the same triangles.
        """
        a, b, c, d = (self.vertices[self.quads[:, k]] for k in range(4))
        along, across = c - a, d - b
        shorter = dot(along, along) <= dot(across, across) * (1 + 1e-9)
        flat_along = dot(np.cross(b - a, along), np.cross(along, d - a)) >= 0
        flat_across = dot(np.cross(c - b, across), np.cross(across, a - b)) >= 0
        first = np.where(flat_along == flat_across, shorter, flat_along)
        return np.where(first[:, None], self.quads, np.roll(self.quads, 1, axis=1))

    @property
    def signed_volume(self) -> float:
        """Volume inside the bilinear quads, mm³: > 0 for a closed mesh with outward quads.

        A bilinear patch has exactly the mean of the volumes of its two triangulations.
        """
        origin = self.vertices.mean(axis=0) if len(self.vertices) else np.zeros(3)
        a, b, c, d = (self.vertices[self.quads[:, k]] - origin for k in range(4))
        return float(_patch_volumes(a, b, c, d).sum())

    def check_closed(self) -> None:
        """Raise unless every edge is shared by two quads that run along it in opposite directions.

        Raises
        ------
        MeshError
            If the mesh is empty, or an edge is open, shared by more than two quads, or run along
            twice in the same direction; the edge is named.
        """
        if len(self.quads) == 0:
            raise MeshError("the mesh has no quads; need at least 6 for a closed surface")
        uses = np.bincount(self.edge_of_half_edge, minlength=len(self.edges))
        self._refuse(uses == 1, "belongs to one quad only; need two (the mesh is open)")
        self._refuse(uses > 2, "belongs to more than two quads; need two")
        forward = self.half_edges[:, 0] < self.half_edges[:, 1]
        ahead = np.bincount(self.edge_of_half_edge[forward], minlength=len(self.edges))
        self._refuse(ahead != 1, "is run along twice in the same direction; need one quad each way")

    def _refuse(self, bad: Bools, why: str) -> None:
        """Raise for the first edge that is marked in `bad` (e,)."""
        found = np.flatnonzero(bad)
        if len(found):
            a, b = self.edges[found[0]].tolist()
            raise MeshError(f"the edge between vertices {a} and {b} {why}")


def _patch_volumes(a: Points, b: Points, c: Points, d: Points) -> Floats:
    """Return the signed volume between the origin and each bilinear patch (f,)."""

    def cone(p: Points, q: Points, r: Points) -> Floats:
        return dot(np.cross(p, q), r)

    return (cone(a, b, c) + cone(a, c, d) + cone(a, b, d) + cone(b, c, d)) / 12.0
