"""IGES: wires are read; faces on surfaces, which need not join, are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad import brep
from scaffold_cad.errors import FormatError
from scaffold_cad.io._cad import read_cad_wires
from scaffold_cad.io._curves import SAGITTA
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_mesh_reader, register_reader
from scaffold_cad.mesh.trianglemesh import TriangleMesh


def _recognizes(head: bytes) -> bool:
    lines = head.split(b"\n")[:2]
    return len(lines[0]) >= 80 and lines[0][72:73] == b"S" and lines[0][73:80].strip().isdigit()


@register_reader("IGES", ".iges", ".igs", recognizes=_recognizes)
def read_iges_wires(path: Path) -> RawSkeleton:
    """Read the curves of an IGES file that bound no face; it has no radii.

    Curves become edges within 1/1000 of their size, and join where they have equal points. Lengths
    are in the unit of the file.
    """
    return read_cad_wires(path, _recognizes)


@register_mesh_reader("IGES", ".iges", ".igs", names_unit=True)
def read_iges_triangles(path: Path) -> TriangleMesh:
    """Refuse a file with faces, and name what to use instead."""
    if not brep.read_wires(path, SAGITTA).faces:
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp))
    raise FormatError(f"{path} is an IGES file with faces; need STEP, BREP or STL")
