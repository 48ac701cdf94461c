"""Gmsh meshes (.msh): their lines, through meshio."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._meshio import LARGEST_MESH, lines_of
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import check_size
from scaffold_cad.io.register import register_reader


def _recognizes(head: bytes) -> bool:
    return head.lstrip().startswith(b"$MeshFormat") or b"\n$MeshFormat" in head


@register_reader("Gmsh", ".msh", recognizes=_recognizes)
def read_gmsh(path: Path) -> RawSkeleton:
    """Read the line elements of a mesh, text or binary, which have no radii; other elements go.

    Data of points or cells called "radius" are radii. Lengths are taken as mm.
    """
    check_size(path, LARGEST_MESH)
    if b"$EndElements" not in path.read_bytes():
        raise FormatError(f"{path} has no $EndElements: it was cut short; need the whole file")
    return lines_of(path, "gmsh")
