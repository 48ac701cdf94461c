"""MED meshes of Salome and Code_Aster: their segments, through meshio."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.io._meshio import lines_of
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_reader


def _recognizes(head: bytes) -> bool:
    return head.startswith(b"\x89HDF\r\n\x1a\n")


@register_reader("MED", ".med", recognizes=_recognizes)
def read_med(path: Path) -> RawSkeleton:
    """Read the segments of a mesh, which have no radii; other elements go.

    Fields of points or cells called "radius" are radii. Lengths are taken as mm.
    """
    return lines_of(path, "med")
