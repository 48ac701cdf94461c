"""B-reps of scaffolds: coarse, one face a quad, or smooth, one G1 patch a quad."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scaffold_cad import brep
from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.brep import Kind
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.smooth import Caps, Patches, smooth_patches

if TYPE_CHECKING:
    from build123d import Shape


@checks_keywords()
def to_brep(
    what: Scaffold | QuadMesh | BezierMesh | Patches,
    kind: Kind = "solid",
    *,
    smooth: bool = False,
    caps: Caps | None = None,
    split: int | None = None,
) -> Shape:
    """Return the B-rep of a scaffold or a mesh: one face a quad, neighbors sharing their edges.

    Parameters
    ----------
    what : for solids closed and outward; for shells neighboring quads must agree in direction
    kind : "solid" or "shell"
    smooth : whether the faces are Bézier patches that join with one tangent plane, see
        `smooth_patches`, instead of planes and bilinear patches
    caps, split : of `smooth_patches`, with `smooth` only; caps are "round" by default

    Returns
    -------
    build123d Solid or Shell, or a Compound of them if the mesh is not connected. The faces of each
    are in the order of their quads.

    Raises
    ------
    MeshError
        If the mesh is not closed (solids), not oriented, or inside out (solids).
    BrepError
        If an edge or a quad is smaller than the tolerance of CAD systems.
    OptionError
        If `what` is of another type, `smooth` is asked of patches, `caps` or `split` without
        `smooth`, or an option has an unknown value.
    MissingBackendError
        If build123d is not installed.

    Notes
    -----
    Whether faces far from each other cross is not looked at: `Scaffold.embedding` and
    `crossing_struts` do, and the classes of `scaffold_cad.parts` by them.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, to_brep
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> solid = to_brep(build_scaffold(strut))
    >>> len(solid.faces()), round(solid.volume, 6)
    (6, 36.0)
    """
    check_kind(what, Scaffold, QuadMesh, BezierMesh, Patches)
    if smooth:
        if not isinstance(what, Scaffold | QuadMesh):
            raise OptionError("smooth is for a Scaffold or a QuadMesh; patches are what they are")
        what = smooth_patches(what, split=split, caps=caps or "round")
    elif caps is not None or split is not None:
        given = "split" if caps is None else "caps"
        raise OptionError(f"{given} is for smooth=True; need it too, or {given} left out")
    if isinstance(what, Scaffold):
        what = what.mesh
    return brep.brep_of_patches(what.bezier if isinstance(what, Patches) else what, kind)
