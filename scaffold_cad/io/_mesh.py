"""Meshes by their edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Ints, Points
from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.ranges import steps
from scaffold_cad.errors import SkeletonError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.mesh.trianglemesh import TriangleMesh

FLAT = 1e-3
"""Angle, rad, below which two triangles are one face that was cut: STL rounds to 32 bits."""


@dataclass(frozen=True, eq=False)
class Faces:
    """Polygons of any number of corners."""

    corners: Ints
    """Vertices of one face after the other, shape (k,)."""
    sizes: Ints
    """Number of corners of each face, shape (f,), all ≥ 3."""


def skeleton_of_mesh(points: Points, faces: Faces) -> RawSkeleton:
    """Return the edges of a mesh, without radii, lengths taken as mm.

    Corners at equal positions are one node. An edge between two triangles in a plane is left
    out: it is a diagonal of a face that was cut in triangles. So a flat plate that was meshed
    finely has only its border; a curved surface, and one of larger polygons, keeps all edges.

    Raises
    ------
    SkeletonError
        If a face has a corner that isn't there, or a coordinate is absurd.
    """
    bad = np.flatnonzero((faces.corners < 0) | (faces.corners >= len(points)))
    if len(bad):
        found = f"a face has vertex {faces.corners[bad[0]]}"
        raise SkeletonError(f"{found}; need 0 to {len(points) - 1}")
    # Checked before anything is computed from the points.
    RawSkeleton(points, np.zeros((0, 2), dtype=np.intp))
    node, first = equal_positions(points)
    places, corners = points[first], node[faces.corners]
    start = np.cumsum(faces.sizes) - faces.sizes
    following = np.arange(1, len(corners) + 1)
    following[start + faces.sizes - 1] = start
    sides = np.sort(np.stack([corners, corners[following]], axis=1), axis=1)
    face = np.repeat(np.arange(len(start)), faces.sizes)
    edges, edge, uses = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = face[np.argsort(edge.reshape(-1), kind="stable")]  # faces, edge by edge
    at = np.cumsum(uses) - uses
    pairs = np.stack([order[at], order[at + np.minimum(uses, 2) - 1]], axis=1)
    diagonal = (uses == 2) & _are_one_face(places, corners, start, faces.sizes, pairs)
    return RawSkeleton(places, edges[~diagonal])


def triangulated(points: Points, faces: Faces) -> TriangleMesh:
    """Return polygons as fans of triangles around their first corners, every vertex kept.

    Raises
    ------
    MeshError
        If a face has a corner that isn't there, or a coordinate is not finite.
    """
    start = np.cumsum(faces.sizes) - faces.sizes
    fans = faces.sizes - 2
    first = np.repeat(start, fans)  # (t,), where the polygon of each triangle begins
    step = steps(fans)
    corners = np.stack([first, first + step + 1, first + step + 2], axis=1)
    return TriangleMesh(points, faces.corners[corners])


def joined_meshes(meshes: Sequence[TriangleMesh]) -> TriangleMesh:
    """Return the triangles of all meshes, one after the other."""
    if not meshes:
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp))
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + n for mesh, n in zip(meshes, first[:-1], strict=True)]),
    )


def _are_one_face(points: Points, corners: Ints, start: Ints, sizes: Ints, pairs: Edges) -> Bools:
    """Return which pairs (k, 2) of faces are triangles in a plane, neither without area."""
    a, b, c = (points[corners[start + k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    area = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(area > 0, area, 1.0)[:, None]
    bend = np.linalg.norm(normals[pairs[:, 0]] - normals[pairs[:, 1]], axis=1)
    plain = (sizes == 3) & (area > 0)
    flat: Bools = plain[pairs].all(axis=1) & (bend < FLAT)
    return flat
