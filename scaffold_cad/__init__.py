"""Solid lattice frames and organic solids from skeletons, for build123d.

>>> from scaffold_cad import Skeleton, build_scaffold
>>> tripod = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
>>> len(build_scaffold(tripod).mesh.quads)
15
"""

from scaffold_cad import webpage  # noqa: F401  (it registers what notebooks show)
from scaffold_cad.base.fields import Field, PointField
from scaffold_cad.convolution import ConvolutionField, project
from scaffold_cad.filling import (
    between_faces,
    delaunay_foam,
    face_map,
    fill,
    lattice_part,
    mesh_map,
    voronoi_foam,
)
from scaffold_cad.io import read_skeleton
from scaffold_cad.io.write import write
from scaffold_cad.lattice import (
    BoxMap,
    CellMap,
    CylinderMap,
    FunctionMap,
    MappedLattice,
    QuadMap,
    SphereMap,
    UnitCell,
    cells,
    lattice_on,
    mapped,
    register_cell,
    relative_density,
    solve_radius,
    tile,
)
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.partition import Partition, partition_sphere, partition_spheres
from scaffold_cad.printability import Report, assert_printable, check_printability
from scaffold_cad.products.breps import to_brep
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.embedding import Embedding
from scaffold_cad.scaffold.frames import rotation_minimizing_frames
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.skeleton.beams import BeamLattice
from scaffold_cad.smooth import (
    Deviation,
    FineSurface,
    Patches,
    Subdivision,
    catmull_clark,
    deviation,
    fine_surface,
    smooth_mesh,
    smooth_patches,
)
from scaffold_cad.solid import Solidified, solidified, to_solid
from scaffold_cad.solid.manifolds import to_trimesh
from scaffold_cad.solid.thicken import frame_scaffold, thicken
from scaffold_cad.viewers import show

__all__ = [
    "BeamLattice",
    "BoxMap",
    "CellMap",
    "ConvolutionField",
    "CylinderMap",
    "Deviation",
    "Embedding",
    "Field",
    "FineSurface",
    "FunctionMap",
    "MappedLattice",
    "Partition",
    "Patches",
    "PointField",
    "QuadMap",
    "QuadMesh",
    "Report",
    "Scaffold",
    "Skeleton",
    "Solidified",
    "SphereMap",
    "Subdivision",
    "TriangleMesh",
    "UnitCell",
    "assert_printable",
    "between_faces",
    "build_scaffold",
    "catmull_clark",
    "cells",
    "check_printability",
    "check_skeleton",
    "delaunay_foam",
    "deviation",
    "face_map",
    "fill",
    "fine_surface",
    "frame_scaffold",
    "lattice_on",
    "lattice_part",
    "mapped",
    "mesh_map",
    "partition_sphere",
    "partition_spheres",
    "project",
    "read_skeleton",
    "register_cell",
    "relative_density",
    "rotation_minimizing_frames",
    "self_intersections",
    "show",
    "smooth_mesh",
    "smooth_patches",
    "solidified",
    "solve_radius",
    "thicken",
    "tile",
    "to_brep",
    "to_solid",
    "to_trimesh",
    "voronoi_foam",
    "write",
]

__version__ = "0.1.0"
