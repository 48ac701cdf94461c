"""show(): skeletons, scaffolds and solids in the viewer that is at hand."""

from scaffold_cad.viewers.cadquery import to_cadquery
from scaffold_cad.viewers.hosts import show
from scaffold_cad.viewers.shapes import to_shape

__all__ = ["show", "to_cadquery", "to_shape"]
