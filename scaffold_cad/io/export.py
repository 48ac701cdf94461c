"""write(): what the package makes, as a file whose suffix names the format.

======================  ====================================================================
.step .stp              solids, mm; a face named after its skeleton edge; build123d shapes too
.brep                   OCCT's own format, mm
.stl                    binary, 32-bit coordinates, mm
.3mf                    one mesh object, 32-bit coordinates, mm; a skeleton as a beam lattice
.obj .ply               quads stay quads, 64-bit coordinates, mm; OBJ also a skeleton, as lines
.glb                    metres and y up, as glTF asks
.json                   a skeleton, as `read_skeleton` reads it
.swc                    a skeleton without loops, as `read_skeleton` reads it
======================  ====================================================================
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

from scaffold_cad import brep
from scaffold_cad.base.arguments import as_path
from scaffold_cad.base.backends import is_instance
from scaffold_cad.base.builders import built
from scaffold_cad.base.files import check_target, replacing
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.errors import FormatError, OptionError
from scaffold_cad.io import skeleton_to_json
from scaffold_cad.io.writers.glb import write_glb
from scaffold_cad.io.writers.obj import write_obj, write_obj_lines
from scaffold_cad.io.writers.ply import write_ply, write_ply_slabs
from scaffold_cad.io.writers.step import write_step
from scaffold_cad.io.writers.stl import write_stl, write_stl_slabs
from scaffold_cad.io.writers.swc import write_swc
from scaffold_cad.io.writers.threemf import write_3mf, write_3mf_beams
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.shells import check_solid
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import surface_of
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.beams import BeamLattice
from scaffold_cad.smooth import FineSurface, Patches, Subdivision

SKELETON_SUFFIXES = (".json", ".swc")
"""Suffixes of the formats that hold skeletons and nothing else."""


@dataclass(frozen=True)
class Content:
    """What a file shall hold."""

    what: Any
    """The object given to `write`."""
    name: str
    """The name of the file without its suffix."""
    write_pcurves: bool
    """Whether edges are also written in the parameters of their faces (STEP only)."""
    slabs: int | None
    """In how many slabs a fine surface is made."""


Writer: TypeAlias = Callable[[Content, Path], None]
"""Writes a file, which exists and is empty."""

_writers: dict[str, Writer] = {}


def register_writer(*suffixes: str) -> Callable[[Writer], Writer]:
    """Register the decorated writer for files with one of `suffixes`, such as ".stl"."""

    def register(writer: Writer) -> Writer:
        _writers.update(dict.fromkeys(suffixes, writer))
        return writer

    return register


def write(
    what: Any,
    path: str | PathLike[str],
    *,
    write_pcurves: bool = False,
    slabs: int | None = None,
) -> None:
    """Write `what` to the file at `path`, whole or not at all.

    Parameters
    ----------
    what : a Scaffold, a QuadMesh, smooth patches, a subdivision or a BezierMesh for any format
        that holds solids, the overlapping struts of a Scaffold united in mesh formats (`to_solid`);
        a Solidified, a TriangleMesh, a manifold3d Manifold or a trimesh Trimesh for mesh formats; a
        build123d shape, or a builder, which mesh formats get within 0.01 mm; a Skeleton for JSON,
        3MF (as a beam lattice), OBJ (as lines, without radii) and SWC (without loops); a
        BeamLattice for 3MF; a FineSurface for STL and PLY
    path : of the file; its suffix names the format
    write_pcurves : whether a STEP file also holds each edge in the parameters of its faces, for
        programs that ask for it: twice the size, and OCCT takes longer to write and to read it
    slabs : ≥ 1; in how many slabs a FineSurface is made and written, which bounds the memory
        needed beyond the scaffold's; by default as many as keep it under some 500 MB

    Raises
    ------
    FormatError
        If the suffix is unknown, the format cannot hold `what`, or the file cannot be written.
    MeshError, BrepError
        If a B-rep is asked for and the mesh does not bound a solid, or a mesh of a BeamLattice is
        not closed.
    OptionError
        If `write_pcurves` is asked of another format than STEP, or `slabs` for anything but a
        FineSurface, or there are fewer than 1; or `what` is a builder that holds no shape yet, or
        `path` is none.
    MissingBackendError
        If the package that writes the format is not installed.
    """
    path, what = _target(path, what), built(what)
    writer = _writer_of(path)
    if write_pcurves and writer is not _write_step:
        raise OptionError(f"write_pcurves is for STEP files only; {path.name} is none")
    if slabs is not None and not isinstance(what, FineSurface):
        raise OptionError(f"slabs is for a FineSurface only; {path.name} gets a {_kind(what)}")
    with replacing(path) as fresh:
        writer(Content(what, path.stem, write_pcurves, slabs), fresh)


def check_writable(path: str | PathLike[str], *, solid: bool = False) -> None:
    """Raise unless `write` knows the suffix of `path` and can write a file there.

    Parameters
    ----------
    solid : whether the format must be able to hold solids

    Raises
    ------
    FormatError
        If the suffix is unknown, or the folder is missing or read-only.
    """
    path = as_path(path)
    _writer_of(path, without=SKELETON_SUFFIXES if solid else ())
    check_target(path)


def known_suffixes() -> tuple[str, ...]:
    """Return the suffixes that `write` knows, in alphabetic order."""
    return tuple(sorted(_writers))


def _target(path: str | PathLike[str], what: Any) -> Path:
    if isinstance(what, str | PathLike) and not isinstance(path, str | PathLike):
        raise OptionError(
            f"path is of type {_kind(path)}: the object comes first, as in write(what, {what!r})"
        )
    return as_path(path)


def _writer_of(path: Path, without: tuple[str, ...] = ()) -> Writer:
    suffix = path.suffix.lower()
    if suffix in _writers and suffix not in without:
        return _writers[suffix]
    known = ", ".join(known for known in known_suffixes() if known not in without)
    raise FormatError(f"cannot write {path}: its suffix is {suffix!r}; need {known}")


@register_writer(".step", ".stp")
def _write_step(content: Content, path: Path) -> None:
    patches = _patches(content.what)
    if patches is None or content.write_pcurves:
        brep.export_step(_shape(content.what), path, write_pcurves=content.write_pcurves)
        return
    check_solid(patches.mesh)
    brep.check_sizes(patches)
    write_step(patches, path, name=content.name, face_names=_face_names(content.what))


@register_writer(".brep")
def _write_brep(content: Content, path: Path) -> None:
    brep.export_brep(_shape(content.what), path)


@register_writer(".stl")
def _write_stl(content: Content, path: Path) -> None:
    if isinstance(content.what, FineSurface):
        write_stl_slabs(content.what, content.slabs, path)
        return
    write_stl(_triangles(content.what).single_precision(), path)


@register_writer(".3mf")
def _write_3mf(content: Content, path: Path) -> None:
    what = content.what
    if isinstance(what, Skeleton):
        what = BeamLattice(what)
    if isinstance(what, BeamLattice):
        clip, mesh = (_closed_triangles(part) for part in (what.clip, what.mesh))
        write_3mf_beams(replace(what, clip=clip, mesh=mesh), path)
        return
    write_3mf(_triangles(content.what).single_precision(), path)


@register_writer(".obj")
def _write_obj(content: Content, path: Path) -> None:
    if isinstance(content.what, Skeleton):
        write_obj_lines(content.what, path)
    else:
        write_obj(_mesh(content.what), path)


@register_writer(".ply")
def _write_ply(content: Content, path: Path) -> None:
    if isinstance(content.what, FineSurface):
        write_ply_slabs(content.what, content.slabs, path)
        return
    write_ply(_mesh(content.what), path)


@register_writer(".glb")
def _write_glb(content: Content, path: Path) -> None:
    write_glb(_triangles(content.what).single_precision(), path)


@register_writer(".json")
def _write_json(content: Content, path: Path) -> None:
    if not isinstance(content.what, Skeleton):
        raise FormatError(f"a JSON file cannot hold a {_kind(content.what)}; need a Skeleton")
    path.write_text(skeleton_to_json(content.what), encoding="utf-8")


@register_writer(".swc")
def _write_swc(content: Content, path: Path) -> None:
    if not isinstance(content.what, Skeleton):
        raise FormatError(f"an SWC file cannot hold a {_kind(content.what)}; need a Skeleton")
    write_swc(content.what, path)


def _patches(what: Any) -> BezierMesh | None:
    """Return the faces that a B-rep of `what` has, or None if it is no mesh of quads."""
    if isinstance(what, BezierMesh):
        return what
    if isinstance(what, Patches):
        return what.bezier
    if isinstance(what, Scaffold | Subdivision):
        what = what.mesh
    return BezierMesh.bilinear(what) if isinstance(what, QuadMesh) else None


def _face_names(what: Any) -> list[str] | None:
    """Return the name of each face: the skeleton edge that it belongs to, where that is known."""
    edges = None
    if isinstance(what, Scaffold):
        edges = what.edge_of_quad
    elif isinstance(what, Patches):
        edges = what.edge_of_patch
    return None if edges is None else [f"edge {edge}" for edge in edges.tolist()]


def _shape(what: Any) -> Any:
    """Return `what` as a build123d shape."""
    if is_instance(what, "build123d", "Shape"):
        return what
    patches = _patches(what)
    if patches is None:
        raise FormatError(
            f"STEP and BREP files need a B-rep, which a {_kind(what)} has not; "
            "need a Scaffold, a QuadMesh, a BezierMesh or a build123d shape"
        )
    return brep.brep_of_patches(patches)


def _triangles(what: Any) -> TriangleMesh:
    """Return the surface of `what` as triangles."""
    mesh = _mesh(what)
    return TriangleMesh(mesh.vertices, mesh.triangles) if isinstance(mesh, QuadMesh) else mesh


def _closed_triangles(what: Any) -> TriangleMesh | None:
    """Return the closed surface of `what` with 32-bit coordinates, or None for None."""
    if what is None:
        return None
    triangles = _triangles(what).single_precision()
    triangles.check_closed()
    return triangles


def _mesh(what: Any) -> QuadMesh | TriangleMesh:
    """Return the surface of `what` as quads, or as triangles if it has no quads."""
    if isinstance(what, FineSurface):
        raise FormatError("a FineSurface goes to .stl and .ply only; need smooth_mesh for others")
    mesh = surface_of(what)
    if mesh is None:
        raise FormatError(
            f"a mesh file cannot hold a {_kind(what)}; need a Scaffold, a mesh, a manifold3d "
            "Manifold, a trimesh Trimesh or a build123d shape"
        )
    if len(mesh.triangles) == 0:
        raise FormatError(f"the {_kind(what)} has no faces; need at least one")
    return mesh


def _kind(what: Any) -> str:
    return type(what).__name__
