"""BREP: OCCT's own format of solids, mm."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad import brep
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_mesh_reader, register_writer
from scaffold_cad.mesh.trianglemesh import TriangleMesh


@register_writer(".brep", name="OCCT B-rep")
def write_brep_content(content: Content, path: Path) -> None:
    """Write the B-rep of what `write` is given."""
    brep.export_brep(content.shape(), path)


@register_mesh_reader("OCCT B-rep", ".brep")
def read_brep_triangles(path: Path) -> TriangleMesh:
    """Read the solids of a BREP file as triangles within 0.01 mm."""
    return brep.tessellated(brep.read_brep(path))
