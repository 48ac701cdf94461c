"""Meshes whose triangles share vertices where these are at the very same position."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.topology import sides_of
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


def with_fans_apart(mesh: TriangleMesh) -> TriangleMesh:
    """Return a closed mesh with a vertex of its own for each fan of triangles around a point.

    Where sheets touch at a vertex, as after welding, that gives them one each, at one place.
    """
    rows = mesh.triangles
    corner = np.arange(rows.size)
    start, end = sides_of(rows).T
    following = np.roll(corner.reshape(-1, 3), -1, axis=1).reshape(-1)
    order = np.lexsort((end, start))
    back = np.empty_like(order)  # the side of the neighbor that runs the other way
    back[np.lexsort((start, end))] = order
    links = np.concatenate([corner, following]), np.concatenate([following[back], back])
    graph = coo_array((np.ones(2 * rows.size, dtype=np.int8), links), shape=(rows.size, rows.size))
    count, fan = connected_components(graph, directed=False)
    if count == len(np.unique(start)):
        return mesh
    vertices = np.empty((count, 3))
    vertices[fan] = mesh.vertices[start]
    return TriangleMesh(vertices, fan.reshape(-1, 3))
