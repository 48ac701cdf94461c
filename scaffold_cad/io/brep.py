"""BREP: OCCT's own format of solids, mm."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad import brep
from scaffold_cad.io._cad import read_cad_triangles, read_cad_wires
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, check_size
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.mesh.trianglemesh import TriangleMesh


@register_writer(".brep", name="OCCT B-rep", skeletons=False, names_unit=True)
def write_brep_content(content: Content, path: Path) -> None:
    """Write the B-rep of what `write` is given."""
    brep.export_brep(content.shape(), path)


@register_mesh_reader("OCCT B-rep", ".brep", names_unit=True)
def read_brep_triangles(path: Path) -> TriangleMesh:
    """Read the solids of a BREP file as triangles; none if it holds wires only."""
    return read_cad_triangles(path)


def _recognizes(head: bytes) -> bool:
    return b"CASCADE Topology" in head[:200]


@register_reader("OCCT B-rep", ".brep", recognizes=_recognizes)
def read_brep_wires(path: Path) -> RawSkeleton:
    """Read the edges and wires of a BREP file that bound no face; it has no radii.

    Curves become edges within 1/1000 of their size, and join where they have equal points.
    """
    check_size(path, LARGEST_FILE)
    brep.check_brep_file(path)
    return read_cad_wires(path, _recognizes)
