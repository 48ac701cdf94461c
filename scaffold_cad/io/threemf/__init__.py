"""3MF: meshes and beam lattices (3MF Core 1.3, Beam Lattice 1.2, Production 1.1)."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import overload

from scaffold_cad.base.arguments import as_path, checks_keywords
from scaffold_cad.base.files import reading
from scaffold_cad.errors import FormatError, MeshError, SkeletonError
from scaffold_cad.io._mesh import joined_meshes
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.content import Content, closed_triangles
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.io.threemf.archive import read_package
from scaffold_cad.io.threemf.pieces import assembly_of, skeleton_of, triangles_of
from scaffold_cad.io.threemf.streaming import write_lattice
from scaffold_cad.io.threemf.surfaces import write_3mf
from scaffold_cad.io.threemf.writing import write_3mf_assembly
from scaffold_cad.lattice.periodic import PeriodicLattice
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.assembly import Assembly, assembly_solid, log_united
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.beams import BeamLattice
from scaffold_cad.solid.manifolds import manifold_triangles


def _recognizes(head: bytes) -> bool:
    return head.startswith(b"PK\x03\x04")


@register_reader("3MF", ".3mf", recognizes=_recognizes)
def read_3mf(path: Path) -> RawSkeleton:
    """Read the beam lattices that a 3MF file builds, each where it is placed, in mm.

    Each beam keeps the radii of its ends; a transform scales them by the cube root of its
    determinant. What a skeleton does not keep, such as meshes beside the beams, clipping and balls,
    is named in `left_out`; `read_assembly` reads it.
    """
    pieces = read_package(path)
    skeleton = skeleton_of(pieces)
    if len(skeleton.edges) == 0:
        raise FormatError(f"{path} builds no beam lattice; need at least one beam")
    return skeleton


@checks_keywords()
def read_assembly(path: str | PathLike[str]) -> Assembly:
    """Return what a 3MF file builds, as what it is: beam lattices and meshes, in mm.

    Raises
    ------
    FormatError
        If the file cannot be read.
    """
    path = as_path(path)
    try:
        with reading(path):
            return assembly_of(read_package(path))
    except (MeshError, SkeletonError) as error:
        raise FormatError(f"{path}: {error}") from None


@register_mesh_reader("3MF", ".3mf", names_unit=True)
def read_3mf_triangles(path: Path) -> TriangleMesh:
    """Read the meshes that a 3MF file builds, in mm; none if a skeleton holds all of it.

    Where there are beams too, their solid is made and united with the meshes.
    """
    pieces = read_package(path)
    if not any(len(piece.body.beams) for piece in pieces):
        return triangles_of(pieces)
    assembly = assembly_of(pieces)
    if assembly.is_skeleton or not (assembly.lattices or assembly.meshes):
        return joined_meshes([])
    log_united(assembly, str(path))
    return manifold_triangles(assembly_solid(assembly))


@register_writer(".3mf", name="3MF", names_unit=True, radii="members")
def write_3mf_content(content: Content, path: Path) -> None:
    """Write a Skeleton, a PeriodicLattice, a BeamLattice or an Assembly as beams.

    Of anything else the triangles are written.
    """
    what, factor = content.what, content.factor
    if isinstance(what, PeriodicLattice):
        write_lattice(what if factor == 1.0 else what.scaled(factor), path)
        return
    if isinstance(what, Skeleton):
        what = BeamLattice(content.skeleton("a 3MF file"))
        factor = 1.0
    if isinstance(what, BeamLattice):
        what = Assembly([what])
    if isinstance(what, Assembly):
        meshes = [_scaled(mesh, factor) for mesh in what.meshes]
        write_3mf_assembly(Assembly([_closed(one, factor) for one in what.lattices], meshes), path)
        return
    write_3mf(content.triangles(), path)


def _closed(lattice: BeamLattice, factor: float) -> BeamLattice:
    """Return a lattice times `factor`, its meshes closed triangles with 32-bit coordinates."""
    return replace(
        lattice,
        skeleton=lattice.skeleton if factor == 1.0 else lattice.skeleton.scaled(factor),
        balls=lattice.balls * factor,
        clip=_scaled(closed_triangles(lattice.clip), factor),
        mesh=_scaled(closed_triangles(lattice.mesh), factor),
        representation=_scaled(closed_triangles(lattice.representation), factor),
    )


@overload
def _scaled(mesh: TriangleMesh, factor: float) -> TriangleMesh: ...


@overload
def _scaled(mesh: None, factor: float) -> None: ...


def _scaled(mesh: TriangleMesh | None, factor: float) -> TriangleMesh | None:
    if mesh is None or factor == 1.0:
        return mesh
    return TriangleMesh(mesh.vertices * factor, mesh.triangles)
