"""Solid lattice frames from skeletons, for build123d: round struts, lattices, scaffolds.

>>> from scaffold_cad import Skeleton, build_scaffold
>>> tripod = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
>>> len(build_scaffold(tripod).mesh.quads)
15

`from scaffold_cad import *` takes the names of `__all__`, none of which is one of build123d's, and
loads build123d for the part classes. Further names can be imported one by one: `project` and
`thicken`, whose names build123d has too; `ScaffoldCadError`, the base of all in
`scaffold_cad.errors`; and the names of the parts of the method, documented in their own packages
(`scaffold_cad.partition`, `scaffold_cad.struts`, ...).
"""

from typing import TYPE_CHECKING, Any

from scaffold_cad.base import starting  # noqa: F401  (it ends the command on Ctrl-C: so first)

# isort: split
from scaffold_cad import webpage  # noqa: F401  (it registers what notebooks show)
from scaffold_cad.base.fields import Field as Field
from scaffold_cad.base.fields import PointField
from scaffold_cad.brep.g1 import Patches as Patches
from scaffold_cad.brep.g1 import smooth_patches
from scaffold_cad.convolution import ConvolutionField
from scaffold_cad.convolution import project as project
from scaffold_cad.errors import ScaffoldCadError as ScaffoldCadError
from scaffold_cad.filling import (
    between_faces,
    cut,
    delaunay_foam,
    face_map,
    fill,
    graded_radius,
    lattice_part,
    lattice_solid,
    mesh_map,
    snapped,
    solve_radius,
    strut_part,
    strut_solid,
    voronoi_foam,
)
from scaffold_cad.io import read_skeleton, write_layers
from scaffold_cad.io.write import write
from scaffold_cad.lattice import (
    BoxMap,
    CylinderMap,
    FunctionMap,
    PeriodicLattice,
    QuadMap,
    SphereMap,
    UnitCell,
    cells,
    lattice_on,
    mapped,
    register_cell,
    relative_density,
    tile,
)
from scaffold_cad.lattice import CellMap as CellMap
from scaffold_cad.lattice import MappedLattice as MappedLattice
from scaffold_cad.layers import Layer, slices
from scaffold_cad.mesh import QuadMesh, TriangleMesh
from scaffold_cad.mesh import self_intersections as self_intersections
from scaffold_cad.mesh.subdivision import Subdivision as Subdivision
from scaffold_cad.mesh.subdivision import catmull_clark as catmull_clark
from scaffold_cad.partition import Partition as Partition
from scaffold_cad.partition import partition_sphere as partition_sphere
from scaffold_cad.partition import partition_spheres as partition_spheres
from scaffold_cad.printability import Report, assert_printable, check_printability
from scaffold_cad.products import to_brep, to_trimesh
from scaffold_cad.scaffold import Embedding as Embedding
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold import rotation_minimizing_frames as rotation_minimizing_frames
from scaffold_cad.skeleton import BeamLattice, Skeleton, check_skeleton
from scaffold_cad.skeleton.supporting import self_supporting
from scaffold_cad.solid import Solidified as Solidified
from scaffold_cad.solid import frame_scaffold, solidified, to_solid
from scaffold_cad.solid import thicken as thicken
from scaffold_cad.struts import RoundStruts, round_struts
from scaffold_cad.viewers import show

if TYPE_CHECKING:
    from scaffold_cad.parts import LatticeBox as LatticeBox
    from scaffold_cad.parts import LatticeFill as LatticeFill
    from scaffold_cad.parts import RoundStrutsSolid as RoundStrutsSolid
    from scaffold_cad.parts import ScaffoldSolid as ScaffoldSolid
    from scaffold_cad.parts import StrutFrame as StrutFrame

__all__ = [
    "BeamLattice",
    "BoxMap",
    "ConvolutionField",
    "CylinderMap",
    "FunctionMap",
    "LatticeBox",
    "LatticeFill",
    "Layer",
    "PeriodicLattice",
    "PointField",
    "QuadMap",
    "QuadMesh",
    "Report",
    "RoundStruts",
    "RoundStrutsSolid",
    "Scaffold",
    "ScaffoldSolid",
    "Skeleton",
    "SphereMap",
    "StrutFrame",
    "TriangleMesh",
    "UnitCell",
    "assert_printable",
    "between_faces",
    "build_scaffold",
    "cells",
    "check_printability",
    "check_skeleton",
    "cut",
    "delaunay_foam",
    "face_map",
    "fill",
    "frame_scaffold",
    "graded_radius",
    "lattice_on",
    "lattice_part",
    "lattice_solid",
    "mapped",
    "mesh_map",
    "read_skeleton",
    "register_cell",
    "relative_density",
    "round_struts",
    "self_supporting",
    "show",
    "slices",
    "smooth_patches",
    "snapped",
    "solidified",
    "solve_radius",
    "strut_part",
    "strut_solid",
    "tile",
    "to_brep",
    "to_solid",
    "to_trimesh",
    "voronoi_foam",
    "write",
    "write_layers",
]

__version__ = "0.1.0"

PART_CLASSES = ("LatticeBox", "LatticeFill", "ScaffoldSolid", "RoundStrutsSolid", "StrutFrame")
"""Classes of `scaffold_cad.parts`, loaded with build123d when they are first asked for."""

if not TYPE_CHECKING:  # or type checkers would take any name for one of the package's

    def __getattr__(name: str) -> Any:
        if name not in PART_CLASSES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from scaffold_cad import parts

        return getattr(parts, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *PART_CLASSES})
