"""Solid lattice frames and organic solids from skeletons, for build123d.

>>> from scaffold_cad import Skeleton, build_scaffold
>>> tripod = Skeleton([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], [[0, 1], [0, 2], [0, 3]], 1.0)
>>> len(build_scaffold(tripod).mesh.quads)
15
"""

from scaffold_cad.brep import to_brep
from scaffold_cad.embedding import Embedding
from scaffold_cad.export import write
from scaffold_cad.frames import rotation_minimizing_frames
from scaffold_cad.intersections import self_intersections
from scaffold_cad.io import read_skeleton
from scaffold_cad.partition import Partition, partition_sphere, partition_spheres
from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.solid import to_trimesh
from scaffold_cad.solidify import Solidified, solidified, to_solid
from scaffold_cad.thicken import thicken
from scaffold_cad.trianglemesh import TriangleMesh

__all__ = [
    "Embedding",
    "Partition",
    "QuadMesh",
    "Scaffold",
    "Skeleton",
    "Solidified",
    "TriangleMesh",
    "build_scaffold",
    "check_skeleton",
    "partition_sphere",
    "partition_spheres",
    "read_skeleton",
    "rotation_minimizing_frames",
    "self_intersections",
    "solidified",
    "thicken",
    "to_brep",
    "to_solid",
    "to_trimesh",
    "write",
]

__version__ = "0.1.0"
