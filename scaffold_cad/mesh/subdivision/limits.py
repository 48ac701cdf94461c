"""The limit surface of Catmull-Clark subdivision: points of it and its tangent planes.

References
----------
Halstead, Kass, DeRose, Efficient, fair interpolation using Catmull-Clark surfaces, SIGGRAPH 1993.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Floats, Frozen, Points, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision.connectivity import NO_CREASES, Connectivity


@dataclass(frozen=True, eq=False)
class Limit(Frozen):
    """Where the vertices of a mesh lie on its Catmull-Clark limit surface."""

    points: Points
    """Limit position of each vertex, shape (v, 3), mm."""
    normals: UnitVectors
    """Outward normal of the limit surface there, shape (v, 3); at a vertex on a crease the mean
    of the normals of its quads."""


def limit(mesh: QuadMesh, creases: ArrayLike = NO_CREASES) -> Limit:
    """Return where the vertices of `mesh` lie on its Catmull-Clark limit surface.

    Parameters
    ----------
    mesh : closed
    creases : (k, 2) intp, vertex pairs of edges that stay sharp

    Raises
    ------
    MeshError
        If the mesh is not closed, or a crease is not an edge of it.
    OptionError
        If `mesh` is not a QuadMesh.
    """
    check_kind(mesh, QuadMesh)
    connectivity = Connectivity.of(mesh, creases)
    first, second = limit_tangents(connectivity, mesh.vertices)
    normals = np.cross(first, second)
    creased = connectivity.crease_valence > 1
    if creased.any():
        normals[creased] = sum_of_normals(connectivity, mesh.vertices)[creased]
    return Limit(limit_points(connectivity, mesh.vertices), normalize(normals))


def limit_points(connectivity: Connectivity, points: Points) -> Points:
    """Return the limit positions of the vertices, (v, 3)."""
    edges = connectivity.edges
    ends = points.take(edges[:, 0], axis=0) + points.take(edges[:, 1], axis=0)  # (e, 3)
    valence = np.maximum(connectivity.valence, 1)[:, None]
    around = 2 * connectivity.sum_at_vertices(edges, ends)
    around += connectivity.sum_at_vertices(connectivity.quads, connectivity.sum_of_corners(points))
    limits: Points = ((valence - 3) * points + around / valence) / (valence + 5)
    if connectivity.is_crease.any():
        creases = connectivity.crease_valence[:, None]
        along = (4 * points + connectivity.sum_of_crease_neighbors(points)) / 6
        limits = np.where(creases == 2, along, limits)
        limits = np.where(creases > 2, points, limits)
    return limits


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
