"""Watertight triangle solids: the only user of manifold3d, imported when it is needed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Points, UnitVectors
from scaffold_cad.base.backends import need
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.shells import check_solid
from scaffold_cad.mesh.trianglemesh import TriangleMesh

if TYPE_CHECKING:
    from manifold3d import Manifold


def to_manifold(mesh: QuadMesh | TriangleMesh) -> Manifold:
    """Return `mesh` as a manifold3d solid, its coordinates in double precision.

    No boolean is made: where two parts of the mesh cross, they still cross in the solid.

    Raises
    ------
    MeshError
        If the mesh is not closed, not outward, or manifold3d refuses it; the reason is named.
    OptionError
        If it is not a mesh.
    MissingBackendError
        If manifold3d is not installed.
    """
    check_kind(mesh, QuadMesh, TriangleMesh)
    if isinstance(mesh, QuadMesh):
        check_solid(mesh)
    else:
        mesh.check_closed()
        if not mesh.signed_volume > 0:
            raise MeshError(
                f"the triangles have a volume of {mesh.signed_volume:g} mm³; need > 0 "
                "(are they clockwise seen from outside?)"
            )
    need("manifold3d", "a manifold3d solid")
    solid = of_closed(mesh)
    if not solid.volume() > 0:
        raise MeshError(
            f"the solid has a volume of {solid.volume():g} mm³; need > 0 "
            "(is it too small for its distance from the origin?)"
        )
    return solid


def of_closed(mesh: QuadMesh | TriangleMesh) -> Manifold:
    """Return a mesh that is known to be closed as a solid."""
    import manifold3d

    # Copies: manifold3d takes no read-only arrays.
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(mesh.vertices.copy(), mesh.triangles.astype(np.uint64, order="C"))
    )
    if solid.status() != manifold3d.Error.NoError:
        raise MeshError(f"manifold3d refuses the mesh: {solid.status().name}; need NoError")
    return solid


def manifold_triangles(manifold: Manifold) -> TriangleMesh:
    """Return the triangles of a manifold3d solid, its coordinates in double precision.

    Raises
    ------
    MeshError
        If the solid holds an error instead of a shape; it is named.
    """
    if manifold.status().name != "NoError":
        raise MeshError(f"the manifold3d solid holds the error {manifold.status().name}")
    mesh = manifold.to_mesh64()
    # Where triangles differ in other properties manifold3d has several vertices at a place.
    same = np.arange(len(mesh.vert_properties))
    same[mesh.merge_from_vert] = mesh.merge_to_vert
    return TriangleMesh(mesh.vert_properties[:, :3], same[mesh.tri_verts.astype(np.intp)])


def union(solids: Sequence[Manifold], hulls: Sequence[Points]) -> Manifold:
    """Return the union of solids and of the convex hulls of point sets (p, 3).

    Raises
    ------
    MissingBackendError
        If manifold3d is not installed.
    """
    need("manifold3d", "a union")
    import manifold3d

    parts = [*solids, *(manifold3d.Manifold.hull_points(points) for points in hulls)]
    return manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)


def ball_corners(segments: int) -> UnitVectors:
    """Return points evenly on the unit sphere, with `segments` on its great circles, (n, 3)."""
    import manifold3d

    return manifold_triangles(manifold3d.Manifold.sphere(1.0, segments)).vertices


def filled_share(manifold: Manifold, corners: Points) -> float:
    """Return the share of the convex hull of points (p, 3) that a solid fills, from 0 to 1."""
    import manifold3d

    hull = manifold3d.Manifold.hull_points(corners)
    return float((manifold ^ hull).volume() / hull.volume())
