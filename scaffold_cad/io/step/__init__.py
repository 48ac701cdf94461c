"""STEP files (ISO 10303-21, AP214): written straight from arrays, read by OCCT."""

from __future__ import annotations

import tempfile
from pathlib import Path

from scaffold_cad import brep
from scaffold_cad.base.packed import PACKED_SUFFIX, pack, unpacked_head
from scaffold_cad.io._cad import read_cad_triangles, read_cad_wires
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.io.step.analytic import write_analytic
from scaffold_cad.io.step.patches import write_step
from scaffold_cad.mesh.shells import check_solid
from scaffold_cad.mesh.trianglemesh import TriangleMesh

STEP_SUFFIXES = (".step", ".stp", PACKED_SUFFIX)

ZIP = b"PK\x03\x04"
"""First bytes of what zip packs."""

NAMES = (b".step", b".stp")
"""How names of STEP files in archives end."""


@register_writer(*STEP_SUFFIXES, name="STEP", skeletons=False, names_unit=True)
def write_step_content(content: Content, path: Path) -> None:
    """Write a build123d shape by OCCT, and meshes of quads straight from their arrays."""
    if path.suffix.lower() != PACKED_SUFFIX:
        _write_plain(content, path)
        return
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "plain.step"
        _write_plain(content, plain)
        pack(plain, path)


def _write_plain(content: Content, path: Path) -> None:
    faces = None if content.write_pcurves else content.faces()
    if faces is not None:
        brep.check_edges(faces)
        write_analytic(faces, path, name=content.name)
        return
    patches = content.patches()
    if patches is None or content.write_pcurves:
        brep.export_step(content.shape(), path, write_pcurves=content.write_pcurves)
        return
    check_solid(patches.mesh)
    brep.check_sizes(patches)
    write_step(patches, path, name=content.name, face_names=content.face_names())


@register_mesh_reader("STEP", *STEP_SUFFIXES, names_unit=True)
def read_step_triangles(path: Path) -> TriangleMesh:
    """Read the solids of a STEP file as triangles; none if it holds wires only."""
    return read_cad_triangles(path)


def _recognizes(head: bytes) -> bool:
    if head.startswith(ZIP):  # so do others: the name of the first file within tells
        return head[30 : 30 + int.from_bytes(head[26:28], "little")].lower().endswith(NAMES)
    return unpacked_head(head).lstrip().startswith(b"ISO-10303-21")


@register_reader("STEP", *STEP_SUFFIXES, recognizes=_recognizes)
def read_step_wires(path: Path) -> RawSkeleton:
    """Read the edges and wires of a STEP file that bound no face; it has no radii.

    Curves become edges within 1/1000 of their size, and join where they have equal points.
    """
    return read_cad_wires(path, _recognizes)


__all__ = ["STEP_SUFFIXES", "write_analytic", "write_step"]
