"""Layers without a mesh: sections of struts at heights, from the lowest up."""

from scaffold_cad.layers.layer import Layer, Layers
from scaffold_cad.layers.slicing import slices

__all__ = ["Layer", "Layers", "slices"]
