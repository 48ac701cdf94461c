"""B-reps: Bézier patches, shells and solids of them; only this wing and parts use OCCT."""

from scaffold_cad.brep.bodies import bodies, with_plane_faces
from scaffold_cad.brep.brepfiles import check_brep_file
from scaffold_cad.brep.cadwires import Wires, read_wires
from scaffold_cad.brep.shapes import (
    BREP_SUFFIXES,
    TESSELLATION_DISTANCE,
    Kind,
    brep_of_faces,
    brep_of_patches,
    check_edges,
    check_sizes,
    export_brep,
    export_step,
    read_brep,
    read_shape,
    tessellated,
    tessellation_distance,
    tessellation_error,
)
from scaffold_cad.brep.voids import moved_inwards, with_voids, without

__all__ = [
    "BREP_SUFFIXES",
    "TESSELLATION_DISTANCE",
    "Kind",
    "Wires",
    "bodies",
    "brep_of_faces",
    "brep_of_patches",
    "check_brep_file",
    "check_edges",
    "check_sizes",
    "export_brep",
    "export_step",
    "moved_inwards",
    "read_brep",
    "read_shape",
    "read_wires",
    "tessellated",
    "tessellation_distance",
    "tessellation_error",
    "with_plane_faces",
    "with_voids",
    "without",
]
