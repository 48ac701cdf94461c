"""Maps: where the cells of a lattice go, from unit cubes to places on and between surfaces."""

from scaffold_cad.lattice.maps.cellmap import CellMap
from scaffold_cad.lattice.maps.placing import MappedLattice, lattice_on
from scaffold_cad.lattice.maps.quads import QuadMap
from scaffold_cad.lattice.maps.solids import BoxMap, CylinderMap, FunctionMap, SphereMap
from scaffold_cad.lattice.maps.surfaces import BetweenMap, Surface, SurfaceMap

__all__ = [
    "BetweenMap",
    "BoxMap",
    "CellMap",
    "CylinderMap",
    "FunctionMap",
    "MappedLattice",
    "QuadMap",
    "SphereMap",
    "Surface",
    "SurfaceMap",
    "lattice_on",
]
