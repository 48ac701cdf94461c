"""Catmull-Clark subdivision of closed quad meshes, with creases.

References
----------
Catmull, Clark, Recursively generated B-spline surfaces, Computer-Aided Design 10(6), 1978.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_count, check_kind, checks_keywords
from scaffold_cad.base.arrays import Edges, Frozen, Ints, Points
from scaffold_cad.base.summaries import counted
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision.connectivity import NO_CREASES, Connectivity


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Subdivision(Frozen):
    """A subdivided mesh, and where its quads come from."""

    mesh: QuadMesh
    """The subdivided mesh: the vertices of the mesh before come first, then one per edge and one
    a quad."""
    creases: Edges
    """Vertex pairs across which it stays sharp, shape (k, 2)."""
    quad_of_quad: Ints
    """Quad of the mesh before that each quad is a part of, shape (f,)."""

    def __str__(self) -> str:
        return f"Subdivision: {self.mesh}, {counted(len(self.creases), 'crease')}"


@checks_keywords()
def catmull_clark(mesh: QuadMesh, levels: int = 1, creases: ArrayLike = NO_CREASES) -> Subdivision:
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
        If the mesh is not closed, or a crease is not an edge of it.
    OptionError
        If `mesh` is not a QuadMesh, or `levels` is not a whole number ≥ 0.
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
    middles = connectivity.sum_of_corners(points) / 4  # (f, 3)
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
        along = (6 * points + connectivity.sum_of_crease_neighbors(points)) / 8
        at_vertices = np.where(creases == 2, along, at_vertices)
        at_vertices = np.where(creases > 2, points, at_vertices)
    return np.concatenate([at_vertices, at_edges, middles])
