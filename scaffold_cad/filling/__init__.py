"""Bodies filled with struts: cells, foams, or any skeleton."""

from scaffold_cad.filling.cutting import cut, snapped
from scaffold_cad.filling.densities import graded_radius, solve_radius
from scaffold_cad.filling.fill import fill
from scaffold_cad.filling.foams import delaunay_foam, voronoi_foam
from scaffold_cad.filling.maps import between_faces, face_map, mesh_map
from scaffold_cad.filling.parts import lattice_part, strut_part
from scaffold_cad.filling.solids import lattice_solid, strut_solid

__all__ = [
    "between_faces",
    "cut",
    "delaunay_foam",
    "face_map",
    "fill",
    "graded_radius",
    "lattice_part",
    "lattice_solid",
    "mesh_map",
    "snapped",
    "solve_radius",
    "strut_part",
    "strut_solid",
    "voronoi_foam",
]
