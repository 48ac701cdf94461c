"""Closed surfaces moved inwards, for walls of even thickness."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.vectors import angle_between, dot, normalize, sums_by_row
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh

FLAT = 1e-5
"""Least eigenvalue, relative to the largest, at which the planes at a vertex fix a direction."""

THINNEST, THICKEST = 0.98, 1.2
"""Least and most wall at a triangle, as fractions of the thickness asked for."""


def inset(mesh: TriangleMesh, thickness: float) -> TriangleMesh | None:
    """Return a closed surface inside `mesh` that leaves a wall, or None if none was found.

    Each vertex goes to where the planes of its triangles meet when moved inwards, so that flat
    faces stay flat and their wall is exact. That fails where the surface is more tightly curved
    than the wall is thick, or the body too thin for it.

    Parameters
    ----------
    mesh : closed, counter-clockwise seen from outside
    thickness : of the wall, mm
    """
    corners = mesh.vertices[mesh.triangles]
    normals = normalize(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    steps = _steps(mesh, corners, normals)
    wall = -dot(steps[mesh.triangles], np.broadcast_to(normals[:, None], corners.shape))
    wall = wall[normals.any(axis=1)]  # (t, 3), of thickness 1, where a triangle has area
    if wall.min(initial=1.0) < THINNEST or wall.max(initial=1.0) > THICKEST:
        return None
    inner = TriangleMesh(mesh.vertices + thickness * steps, mesh.triangles)
    both = TriangleMesh(
        np.concatenate([mesh.vertices, inner.vertices]),
        np.concatenate([mesh.triangles, inner.triangles[:, ::-1] + len(mesh.vertices)]),
    )
    # A surface turned inside out by the move has a volume of its own sign, or crosses the other.
    whole = inner.signed_volume > 0 and len(self_intersections(both, limit=1)) == 0
    return inner if whole else None


def _steps(mesh: TriangleMesh, corners: Points, normals: Floats) -> Floats:
    """Return how each vertex moves for a wall of thickness 1, shape (v, 3)."""
    ahead = normalize(np.roll(corners, -1, axis=1) - corners)
    angles = np.pi - angle_between(ahead, np.roll(ahead, 1, axis=1))  # (t, 3), at each corner
    planes = normals[:, None, :, None] * normals[:, None, None, :]  # (t, 1, 3, 3)
    count = len(mesh.vertices)
    matrices = sums_by_row(angles[:, :, None, None] * planes, mesh.triangles, count)
    sums = sums_by_row(angles[:, :, None] * normals[:, None], mesh.triangles, count)
    inverses = np.linalg.pinv(matrices, rcond=FLAT, hermitian=True)
    steps: Floats = -np.einsum("vij,vj->vi", inverses, sums)
    return steps
