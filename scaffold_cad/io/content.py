"""Content: what a file shall hold, in the forms that writers ask for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from scaffold_cad import brep
from scaffold_cad.base.backends import is_instance
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.errors import FormatError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import surface_of
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import FineSurface, Patches, Subdivision


@dataclass(frozen=True)
class Content:
    """What a file shall hold."""

    what: Any
    """The object given to `write`."""
    name: str
    """The name of the file without its suffix."""
    write_pcurves: bool = False
    """Whether edges are also written in the parameters of their faces (STEP only)."""
    slabs: int | None = None
    """In how many slabs a fine surface is made."""
    factor: float = 1.0
    """What lengths in mm are multiplied with before they are written."""
    unit: str = "mm"
    """The unit of the lengths then, for comments in files."""

    @property
    def kind(self) -> str:
        """The name of the type of `what`, for messages."""
        return type(self.what).__name__

    def skeleton(self, file: str) -> Skeleton:
        """Return `what` if it is a Skeleton; `file` says which file cannot hold others.

        Raises
        ------
        FormatError
            If it is something else.
        """
        if not isinstance(self.what, Skeleton):
            raise FormatError(f"{file} cannot hold a {self.kind}; need a Skeleton")
        return self.what if self.factor == 1.0 else self.what.scaled(self.factor)

    def mesh(self) -> QuadMesh | TriangleMesh:
        """Return the surface of `what` as quads, or as triangles if it has no quads.

        Raises
        ------
        FormatError
            If it has no surface, or no face.
        """
        return _scaled(_mesh(self.what), self.factor)

    def triangles(self) -> TriangleMesh:
        """Return the surface of `what` as triangles with 32-bit coordinates.

        Raises
        ------
        FormatError
            If it has no surface, or no face.
        """
        return _triangles(self.what, self.factor)

    def patches(self) -> BezierMesh | None:
        """Return the faces that a B-rep of `what` has, or None if it is no mesh of quads."""
        found = self._patches()
        if found is None or self.factor == 1.0:
            return found
        return replace(found, control_points=found.control_points * self.factor)

    def _patches(self) -> BezierMesh | None:
        what = self.what
        if isinstance(what, BezierMesh):
            return what
        if isinstance(what, Patches):
            return what.bezier
        if isinstance(what, Scaffold | Subdivision):
            what = what.mesh
        return BezierMesh.bilinear(what) if isinstance(what, QuadMesh) else None

    def face_names(self) -> list[str] | None:
        """Return each face's name: the skeleton edge that it belongs to, where that is known."""
        edges = None
        if isinstance(self.what, Scaffold):
            edges = self.what.edge_of_quad
        elif isinstance(self.what, Patches):
            edges = self.what.edge_of_patch
        return None if edges is None else [f"edge {edge}" for edge in edges.tolist()]

    def shape(self) -> Any:
        """Return `what` as a build123d shape.

        Raises
        ------
        FormatError
            If it has no B-rep.
        """
        if is_instance(self.what, "build123d", "Shape"):
            return self.what if self.factor == 1.0 else self.what.scale(self.factor)
        patches = self.patches()
        if patches is None:
            raise FormatError(
                f"STEP and BREP files need a B-rep, which a {self.kind} has not; "
                "need a Scaffold, a QuadMesh, a BezierMesh or a build123d shape"
            )
        return brep.brep_of_patches(patches)


def closed_triangles(what: Any) -> TriangleMesh | None:
    """Return the closed surface of `what` with 32-bit coordinates, or None for None.

    Raises
    ------
    FormatError
        If it has no surface, or no face.
    MeshError
        If its surface is not closed.
    """
    if what is None:
        return None
    triangles = _triangles(what)
    triangles.check_closed()
    return triangles


def _triangles(what: Any, factor: float = 1.0) -> TriangleMesh:
    mesh = _scaled(_mesh(what), factor)
    if isinstance(mesh, QuadMesh):
        mesh = TriangleMesh(mesh.vertices, mesh.triangles)
    return mesh.single_precision()


def _scaled(mesh: QuadMesh | TriangleMesh, factor: float) -> QuadMesh | TriangleMesh:
    if factor == 1.0:
        return mesh
    if isinstance(mesh, QuadMesh):
        return mesh.moved(mesh.vertices * factor)
    return TriangleMesh(mesh.vertices * factor, mesh.triangles)


def _mesh(what: Any) -> QuadMesh | TriangleMesh:
    if isinstance(what, FineSurface):
        raise FormatError("a FineSurface goes to .stl and .ply only; need smooth_mesh for others")
    mesh = surface_of(what)
    kind = type(what).__name__
    if mesh is None:
        raise FormatError(
            f"a mesh file cannot hold a {kind}; need a Scaffold, a mesh, a manifold3d "
            "Manifold, a trimesh Trimesh or a build123d shape"
        )
    if len(mesh.triangles) == 0:
        raise FormatError(f"the {kind} has no faces; need at least one")
    return mesh
