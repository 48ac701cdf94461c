"""Lattices and foams: graphs of struts, tiled or random, returned as skeletons."""

from scaffold_cad.lattice.density import measured_density, relative_density
from scaffold_cad.lattice.maps import (
    BetweenMap,
    BoxMap,
    CellMap,
    CylinderMap,
    FunctionMap,
    MappedLattice,
    QuadMap,
    SphereMap,
    SurfaceMap,
    lattice_on,
)
from scaffold_cad.lattice.morecells import reentrant_cell, reentrant_honeycomb
from scaffold_cad.lattice.periodic import PeriodicLattice
from scaffold_cad.lattice.registry import cells, register_cell, unit_cell
from scaffold_cad.lattice.tiling import mapped, tile
from scaffold_cad.lattice.unitcell import UnitCell, cell_picture, check_periodic

__all__ = [
    "BetweenMap",
    "BoxMap",
    "CellMap",
    "CylinderMap",
    "FunctionMap",
    "MappedLattice",
    "PeriodicLattice",
    "QuadMap",
    "SphereMap",
    "SurfaceMap",
    "UnitCell",
    "cell_picture",
    "cells",
    "check_periodic",
    "lattice_on",
    "mapped",
    "measured_density",
    "reentrant_cell",
    "reentrant_honeycomb",
    "register_cell",
    "relative_density",
    "tile",
    "unit_cell",
]
