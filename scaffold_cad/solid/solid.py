"""The solid of a scaffold or of round struts: the mesh where proved, unions or fields elsewhere.

The union is the fallback: where struts overlap, manifold3d unites convex pieces of them.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad import brep
from scaffold_cad.base.arguments import as_number, check_kind, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points
from scaffold_cad.base.backends import is_instance
from scaffold_cad.base.builders import built
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import length
from scaffold_cad.base.visibility import SINGLE_ROUNDING, rounding_of
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.pieces import pieces_of, without_voids
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.scaffold.embedding import Embedding, embedding
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.checking import check_single_precision
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.cleaning import FaultySurfaceError, clean_surface
from scaffold_cad.solid.clusters.fineness import Fineness
from scaffold_cad.solid.clusters.surface import field_of
from scaffold_cad.solid.field.nets import skeleton_struts
from scaffold_cad.solid.field.written import report_thickened
from scaffold_cad.solid.pieces import solid_pieces
from scaffold_cad.solid.rounds import SIDES, round_mesh
from scaffold_cad.struts import RoundStruts

if TYPE_CHECKING:
    from build123d import Builder, Shape
    from manifold3d import Manifold

WOBBLES = np.array([0.0, 1e-3, -3e-3, 0.01, -0.03])
"""Relative changes of radius that overlapping square struts and their nodes are given, in turn,
where their union crosses itself. The first that works is taken; where none does, struts are round
in the solid."""

EQUAL_AREA = float(np.sqrt(2.0 / np.pi))
"""Radius of the circle of the same area as a square, in distances of its corners."""

NEAR_FAULT = 3.0
"""How far from a fault of a union struts are changed, in their radii."""

MOST_CHANGE = 0.1
"""Largest relative change of a union's volume by what 32-bit coordinates cannot hold of it."""

_log = logging.getLogger(__name__)


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Solidified(Frozen, Shown):
    """A watertight solid that does not cross itself, and how it was made."""

    manifold: Manifold
    """The solid."""
    united_edges: Ints
    """Skeleton edges whose struts went through the union, ascending; all others are as built."""
    filled_voids: list[float]
    """Volume of each void that overlapping square struts enclosed, mm³; they are filled, and those
    between round struts too."""

    def __str__(self) -> str:
        triangles = counted(self.manifold.num_tri(), "triangle")
        united = counted(len(self.united_edges), "strut")
        return f"Solidified: {triangles}, {self.manifold.volume():g} mm³, {united} united"


@checks_keywords()
def to_solid(
    what: Scaffold | RoundStruts | QuadMesh | TriangleMesh | Shape | Builder,
    *,
    sides: int | None = None,
) -> Manifold:
    """Return `what` as a watertight manifold3d solid, for booleans with others.

    Struts that are proved to stay apart keep their mesh, and struts that overlap are united:
    `solidified` tells which. A bare mesh is taken as it is: where two parts of it cross, they still
    cross in the solid.

    Parameters
    ----------
    what : or a solid of build123d, or a builder's, whose faces get triangles as `write` has them
    sides : of round struts, see `solidified`

    Raises
    ------
    MeshError
        If a bare mesh is not closed or not outward, or a shape is none of solids.
    OptionError
        If `what` is of another kind, or `sides` is given for anything but round struts.
    MissingBackendError
        If manifold3d is not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round(to_solid(build_scaffold(strut)).volume(), 6)
    36.0
    """
    what = built(what)
    if is_instance(what, "build123d", "Shape"):
        what = brep.tessellated(_solid_shape(what))
    check_kind(what, Scaffold, RoundStruts, QuadMesh, TriangleMesh, "build123d solid")
    if isinstance(what, Scaffold | RoundStruts):
        return solidified(what, sides=sides).manifold
    if sides is not None:
        raise OptionError("sides is for round struts; need round_struts(skeleton)")
    return manifolds.to_manifold(what)


def _solid_shape(shape: Shape) -> Shape:
    if not shape.solids():
        raise MeshError(
            f"the {type(shape).__name__} holds no solid; need one (thicken makes one of a face)"
        )
    return shape


@checks_keywords()
def solidified(
    what: Scaffold | RoundStruts, *, sides: int | None = None, factor: float = 1.0
) -> Solidified:
    """Return the watertight solid of a scaffold or of round struts, and which struts were united.

    Parameters
    ----------
    sides : of the polygons that stand for the circles of round struts, a multiple of 4; 16 by
        default. They have the circles' area
    factor : what lengths are multiplied with in a file: the solid is free of crossings in the
        32-bit numbers that it has there

    Raises
    ------
    OptionError
        If `what` is of another kind, or `sides` does not fit it.
    MeshError
        If struts are too thin for 32-bit coordinates so far from the origin.

    Notes
    -----
    Where struts of a scaffold are so thin or so close that 32-bit coordinates do not hold any union
    of theirs, the solid has round struts of the same section, made as a field; that is logged.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, round_struts
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round(solidified(round_struts(strut), sides=8).manifold.volume(), 3)
    28.274
    """
    check_kind(what, Scaffold, RoundStruts)
    factor = as_number(factor, "factor", unit="")
    if isinstance(what, RoundStruts):
        mesh = round_mesh(what, SIDES if sides is None else sides, factor)
        return Solidified(manifolds.to_manifold(mesh), what.overlapping, [])
    if sides is not None:
        raise OptionError(
            f"sides is {sides} for a Scaffold, whose struts are square; need round_struts(skeleton)"
        )
    return _square_solid(what, factor)


def _square_solid(scaffold: Scaffold, factor: float) -> Solidified:
    embedded = embedding_as_written(scaffold, factor)
    if embedded.certified:
        return Solidified(manifolds.to_manifold(scaffold.mesh), embedded.left_out, [])
    check_single_precision(scaffold.skeleton)

    def united(wobble: Floats) -> Manifold:
        pieces = solid_pieces(scaffold, embedded, wobble)
        closed = [manifolds.of_closed(mesh) for mesh in (*pieces.surfaces, *pieces.spheres)]
        return manifolds.union(closed, pieces.hulls)

    made = _clean_union(united, scaffold.skeleton, embedded.left_out, factor)
    return _round_instead(scaffold, factor) if made is None else made


def embedding_as_written(scaffold: Scaffold, factor: float) -> Embedding:
    """Return which struts stay apart, of a whole scaffold in 32-bit coordinates too."""
    found = scaffold.embedding()
    vertices = scaffold.mesh.vertices
    if not found.certified or found.room >= rounding_of(vertices, SINGLE_ROUNDING):
        return found
    rounded = in_single_precision(vertices, factor) / factor
    return embedding(replace(scaffold, mesh=scaffold.mesh.moved(rounded)))


def _round_instead(scaffold: Scaffold, factor: float) -> Solidified:
    """Return the solid with round struts of the same section as the square ones, as a field.

    It is closed and free of crossings wherever it is.
    """
    refined = scaffold.refined  # with collars, beyond which struts have their own radius
    radii = EQUAL_AREA * scaffold.options.corner_distance * refined.radii
    struts = skeleton_struts(refined.with_radii(radii), blend=0.0, flat_ends=True)
    report_thickened(struts, factor)
    mesh, voids = without_voids(field_of(struts, SIDES, Fineness(SIDES), factor), struts.middles)
    return Solidified(manifolds.to_manifold(mesh), np.arange(len(scaffold.skeleton.edges)), voids)


def _clean_union(
    united: Callable[[Floats], Manifold], skeleton: Skeleton, edges: Ints, factor: float
) -> Solidified | None:
    """Return the first union without a fault, its voids filled, or None.

    Struts near a fault are built again and all others stay as they were, so that nothing changes
    where all is well: with thousands of struts no attempt would be without any fault.

    Parameters
    ----------
    united : gives the union for a wobble of the struts at each node, shape (n,)
    edges : whose struts are united
    factor : see `solidified`
    """
    tries = np.zeros(len(skeleton.nodes), dtype=np.intp)
    while tries.max() < len(WOBBLES):
        try:
            mesh, voids = _cleaned(united(WOBBLES[tries]), skeleton.component_count, factor)
        except FaultySurfaceError as fault:
            _log.debug("the union of %d struts %s", len(edges), fault)
            told = str(fault)
            tries[_nodes_near(fault.places / factor, skeleton, edges)] += 1
            continue
        if len(mesh.triangles):
            return Solidified(manifolds.to_manifold(mesh), edges, voids)
        told = "is turned inside out"
        break
    _log.warning(
        "the union of %d overlapping struts %s as 32-bit coordinates hold it: "
        "all struts are round in the solid, of the same section",
        len(edges),
        told,
    )
    return None


def _cleaned(
    manifold: Manifold, components: int, factor: float
) -> tuple[TriangleMesh, list[float]]:
    """Return the surface of a union as files hold it, and the volumes of voids filled, mm³.

    Parameters
    ----------
    components : of the skeleton: most bodies that the union may have

    Raises
    ------
    FaultySurfaceError
        If it has a fault or more bodies; its places are in the lengths of the file.
    """
    surface = clean_surface(manifold, factor)
    whole = TriangleMesh(surface.vertices / factor, surface.triangles)
    share = whole.signed_volume / manifold.volume()
    if abs(share - 1.0) > MOST_CHANGE:
        raise FaultySurfaceError(f"has {share:.0%} of its volume", np.empty((0, 3)))
    mesh, voids = without_voids(whole)
    pieces = pieces_of(mesh)
    extra = np.argsort(-pieces.volumes)[components:]
    extra = extra[pieces.volumes[extra] > 0]
    if len(extra) == 0:
        return mesh, voids
    places = [mesh.vertices[pieces.piece_of == piece].mean(axis=0) for piece in extra]
    bodies = counted(components + len(extra), "body", "bodies")
    message = f"comes apart in {bodies} where the skeleton has {components}"
    raise FaultySurfaceError(message, factor * np.asarray(places))


def _nodes_near(places: Points, skeleton: Skeleton, edges: Ints) -> Ints:
    """Return the ends of those of `edges` whose struts are near one of `places` (k, 3).

    All of them if there are no places, or none of them is near.
    """
    ends = skeleton.edges[edges]
    start, end = (skeleton.nodes[ends[:, side]] for side in (0, 1))
    reach = NEAR_FAULT * skeleton.radii[ends].max(axis=1)
    near = np.zeros(len(edges), dtype=np.bool_)
    for place in places:
        here = np.broadcast_to(place, start.shape)
        _, nearest = nearest_on_segments(here, here, start, end)
        near |= length(nearest - here) < reach
    return np.unique(ends[near] if near.any() else ends)
