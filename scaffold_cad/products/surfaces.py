"""The surface of whatever has one: what the package makes, and what other packages call a solid."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from scaffold_cad import brep
from scaffold_cad.base.arguments import check_kind, checks_keywords, described
from scaffold_cad.base.backends import is_instance, need
from scaffold_cad.base.builders import built
from scaffold_cad.base.kept import kept_last
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.brep.g1 import Patches
from scaffold_cad.errors import OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision import Subdivision
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.assembly import Assembly, assembly_solid
from scaffold_cad.products.breps import to_brep
from scaffold_cad.products.overlaps import Overlaps, to_unite
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.solid import Solidified, solidified
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.solid.rounds import SIDES, round_mesh
from scaffold_cad.solid.solid import embedding_as_written
from scaffold_cad.struts import RoundStruts
from scaffold_cad.struts.meshes.surface import triangulated
from scaffold_cad.struts.sharp.nodes import check_made

if TYPE_CHECKING:
    from trimesh import Trimesh


def surface_of(
    what: Any, *, overlaps: Overlaps = "unite", sides: int = SIDES, factor: float = 1.0
) -> QuadMesh | TriangleMesh | None:
    """Return the surface of `what`, as quads if it has any; None if it has no surface.

    Parameters
    ----------
    what : a mesh or a subdivision; a Scaffold, whose quads are taken as they are where they are
        one solid and whose overlapping struts are united elsewhere; a RoundStruts; an Assembly,
        whose beams and meshes are united; a manifold3d Manifold; a build123d shape, a builder's,
        or smooth patches, within 0.01 mm, large ones within 2e-5 of their diagonal, small ones
        1e-3; anything with arrays `vertices`, and `triangles` or `faces` (t, 3), such as a trimesh
        Trimesh
    overlaps : what becomes of struts that overlap, see `to_brep`; by default they are united
    sides : of the polygon that stands for the circle of a round strut, a multiple of 4
    factor : what lengths are multiplied with before they are written, see `solidified`

    Raises
    ------
    OptionError
        If it is a builder of build123d that holds no shape yet.
    BrepError
        If struts overlap and are refused.
    """
    what = built(what)
    if isinstance(what, QuadMesh | TriangleMesh):
        return what
    if isinstance(what, Subdivision):
        return what.mesh
    if isinstance(what, Scaffold):
        if to_unite(overlaps, embedding_as_written(what, factor).left_out, what.skeleton):
            return _united(what, factor)
        return what.mesh
    if isinstance(what, RoundStruts):
        if to_unite(overlaps, what.overlapping, what.skeleton) or overlaps != "allow":
            return _round(what, sides, factor)
        if what.options.is_sharp:
            check_made(what.runs, what.sharp)
        return triangulated(what, sides).mesh
    if isinstance(what, Assembly):
        return manifold_triangles(assembly_solid(what))
    if isinstance(what, Solidified):
        return manifold_triangles(what.manifold)
    if isinstance(what, BezierMesh | Patches):
        return brep.tessellated(to_brep(what))
    if is_instance(what, "manifold3d", "Manifold"):
        return manifold_triangles(what)
    if is_instance(what, "build123d", "Shape"):
        return brep.tessellated(what)
    triangles = getattr(what, "faces", None)  # of trimesh, whose `triangles` are positions
    if triangles is None:
        triangles = getattr(what, "triangles", None)
    vertices = getattr(what, "vertices", None)
    # Where they are methods, as of shapes of CAD packages, they are something else.
    if triangles is None or vertices is None or callable(triangles) or callable(vertices):
        return None
    return TriangleMesh(vertices, triangles)


@checks_keywords()
def to_trimesh(what: Any, *, sides: int | None = None) -> Trimesh:
    """Return the surface of `what` as a trimesh object: the triangles that `write` has of it.

    Every vertex is as it is: `process=False`, as welding close ones can break a closed mesh.

    Parameters
    ----------
    what : a Scaffold or RoundStruts, whose struts are united where they overlap; a QuadMesh, a
        TriangleMesh or a Solidified; a manifold3d Manifold; a build123d shape or a builder
    sides : of the polygons that stand for the circles of round struts, a multiple of 4; 16 by
        default

    Raises
    ------
    OptionError
        If it has no surface, or `sides` is given for anything but round struts.
    MissingBackendError
        If trimesh is not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts, to_trimesh
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> to_trimesh(round_struts(strut), sides=12).is_watertight
    True
    """
    if sides is not None and not isinstance(what, RoundStruts):
        raise OptionError("sides is for round struts; need round_struts(skeleton)")
    surface = surface_of(what, sides=SIDES if sides is None else sides)
    if surface is None:
        kinds = RoundStruts, Scaffold, QuadMesh, TriangleMesh
        check_kind(what, *kinds, "Manifold", "build123d shape")
    assert surface is not None
    need("trimesh", "a trimesh object")
    import trimesh

    return trimesh.Trimesh(surface.vertices, surface.triangles, process=False)


@kept_last
def _united(scaffold: Scaffold, factor: float) -> TriangleMesh:
    """Return the union of square struts; the next format that is written asks for it again."""
    return manifold_triangles(solidified(scaffold, factor=factor).manifold)


@kept_last
def _round(struts: RoundStruts, sides: int, factor: float) -> TriangleMesh:
    """Return the surface of round struts; the next format that is written asks for it again."""
    return round_mesh(struts, sides, factor)


def surface_error(what: Any) -> float:
    """Return how far `surface_of` a body may be off its faces, mm: 0 unless they are curved.

    Only that of build123d shapes is known; other surfaces are taken as they are.
    """
    what = built(what)
    return brep.tessellation_error(what) if is_instance(what, "build123d", "Shape") else 0.0


def triangles_of(what: Any, sides: int = SIDES) -> TriangleMesh:
    """Return the surface of `what` as triangles; sides: see `surface_of`.

    Raises
    ------
    OptionError
        If it has none.
    """
    mesh = surface_of(what, sides=sides)
    if mesh is None:
        raise OptionError(
            f"the body is {described(what)}; need a build123d solid, a manifold3d or trimesh "
            "one, a Scaffold, or a mesh with arrays of vertices and triangles"
        )
    return TriangleMesh(mesh.vertices, mesh.triangles) if isinstance(mesh, QuadMesh) else mesh
