"""Where a triangle mesh meets itself: exact, and without any knowledge of how it was made.

Such knowledge makes it faster: which parts of the mesh should be star-shaped.
"""

from scaffold_cad.mesh.intersections.bodies import intersections_of_bodies
from scaffold_cad.mesh.intersections.search import Triangulated, self_intersections

__all__ = ["Triangulated", "intersections_of_bodies", "self_intersections"]
