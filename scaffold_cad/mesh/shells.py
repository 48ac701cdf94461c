"""The shells of a quad mesh: its connected parts, each of which bounds one solid."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Ints
from scaffold_cad.base.topology import component_labels
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import cone_volumes


def shell_of_quad(mesh: QuadMesh) -> Ints:
    """Return the shell of each quad, shape (f,): quads that share an edge share a shell.

    Shells are numbered from 0 in the order of their first quads.
    """
    order = np.argsort(mesh.edge_of_half_edge, kind="stable")
    same_edge = np.diff(mesh.edge_of_half_edge[order]) == 0
    quad = order // 4
    neighbors = np.stack([quad[:-1][same_edge], quad[1:][same_edge]], axis=1)
    return component_labels(neighbors, len(mesh.quads))


def quads_of_shells(mesh: QuadMesh) -> list[Ints]:
    """Return the quads of each shell, in ascending order."""
    shell = shell_of_quad(mesh)
    return np.split(np.argsort(shell, kind="stable"), np.cumsum(np.bincount(shell))[:-1])


def check_oriented(mesh: QuadMesh) -> None:
    """Raise unless no two quads run along an edge in the same direction; edges may be open.

    Raises
    ------
    MeshError
        If the mesh is empty or two quads do; the edge is named. Three quads at an edge always do.
    """
    if len(mesh.quads) == 0:
        raise MeshError("the mesh has no quads; need at least one")
    keys = np.sort(mesh.half_edges[:, 0] * len(mesh.vertices) + mesh.half_edges[:, 1])
    repeated = keys[1:][keys[1:] == keys[:-1]]
    if len(repeated):
        a, b = divmod(int(repeated[0]), len(mesh.vertices))
        raise MeshError(f"two quads run along the edge from vertex {a} to {b}; need at most one")


def check_solid(mesh: QuadMesh) -> None:
    """Raise unless the mesh bounds solids: closed, and every shell's quads seen from outside.

    Raises
    ------
    MeshError
        If an edge is not shared by two quads, or a shell's volume is not > 0; it is named.
    """
    mesh.check_closed()
    shell = shell_of_quad(mesh)
    volume = np.bincount(np.repeat(shell, 2), cone_volumes(mesh.vertices, mesh.triangles))
    inverted = np.flatnonzero(~(volume > 0))
    if len(inverted):
        quad = int(np.argmax(shell == inverted[0]))
        raise MeshError(
            f"the shell of quad {quad} has a volume of {volume[inverted[0]]:g} mm³; need > 0 "
            "(are its quads clockwise seen from outside?)"
        )
