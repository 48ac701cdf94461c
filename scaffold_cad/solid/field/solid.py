"""Field solids: the zero set of a filleted union of struts as a watertight triangle mesh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field.cells import levels_of
from scaffold_cad.solid.field.grid import grid_of
from scaffold_cad.solid.field.lattice import lattice_over
from scaffold_cad.solid.field.struts import FieldStruts
from scaffold_cad.solid.field.surface import surface_of
from scaffold_cad.solid.field.union import filleted_union

DEFAULT_FRACTION = 0.4


@dataclass(frozen=True, eq=False)
class FieldSolid(Frozen):
    mesh: TriangleMesh
    cell: float


def field_solid(struts: FieldStruts, *, fraction=DEFAULT_FRACTION, size=None, rounds=1) -> FieldSolid:
    least = fraction * struts.radii.min()
    low, high = struts.box()
    lattice = lattice_over(low, high, least)
    union = filleted_union(struts, lattice.origin, 0.0)
    wanted = lambda radii, numbers: fraction * radii
    levels = levels_of(union, lattice, wanted)
    grid = grid_of(union, lattice, levels)
    vertices, triangles = surface_of(union, grid, rounds)
    return FieldSolid(TriangleMesh(vertices + lattice.origin, triangles), lattice.cell)
