"""What a thing becomes: a B-rep, a mesh, a shape to show."""

from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.meshshapes import to_mesh_shape
from scaffold_cad.products.surfaces import to_trimesh

__all__ = ["to_brep", "to_mesh_shape", "to_trimesh"]
