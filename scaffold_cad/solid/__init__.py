"""Watertight solids by manifold3d: unions of what overlaps, and frames."""

from scaffold_cad.solid.solid import Solidified, clean_surface, solidified, to_solid

__all__ = ["Solidified", "clean_surface", "solidified", "to_solid"]
