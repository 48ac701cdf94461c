"""Meshes whose triangles share vertices where these are at the very same position."""

from __future__ import annotations

from scaffold_cad.base.positions import equal_positions
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.trianglemesh import TriangleMesh, have_distinct_corners


def welded(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh with vertices at the very same position made one.

    Files such as STL give each triangle its own corners. A mesh that is closed as it is stays so:
    parts of it may touch along equal vertices.
    """
    try:
        mesh.check_closed()
    except MeshError:
        place, first = equal_positions(mesh.vertices)
        return TriangleMesh(mesh.vertices[first], place[mesh.triangles])
    return mesh


def without_repeated_corners(mesh: TriangleMesh) -> TriangleMesh:
    """Return the mesh without the triangles that have a vertex twice, as welding leaves some."""
    rows = mesh.triangles
    proper = have_distinct_corners(rows)
    return mesh if proper.all() else TriangleMesh(mesh.vertices, rows[proper])
