"""Content: what a file shall hold, in the forms that writers ask for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from scaffold_cad import brep
from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.arrays import Ints
from scaffold_cad.base.backends import is_instance
from scaffold_cad.brep.analytic import AnalyticBrep
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1 import Patches
from scaffold_cad.errors import FormatError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision import Subdivision
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.assembly import Assembly
from scaffold_cad.products.assemblybreps import assembly_brep
from scaffold_cad.products.breps import faces_of_struts, to_brep, union_of_scaffold
from scaffold_cad.products.overlaps import Overlaps, to_unite
from scaffold_cad.products.surfaces import surface_of
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.checking import check_single_precision
from scaffold_cad.solid.rounds import SIDES
from scaffold_cad.struts import RoundStruts

NEEDS_BREP = {
    "Skeleton": "round_struts or build_scaffold of it",
    "Manifold": "lattice_solid in place of lattice_part, round_struts or build_scaffold",
}
"""What has a B-rep, in place of what users give that has none."""


@checks_keywords()
@dataclass(frozen=True)
class Content:
    """What a file shall hold."""

    what: Any
    """The object given to `write`."""
    name: str
    """The name of the file without its suffix."""
    write_pcurves: bool = False
    """Whether edges are also written in the parameters of their faces (STEP only)."""
    overlaps: Overlaps | None = None
    """What becomes of struts that overlap; None to unite them in meshes, refuse them in B-reps."""
    sides: int = SIDES
    """Of the polygon that stands for the circle of a round strut in a mesh."""
    factor: float = 1.0
    """What lengths in mm are multiplied with before they are written."""
    unit: str = "mm"
    """The unit of the lengths then, for comments in files."""

    @property
    def kind(self) -> str:
        """The name of the type of `what`, for messages."""
        return "QuadMesh" if isinstance(self.what, QuadMesh) else type(self.what).__name__

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
        mesh = _mesh(self.what, self.overlaps or "unite", self.sides, self.factor)
        return _scaled(mesh, self.factor)

    def triangles(self) -> TriangleMesh:
        """Return the surface of `what` as triangles with 32-bit coordinates.

        Raises
        ------
        FormatError
            If it has no surface, or no face.
        MeshError
            If its struts are too thin for 32-bit coordinates so far from the origin.
        """
        if isinstance(self.what, Scaffold):
            check_single_precision(self.what.skeleton)
        return _single_precision(self.mesh())

    def patches(self) -> BezierMesh | None:
        """Return the faces that a B-rep of `what` has, or None if it is not a mesh of quads."""
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
        if isinstance(what, Scaffold):
            what = None if self._unites(what.embedding().left_out, what.skeleton) else what.mesh
        if isinstance(what, Subdivision):
            what = what.mesh
        return BezierMesh.bilinear(what) if isinstance(what, QuadMesh) else None

    def faces(self) -> AnalyticBrep | None:
        """Return the analytic faces of struts in mm, or None where there are none to write.

        These are those of round struts, and the facets of square ones that are united.

        Raises
        ------
        BrepError
            If struts overlap and are refused.
        """
        what = self.what
        if self.factor != 1.0 or not isinstance(what, Scaffold | RoundStruts):
            return None
        if isinstance(what, RoundStruts):
            return faces_of_struts(what, self.overlaps or "refuse")
        if self.overlaps != "unite" or not self._unites(what.embedding().left_out, what.skeleton):
            return None
        return union_of_scaffold(what)

    def _unites(self, edges: Ints, skeleton: Skeleton) -> bool:
        """Return whether struts that overlap are united, in a B-rep, or refuse them."""
        return to_unite(self.overlaps or "refuse", edges, skeleton)

    def face_names(self) -> list[str] | None:
        """Return each face's name: the skeleton edge that it belongs to, where that is known."""
        edges = None
        if isinstance(self.what, Scaffold):
            edges = self.what.edge_of_quad
        return None if edges is None else [f"edge {edge}" for edge in edges.tolist()]

    def shape(self) -> Any:
        """Return `what` as a build123d shape.

        Raises
        ------
        FormatError
            If it has no B-rep.
        """
        if is_instance(self.what, "build123d", "Shape"):
            return self._scaled(self.what)
        if isinstance(self.what, Scaffold | RoundStruts):
            return self._scaled(to_brep(self.what, overlaps=self.overlaps or "refuse"))
        if isinstance(self.what, Assembly):
            return self._scaled(assembly_brep(self.what))
        patches = self.patches()
        if patches is None:
            need = NEEDS_BREP.get(
                self.kind, "a Scaffold, RoundStruts, a QuadMesh, a BezierMesh or a build123d shape"
            )
            raise FormatError(
                f"STEP and BREP files need a B-rep, which a {self.kind} does not have; need {need}"
            )
        return brep.brep_of_patches(patches)

    def _scaled(self, shape: Any) -> Any:
        return shape if self.factor == 1.0 else shape.scale(self.factor)


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
    triangles = _single_precision(_mesh(what, "unite", SIDES, 1.0))
    triangles.check_closed()
    return triangles


def _single_precision(mesh: QuadMesh | TriangleMesh) -> TriangleMesh:
    if isinstance(mesh, QuadMesh):
        mesh = TriangleMesh(mesh.vertices, mesh.triangles)
    return mesh.single_precision()


def _scaled(mesh: QuadMesh | TriangleMesh, factor: float) -> QuadMesh | TriangleMesh:
    if factor == 1.0:
        return mesh
    if isinstance(mesh, QuadMesh):
        return mesh.moved(mesh.vertices * factor)
    return TriangleMesh(mesh.vertices * factor, mesh.triangles)


def _mesh(what: Any, overlaps: Overlaps, sides: int, factor: float) -> QuadMesh | TriangleMesh:
    mesh = surface_of(what, overlaps=overlaps, sides=sides, factor=factor)
    kind = type(what).__name__
    if isinstance(what, Skeleton):
        raise FormatError(
            "a mesh file cannot hold a Skeleton; need round_struts or build_scaffold of it"
        )
    if mesh is None:
        raise FormatError(
            f"a mesh file cannot hold a {kind}; need a Scaffold, RoundStruts, a mesh, a manifold3d "
            "Manifold, a trimesh Trimesh or a build123d shape"
        )
    if len(mesh.triangles) == 0:
        raise FormatError(f"the {kind} has no faces; need at least one")
    return mesh
