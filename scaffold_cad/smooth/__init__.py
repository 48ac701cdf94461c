"""Smooth solids: Catmull-Clark subdivision of the scaffold, and what is made from its limit."""

from scaffold_cad.smooth.accuracy import Deviation, deviation
from scaffold_cad.smooth.control import Caps, ControlMesh, control_mesh
from scaffold_cad.smooth.crossings import crossing_struts
from scaffold_cad.smooth.limits import Limit, limit
from scaffold_cad.smooth.mesh import smooth_mesh
from scaffold_cad.smooth.patches import Patches, smooth_patches
from scaffold_cad.smooth.slabs import FineSurface, fine_surface
from scaffold_cad.smooth.subdivision import Subdivision, catmull_clark

__all__ = [
    "Caps",
    "ControlMesh",
    "Deviation",
    "FineSurface",
    "Limit",
    "Patches",
    "Subdivision",
    "catmull_clark",
    "control_mesh",
    "crossing_struts",
    "deviation",
    "fine_surface",
    "limit",
    "smooth_mesh",
    "smooth_patches",
]
