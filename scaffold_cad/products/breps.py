"""to_brep(): B-reps of scaffolds, round struts and meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scaffold_cad import brep
from scaffold_cad.base.arguments import as_flag, check_kind, checks_keywords
from scaffold_cad.brep import Kind
from scaffold_cad.brep.analytic import AnalyticBrep
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1 import Patches, smooth_patches
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.products.facets import check_facets, facets_of
from scaffold_cad.products.overlaps import Overlaps, room_needed, to_unite
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.solid.mixed import mixed_brep
from scaffold_cad.solid.solid import to_solid
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.breps.faces import brep_of_struts

if TYPE_CHECKING:
    from build123d import Shape


@checks_keywords()
def to_brep(
    what: Scaffold | RoundStruts | QuadMesh | BezierMesh | Patches,
    kind: Kind = "solid",
    *,
    overlaps: Overlaps = "refuse",
    smooth: bool = False,
    split: int | None = None,
) -> Shape:
    """Return the B-rep of a scaffold, of round struts or of a mesh; neighbors share their edges.

    Parameters
    ----------
    what : a scaffold or a quad mesh, one face per quad; round struts, a cylinder or a cone per
        strut and four patches per strut at each node. Meshes of solids are closed and outward; in
        those of shells neighboring quads must agree in direction
    kind : "solid" or "shell"
    overlaps : what becomes of struts that overlap: "refuse" them, "unite" them, with plane
        triangles as faces where round struts overlap and instead of all square ones, or "allow"
        faces that cross
    smooth : whether the faces of a quad mesh are patches that join with one tangent plane, see
        `smooth_patches`, instead of planes and bilinear patches
    split : of `smooth_patches`, with `smooth` only

    Returns
    -------
    build123d Solid or Shell, or a Compound of them if the surface is not connected. The faces of
    scaffolds and meshes are in the order of their quads.

    Raises
    ------
    MeshError
        If the mesh is not closed (solids), not oriented, or inside out (solids).
    BrepError
        If struts overlap and are refused, or an edge or a quad is smaller than the tolerance of CAD
        systems, or a union has too many facets.
    OptionError
        If `what` is of another kind, or an option does not fit it.
    MissingBackendError
        If build123d is not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> [round(face.area, 3) for face in to_brep(round_struts(strut)).faces()]
    [3.142, 3.142, 56.549]
    """
    check_kind(what, Scaffold, RoundStruts, QuadMesh, BezierMesh, Patches)
    if as_flag(smooth, "smooth") and not isinstance(what, QuadMesh):
        raise OptionError(
            "smooth=True is for a QuadMesh; need round_struts(skeleton) for round struts"
        )
    if split is not None and not smooth:
        raise OptionError("split is for smooth=True; need it too, or split left out")
    if isinstance(what, RoundStruts):
        return brep.brep_of_faces(faces_of_struts(what, overlaps), kind)
    if isinstance(what, Scaffold):
        if to_unite(overlaps, what.embedding().left_out, what.skeleton):
            return brep.brep_of_faces(union_of_scaffold(what), kind)
        what = what.mesh
    if smooth and isinstance(what, QuadMesh):
        what = smooth_patches(what, split=split)
    return brep.brep_of_patches(what.bezier if isinstance(what, Patches) else what, kind)


def union_of_scaffold(scaffold: Scaffold) -> AnalyticBrep:
    """Return the union of square struts, each triangle a plane face.

    Raises
    ------
    BrepError
        If it has too many triangles, or one without area.
    """
    return facets_of(manifold_triangles(to_solid(scaffold)))


def faces_of_struts(struts: RoundStruts, overlaps: Overlaps) -> AnalyticBrep:
    """Return the faces of round struts as arrays, checked to be closed.

    Raises
    ------
    BrepError
        If struts overlap and are refused, or an edge is too short for CAD systems, or crowded
        struts have too many facets.
    """
    if to_unite(overlaps, struts.overlapping, struts.skeleton, room_needed(struts)):
        faces = mixed_brep(struts)
        check_facets(faces)
    else:
        faces = brep_of_struts(struts)
    faces.check_closed()
    return faces
