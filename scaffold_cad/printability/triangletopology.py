"""How the triangles of any mesh hang together, closed or not, manifold or not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.topology import component_labels, edges_of_sides, sides_of
from scaffold_cad.base.vectors import length
from scaffold_cad.mesh.trianglemesh import TriangleMesh, cone_volumes

SINGLE_STEP = 2.0**-22
"""Largest error of a height by the rounding of 32-bit coordinates, parts of the largest of them."""


@dataclass(frozen=True, eq=False)
class TriangleTopology:
    """The sides of the triangles of a mesh, its shells, and what is wrong with them."""

    mesh: TriangleMesh

    @cached_property
    def corners(self) -> Floats:
        """Positions of the corners of each triangle, shape (t, 3, 3), mm."""
        return self.mesh.vertices[self.mesh.triangles]

    @cached_property
    def repeats_corner(self) -> Bools:
        """Whether a triangle has the same vertex twice, shape (t,)."""
        a, b, c = self.mesh.triangles.T
        repeats: Bools = (a == b) | (b == c) | (c == a)
        return repeats

    @cached_property
    def flat(self) -> Ints:
        """Triangles without area, or so flat that mesh files of 32-bit coordinates lose it."""
        sides = np.roll(self.corners, -1, axis=1) - self.corners
        longest = length(sides).max(axis=1)
        doubled = length(np.cross(sides[:, 0], sides[:, 1]))
        height = SINGLE_STEP * np.abs(self.mesh.vertices).max()
        return np.flatnonzero(self.repeats_corner | (doubled <= height * longest))

    @cached_property
    def triangles(self) -> Ints:
        """Triangles with three vertices: the others have no sides to speak of, shape (s,)."""
        return np.flatnonzero(~self.repeats_corner)

    @cached_property
    def sides(self) -> Edges:
        """Directed sides, three per triangle of `triangles`, shape (3 s, 2)."""
        return sides_of(self.mesh.triangles[self.triangles])

    @cached_property
    def _edge_of_side(self) -> tuple[Edges, Ints, Ints]:
        edges, edge_of_side = edges_of_sides(self.sides)
        return edges, edge_of_side, np.bincount(edge_of_side, minlength=len(edges))

    @property
    def edges(self) -> Edges:
        """Vertex pairs, shape (e, 2)."""
        return self._edge_of_side[0]

    @property
    def edge_of_side(self) -> Ints:
        """Edge that each side runs along, shape (3 s,)."""
        return self._edge_of_side[1]

    @property
    def share_count(self) -> Ints:
        """Number of triangles at each edge, shape (e,)."""
        return self._edge_of_side[2]

    @cached_property
    def _pairs(self) -> Edges:
        """The two sides at each edge that has two, shape (p, 2)."""
        order = np.argsort(self.edge_of_side, kind="stable")
        both = order[self.share_count[self.edge_of_side[order]] == 2]
        pairs: Edges = both.reshape(-1, 2)
        return pairs

    @cached_property
    def open_edges(self) -> Ints:
        """Edges of one triangle."""
        return np.flatnonzero(self.share_count == 1)

    @cached_property
    def crowded_edges(self) -> Ints:
        """Edges of three triangles or more."""
        return np.flatnonzero(self.share_count > 2)

    @cached_property
    def clashing_edges(self) -> Ints:
        """Edges of two triangles that run along them in the same direction."""
        same = self.sides[self._pairs[:, 0], 0] == self.sides[self._pairs[:, 1], 0]
        clashing: Ints = self.edge_of_side[self._pairs[same, 0]]
        return clashing

    @cached_property
    def hole_count(self) -> int:
        """Number of connected sets of open edges."""
        ends = self.edges[self.open_edges]
        if len(ends) == 0:
            return 0
        used, numbered = np.unique(ends, return_inverse=True)
        return int(component_labels(numbered.reshape(-1, 2), len(used)).max()) + 1

    @cached_property
    def pinched_vertices(self) -> Ints:
        """Vertices where several fans of triangles meet in nothing but that point.

        Ends of open and crowded edges are left out: there the edges say what is wrong.
        """
        rows = self.mesh.triangles[self.triangles].reshape(-1)  # vertex of each corner
        one, other = self._pairs.T  # side k of a triangle starts at its corner k
        after_one, after_other = _next_in_triangle(one), _next_in_triangle(other)
        opposed = rows[one] != rows[other]
        links = np.concatenate(
            [
                np.stack([one, np.where(opposed, after_other, other)], axis=1),
                np.stack([after_one, np.where(opposed, other, after_other)], axis=1),
            ]
        )
        fan = component_labels(links, len(rows))
        _, representative = np.unique(fan, return_index=True)
        fans = np.bincount(rows[representative], minlength=len(self.mesh.vertices))
        fans[self.edges[np.concatenate([self.open_edges, self.crowded_edges])]] = 0
        return np.flatnonzero(fans > 1)

    @cached_property
    def shell_of_triangle(self) -> Ints:
        """Shell of each of `triangles`: they hang together by edges of two, shape (s,)."""
        return component_labels(self._pairs // 3, len(self.triangles))

    @property
    def shell_count(self) -> int:
        """Number of shells."""
        return int(self.shell_of_triangle.max(initial=-1)) + 1

    @cached_property
    def shell_volumes(self) -> Floats:
        """Signed volume of each shell, nan where it is not closed or not of one winding, mm³."""
        rows = self.mesh.triangles[self.triangles]
        volumes: Floats = np.bincount(
            self.shell_of_triangle,
            cone_volumes(self.mesh.vertices, rows),
            minlength=self.shell_count,
        ).astype(np.float64)
        faulty = np.concatenate([self.open_edges, self.crowded_edges, self.clashing_edges])
        at_fault = np.isin(self.edge_of_side, faulty)
        volumes[self.shell_of_triangle[np.flatnonzero(at_fault) // 3]] = np.nan
        return volumes

    @property
    def closed(self) -> bool:
        """Whether every edge has two triangles that run along it in opposite directions."""
        faulty = len(self.open_edges) + len(self.crowded_edges) + len(self.clashing_edges)
        return faulty == 0 and len(self.triangles) > 0

    @property
    def genus(self) -> int:
        """Number of handles of all shells together; of a closed mesh only."""
        used = len(np.unique(self.mesh.triangles[self.triangles]))
        characteristic = used - len(self.edges) + len(self.triangles)
        return self.shell_count - characteristic // 2

    def middles(self, edges: Ints) -> Points:
        """Return the middle of each of `edges`, shape (k, 3), mm."""
        middles: Points = self.mesh.vertices[self.edges[edges]].mean(axis=1)
        return middles


def _next_in_triangle(sides: Ints) -> Ints:
    """Return the side, or the corner, that follows each of `sides` in its triangle."""
    return sides - sides % 3 + (sides + 1) % 3
