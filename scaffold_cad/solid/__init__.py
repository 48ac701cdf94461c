"""Watertight solids by manifold3d: unions of what overlaps, and frames."""

from scaffold_cad.solid.cleaning import clean_surface
from scaffold_cad.solid.solid import Solidified, solidified, to_solid
from scaffold_cad.solid.thicken import frame_scaffold, frame_skeleton, thicken

__all__ = [
    "Solidified",
    "clean_surface",
    "frame_scaffold",
    "frame_skeleton",
    "solidified",
    "thicken",
    "to_solid",
]
