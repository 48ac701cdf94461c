"""Smooth surfaces of quad meshes: one Bézier patch per quad, all joins with one tangent plane."""

from scaffold_cad.brep.g1.patches import Patches, smooth_patches

__all__ = ["Patches", "smooth_patches"]
