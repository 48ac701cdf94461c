"""Quad and triangle meshes: surfaces, their shells, and whether they cross themselves."""

from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh

__all__ = ["QuadMesh", "TriangleMesh", "self_intersections"]
