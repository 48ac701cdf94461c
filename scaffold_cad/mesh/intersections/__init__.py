"""Where a triangle mesh meets itself: exact, and without any knowledge of how it was made."""

from scaffold_cad.mesh.intersections.search import Triangulated, self_intersections

__all__ = ["Triangulated", "self_intersections"]
