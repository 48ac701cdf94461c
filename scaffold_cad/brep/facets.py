"""Triangles as plane faces of an analytic B-rep, which share their edges."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints
from scaffold_cad.base.topology import component_labels, edges_of_sides, sides_of
from scaffold_cad.base.vectors import length, normalize
from scaffold_cad.brep.analytic import AnalyticBrep, Axes, BrepEdges, BrepFaces, Surface
from scaffold_cad.errors import BrepError
from scaffold_cad.mesh.trianglemesh import TriangleMesh


def brep_of_triangles(mesh: TriangleMesh, name: Ints, names: Sequence[str]) -> AnalyticBrep:
    """Return a plane face for each triangle, in their order; a shell for each connected surface.

    Its edges are straight, those of the lowest vertices first. Where the mesh has a border edges
    are used once.

    Parameters
    ----------
    name : (t,) place of each face's name among `names`

    Raises
    ------
    BrepError
        If a triangle has no area, and so no plane; it is named.
    """
    triangles, count = mesh.triangles, len(mesh.triangles)
    corners = mesh.vertices[triangles]  # (t, 3, 3)
    sides = np.roll(corners, -1, axis=1) - corners
    normals = normalize(np.cross(sides[:, 0], sides[:, 1]))
    flat = np.flatnonzero(~normals.any(axis=1))
    if len(flat):
        raise BrepError(
            f"triangle {flat[0]} with vertices {triangles[flat[0]].tolist()} has no area; need "
            "some for a plane face"
        )
    # Across the normal: the longest side.
    longest = length(sides.reshape(-1, 3)).reshape(-1, 3).argmax(axis=1)
    along = normalize(sides[np.arange(count), longest])
    start, end = sides_of(triangles).T
    pairs, edge = edges_of_sides(sides_of(triangles))
    labels = component_labels(pairs, len(mesh.vertices))
    _, shell = np.unique(labels[triangles[:, 0]], return_inverse=True)
    shell, nothing = shell.reshape(-1), np.zeros((0, 3))
    return AnalyticBrep(
        mesh.vertices,
        BrepEdges(pairs, Axes(nothing, nothing, nothing), np.zeros(0), np.zeros((0, 2)), ()),
        BrepFaces(
            np.full(count, Surface.PLANE, dtype=np.intp),
            Axes(corners[:, 0], normals, along),
            np.zeros((count, 2)),
            (),
            outward=np.ones(count, dtype=np.bool_),
            loops=np.arange(count + 1),
            uses=3 * np.arange(count + 1),
            edge=edge.reshape(-1),
            forward=start < end,
            parameters=np.full((3 * count, 2, 2), np.nan),
            shell=shell,
            name=name,
        ),
        np.arange(int(shell.max()) + 1),
        tuple(names),
    )


def edges_between(brep: AnalyticBrep, start: Ints, end: Ints) -> tuple[Ints, Bools]:
    """Return the edges between vertices of triangles, and whether they run from start to end."""
    count = len(brep.vertices)
    keys = brep.edges.ends[:, 0] * count + brep.edges.ends[:, 1]
    wanted = np.minimum(start, end) * count + np.maximum(start, end)
    return np.searchsorted(keys, wanted), start < end
