"""Gmsh meshes (.msh): their lines, through meshio."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.io._meshio import lines_of
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_reader


def _recognises(head: bytes) -> bool:
    return head.lstrip().startswith(b"$MeshFormat") or b"\n$MeshFormat" in head


@register_reader("Gmsh", ".msh", recognises=_recognises)
def read_gmsh(path: Path) -> RawSkeleton:
    """Read the line elements of a mesh, text or binary, which have no radii; other elements go.

    Data of points or cells called "radius" are radii. Lengths are taken as mm.
    """
    return lines_of(path, "gmsh")
