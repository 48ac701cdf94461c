"""TriangleMesh: the plain exchange type for everything that is written as triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Points,
    Triangles,
    as_points,
    as_triangles,
    read_only,
)
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.summaries import counted, size_text
from scaffold_cad.base.vectors import triple
from scaffold_cad.errors import MeshError


@checks_keywords()
@dataclass(frozen=True, eq=False)
class TriangleMesh(Frozen, Shown):
    """A mesh of triangles, each counter-clockwise seen from outside.

    Examples
    --------
    >>> from scaffold_cad import TriangleMesh
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> print(TriangleMesh(corner, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    TriangleMesh: 4 vertices, 4 triangles, 1 x 1 x 1 mm
    """

    vertices: Points
    """Vertex positions, shape (v, 3), mm."""
    triangles: Triangles
    """Vertex indices of each triangle, shape (t, 3)."""

    def __init__(self, vertices: ArrayLike, triangles: ArrayLike) -> None:
        points = as_points(vertices, "vertices", MeshError)
        corners = as_triangles(triangles, "triangles", count=len(points))
        self._keep(vertices=points, triangles=corners)

    def __str__(self) -> str:
        vertices = counted(len(self.vertices), "vertex", "vertices")
        triangles = counted(len(self.triangles), "triangle")
        return f"TriangleMesh: {vertices}, {triangles}, {size_text(self.vertices)}"

    @property
    def signed_volume(self) -> float:
        """Volume inside the triangles, mm³: > 0 for a closed mesh with outward triangles."""
        return float(cone_volumes(self.vertices, self.triangles).sum())

    def single_precision(self) -> TriangleMesh:
        """Return the mesh as formats with 32-bit coordinates hold it, with nothing degenerate.

        Where rounding makes the corners of a triangle coincide, vertices at one place become one
        and the triangles without three corners go.
        """
        rounded = self.vertices.astype(np.float32)
        if not _any_coincide(rounded, self.triangles):
            return TriangleMesh(read_only(rounded.astype(np.float64)), self.triangles)
        places, place = np.unique(rounded + np.float32(0), axis=0, return_inverse=True)
        triangles = place.reshape(-1)[self.triangles]
        proper = triangles[have_distinct_corners(triangles)]
        return TriangleMesh(places.astype(np.float64), proper)

    def check_closed(self) -> None:
        """Raise unless each triangle side is met by one other that runs the opposite way.

        Raises
        ------
        MeshError
            If the mesh is empty, or a side has no partner or more than one; the side is named.
        """
        if len(self.triangles) == 0:
            raise MeshError("the mesh has no triangles; need at least 4 for a closed surface")
        repeated, lonely = self.faulty_sides()
        for a, b in repeated[:1].tolist():
            raise MeshError(f"two triangles run along the edge from vertex {a} to {b}; need one")
        for a, b in lonely[:1].tolist():
            raise MeshError(f"no triangle runs along the edge from vertex {b} to {a}; need one")

    def faulty_sides(self) -> tuple[Edges, Edges]:
        """Return sides of triangles, from vertex to vertex, that no closed surface has.

        Returns
        -------
        (k, 2) intp, those that several triangles have; (k, 2) intp, those that no other triangle
        runs back along
        """
        count = max(len(self.vertices), 1)
        start, end = self.triangles, np.roll(self.triangles, -1, axis=1)
        ahead = np.sort((start * count + end).reshape(-1))
        back = np.sort((end * count + start).reshape(-1))
        repeated = np.unique(ahead[1:][ahead[1:] == ahead[:-1]])
        if np.array_equal(ahead, back):  # as most are
            lonely = ahead[:0]
        else:
            lonely = np.setdiff1d(ahead, back, assume_unique=len(repeated) == 0)
        return np.stack(np.divmod(repeated, count), 1), np.stack(np.divmod(lonely, count), 1)


def have_distinct_corners(triangles: Triangles) -> Bools:
    """Return whether the corners of each triangle are three vertices, shape (t,).

    >>> have_distinct_corners(np.array([[0, 1, 2], [3, 3, 4]])).tolist()
    [True, False]
    """
    distinct: Bools = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return distinct


def _any_coincide(places: NDArray[np.float32], triangles: Triangles) -> bool:
    """Return whether corners of one triangle are at the same of some places (v, 3)."""
    x = np.ascontiguousarray(places[:, 0])[triangles]  # (t, 3)
    a, b, c = x.T
    alike = triangles[(a == b) | (b == c) | (c == a)]  # few are
    corners = places[alike]  # (k, 3, 3)
    return bool((corners == np.roll(corners, 1, axis=1)).all(axis=2).any())


def compacted(vertices: Points, triangles: Triangles) -> TriangleMesh:
    """Return the triangles with only the vertices that they use."""
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[triangles] = True
    rank = np.cumsum(used) - 1
    return TriangleMesh(read_only(vertices[used]), read_only(rank[triangles]))


def cone_volumes(vertices: Points, triangles: Triangles) -> Floats:
    """Return the signed volume between each triangle and the vertices' mean, shape (t,), mm³."""
    if len(vertices) == 0:
        return np.zeros(0)
    corners = (vertices - vertices.mean(axis=0))[triangles]  # (t, 3, 3)
    return triple(corners[:, 0], corners[:, 1], corners[:, 2]) / 6.0
