"""Field solids: filleted unions of struts as watertight meshes, whatever overlaps."""

from scaffold_cad.solid.field.nets import skeleton_struts
from scaffold_cad.solid.field.solid import FieldSolid, field_solid
from scaffold_cad.solid.field.struts import FieldStruts, field_struts

__all__ = ["FieldSolid", "FieldStruts", "field_solid", "field_struts", "skeleton_struts"]
