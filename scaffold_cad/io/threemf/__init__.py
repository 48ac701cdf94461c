"""3MF: meshes and beam lattices (3MF Core 1.3, Beam Lattice 1.2, Production 1.1)."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._mesh import joined_meshes
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.content import Content, closed_triangles
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.io.threemf.archive import read_package
from scaffold_cad.io.threemf.pieces import skeleton_of, triangles_of
from scaffold_cad.io.threemf.writing import write_3mf, write_3mf_beams
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.beams import BeamLattice

_log = logging.getLogger(__name__)


def _recognises(head: bytes) -> bool:
    return head.startswith(b"PK\x03\x04")


@register_reader("3MF", ".3mf", recognises=_recognises)
def read_3mf(path: Path) -> RawSkeleton:
    """Read the beam lattices that a 3MF file builds, each where it is placed, in mm.

    Each beam keeps the radii of its ends; a transform scales them by the cube root of its
    determinant. Meshes, balls and vertices without a beam are left out, and a
    lattice that is to be clipped is read whole.
    """
    pieces = read_package(path)
    for clipping in sorted({piece.body.clipping for piece in pieces} - {"none"}):
        _log.warning("%s: beams are to be clipped (%s); they are read whole", path, clipping)
    skeleton = skeleton_of(pieces)
    if len(skeleton.edges) == 0:
        raise FormatError(f"{path} builds no beam lattice; need at least one beam")
    return skeleton


@register_mesh_reader("3MF", ".3mf")
def read_3mf_triangles(path: Path) -> TriangleMesh:
    """Read the meshes that a 3MF file builds, in mm; none if it has beams: it is a skeleton."""
    pieces = read_package(path)
    beams = sum(len(piece.body.beams) for piece in pieces)
    mesh = triangles_of(pieces)
    if not beams:
        return mesh
    if len(mesh.triangles):
        _log.warning(
            "%s: %d beams are taken, not the %d triangles beside them",
            path,
            beams,
            len(mesh.triangles),
        )
    return joined_meshes([])


@register_writer(".3mf", name="3MF")
def write_3mf_content(content: Content, path: Path) -> None:
    """Write a Skeleton or a BeamLattice as beams, and the triangles of anything else."""
    what = content.what
    if isinstance(what, Skeleton):
        what = BeamLattice(what)
    if isinstance(what, BeamLattice):
        clip, mesh = (closed_triangles(part) for part in (what.clip, what.mesh))
        write_3mf_beams(replace(what, clip=clip, mesh=mesh), path)
        return
    write_3mf(content.triangles(), path)
