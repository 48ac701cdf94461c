"""What viewers of build123d can show of everything that the package makes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.backends import is_instance
from scaffold_cad.base.builders import built
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1 import Patches
from scaffold_cad.errors import ScaffoldCadError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision import Subdivision
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.meshshapes import to_mesh_shape
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
def to_shape(what: Any) -> Shape:
    """Return a build123d shape to look at.

    Parameters
    ----------
    what : a Skeleton, which becomes straight edges; a Scaffold, a QuadMesh, or smooth patches,
        whose quads become faces, as they are; round struts, up to 500 of them as cylinders, cones
        and patches, and more of them, or those that overlap, as triangles; a subdivision, a
        TriangleMesh, a Solidified, a manifold3d Manifold or a trimesh Trimesh, see
        `to_mesh_shape`; a build123d shape or a builder, as it is

    Raises
    ------
    OptionError
        If it is nothing that can be shown.
    MissingBackendError
        If build123d is not installed.
    """
    what = built(what)
    if is_instance(what, "build123d", "Shape"):
        return what
    if isinstance(what, Skeleton):
        return what.to_wire_compound()
    if isinstance(what, Patches | BezierMesh):
        return to_brep(what, "shell")
    if isinstance(what, RoundStruts):
        few = len(what.runs.edges) <= MOST_STRUTS and len(what.overlapping) == 0
        return to_brep(what) if few else to_mesh_shape(what)
    if isinstance(what, Scaffold | Subdivision):
        what = what.mesh
    if isinstance(what, Solidified):
        what = what.manifold
    if isinstance(what, QuadMesh) and len(what.quads) <= MOST_QUADS:
        return _faces(what)
    return to_mesh_shape(what)


def _faces(mesh: QuadMesh) -> Shape:
    """Return the quads as faces, or as triangles where CAD takes no such faces."""
    try:
        return to_brep(mesh, "shell")
    except ScaffoldCadError:
        return to_mesh_shape(mesh)
