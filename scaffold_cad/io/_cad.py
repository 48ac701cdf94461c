"""Solids and wires of CAD files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from scaffold_cad import brep
from scaffold_cad.base.packed import unpacked
from scaffold_cad.errors import FormatError
from scaffold_cad.io._curves import SAGITTA
from scaffold_cad.io._raw import RawSkeleton, joined_polylines
from scaffold_cad.mesh.trianglemesh import TriangleMesh

HEAD = 2**12
"""Bytes from which a CAD format is recognized."""


def read_cad_wires(path: Path, recognizes: Callable[[bytes], bool]) -> RawSkeleton:
    """Return the edges of a CAD file that bound no face, joined where they have equal points.

    Parameters
    ----------
    recognizes : tells from the first bytes of a file whether it holds the format

    Raises
    ------
    FormatError
        If it cannot be read, or has no such edges.
    """
    with unpacked(path) as plain, plain.open("rb") as stream:
        if not recognizes(stream.read(HEAD)):
            raise FormatError(
                f"{path} does not begin as {path.suffix[1:].upper()}; need such a file"
            )
    wires = brep.read_wires(path, SAGITTA)
    if not wires.lines:
        raise FormatError(
            f"{path} holds {wires.faces} faces and no wires; need edges that bound no face "
            "(those of a part's faces: Skeleton.from_edges(import_step(...).edges(), radius))"
        )
    return joined_polylines(wires.lines, "mm")


def read_cad_triangles(path: Path) -> TriangleMesh:
    """Return the solids of a STEP or BREP file as triangles, none if it holds only wires.

    Raises
    ------
    FormatError
        If it cannot be read, or holds faces and no solid.
    """
    shape = brep.read_shape(path)
    if shape.solids():
        return brep.tessellated(shape)
    if shape.faces() or not shape.edges():
        raise FormatError(f"{path} holds no solid; need one")
    return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp))
