"""Catmull-Clark subdivision of quad meshes, with creases, and its limit surface."""

from scaffold_cad.mesh.subdivision.limits import Limit, limit
from scaffold_cad.mesh.subdivision.refining import Subdivision, catmull_clark

__all__ = ["Limit", "Subdivision", "catmull_clark", "limit"]
