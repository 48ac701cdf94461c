"""What viewers of build123d can show of everything that the package makes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

from scaffold_cad.base.arguments import check_choice, checks_keywords
from scaffold_cad.base.backends import is_instance
from scaffold_cad.base.builders import built
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1 import Patches
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision import Subdivision
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.meshshapes import to_mesh_shape
from scaffold_cad.products.models import Model, overlapping
from scaffold_cad.products.overlaps import Overlaps, to_unite
from scaffold_cad.products.surfaces import surface_of
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import Solidified
from scaffold_cad.struts import RoundStruts

if TYPE_CHECKING:
    from build123d import Shape

MOST_STRUTS = 500
"""Round struts that are shown as faces with their edges; more of them as bare triangles."""

MOST_QUADS = 5000
"""Quads that are shown as faces with their edges; more of them are shown as bare triangles."""


@checks_keywords()
def to_shape(what: Any, overlaps: Overlaps = "unite") -> Shape:
    """Return a build123d shape to look at.

    Parameters
    ----------
    what : a Skeleton, which becomes straight edges; a Scaffold, a QuadMesh, or smooth patches,
        whose quads become faces; round struts, up to 500 of them as cylinders, cones and patches,
        and more of them as triangles; a subdivision, a TriangleMesh, a Solidified, a manifold3d
        Manifold or a trimesh Trimesh, see `to_mesh_shape`; a build123d shape or a builder, as it
        is
    overlaps : what becomes of struts that overlap: "unite" them and show all as triangles,
        "refuse" them, or "allow" faces that cross

    Raises
    ------
    OptionError
        If it is nothing that can be shown.
    BrepError
        If struts overlap and are refused.
    MissingBackendError
        If build123d is not installed.
    """
    check_choice(overlaps, "overlaps", get_args(Overlaps))
    what = built(what)
    if is_instance(what, "build123d", "Shape"):
        return what
    if isinstance(what, Skeleton):
        return what.to_wire_compound()
    if isinstance(what, Patches | BezierMesh):
        return to_brep(what, "shell")
    if isinstance(what, RoundStruts | Scaffold):
        return _shape_of_struts(what, overlaps)
    if isinstance(what, Subdivision):
        what = what.mesh
    if isinstance(what, Solidified):
        what = what.manifold
    return _faces(what) if isinstance(what, QuadMesh) else to_mesh_shape(what)


def _shape_of_struts(what: Model, overlaps: Overlaps) -> Shape:
    """Return struts as faces where they are few, as triangles where not, or where united."""
    crossing = overlapping(what)
    if overlaps == "unite" and len(crossing):
        return to_mesh_shape(surface_of(what, overlaps=overlaps))
    if isinstance(what, Scaffold):
        to_unite(overlaps, crossing, what.skeleton)
        return _faces(what.mesh)
    if len(what.runs.edges) <= MOST_STRUTS:
        return to_brep(what, overlaps=overlaps)
    return to_mesh_shape(surface_of(what, overlaps=overlaps))


def _faces(mesh: QuadMesh) -> Shape:
    """Return the quads as faces, or as triangles where they are many or CAD takes no such faces."""
    if len(mesh.quads) > MOST_QUADS:
        return to_mesh_shape(mesh)
    try:
        return to_brep(mesh, "shell")
    except ScaffoldCadError:
        return to_mesh_shape(mesh)
