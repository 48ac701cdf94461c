"""The solid of a scaffold: its mesh where it is embedded, a union of pieces where it is not."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arguments import check_kind, checks_keywords
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.collapse import without_short_edges
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import manifolds
from scaffold_cad.solid.pieces import solid_pieces
from scaffold_cad.solid.roundstruts import check_sides, prisms_and_balls, round_surface

if TYPE_CHECKING:
    from manifold3d import Manifold

WOBBLES = np.array([0.0, 1e-3, -1e-3, 3e-3, -3e-3, 0.01, -0.01, 0.02, -0.02, 0.03, -0.03])
"""Relative perturbations of the radii of the prisms of overlapping struts, tried in turn where
their union crosses itself. The first that works is used: the fallback of struts that overlap."""

NEAR_FAULT = 3.0
"""Distance from a fault of a union within which struts are perturbed, in their radii."""

SINGLE_PRECISION = 2.0**-22
"""Least length of an edge after a union, in greatest coordinates: a few roundings to 32 bits."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Solidified(Frozen, Shown):
    """A watertight solid that does not cross itself, and how it was made.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, solidified
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> solid = solidified(build_scaffold(strut))
    >>> len(solid.united_edges), solid.filled_voids
    (0, [])
    """

    manifold: Manifold
    """The solid."""
    united_edges: Ints
    """Skeleton edges whose struts went through the union, ascending; all others are as built."""
    filled_voids: list[float]
    """Volume of each void that overlapping struts enclosed, mm³; they are filled."""


@checks_keywords()
def to_solid(what: Scaffold | QuadMesh | TriangleMesh, *, sides: int = 4) -> Manifold:
    """Return `what` as a watertight manifold3d solid.

    A scaffold's mesh is taken as it is where `Scaffold.embedding` certifies it, and the struts
    that it does not certify go through a union: `solidified` lists them. A bare mesh is taken as
    it is: where two parts of it cross, they still cross in the solid.

    Parameters
    ----------
    sides : of a scaffold's struts, see `solidified`

    Raises
    ------
    MeshError
        If a bare mesh is not closed or not outward.
    OptionError
        If `what` is of another type, `sides` is not 4, 8 or 16, or not 4 for a bare mesh.
    MissingBackendError
        If manifold3d is not installed.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, to_solid
    >>> strut = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
    >>> round(to_solid(build_scaffold(strut)).volume(), 6)
    36.0
    """
    check_kind(what, Scaffold, QuadMesh, TriangleMesh)
    if isinstance(what, Scaffold):
        return solidified(what, sides=sides).manifold
    if sides != 4:
        raise OptionError(f"a bare mesh has no struts to give {sides} sides; need a Scaffold")
    return manifolds.to_manifold(what)


@checks_keywords()
def solidified(scaffold: Scaffold, *, sides: int = 4) -> Solidified:
    """Return the watertight solid of `scaffold`, and which of its struts were united.

    Parameters
    ----------
    sides : of the struts: 4 for the scaffold itself; 8 or 16 for one or two Catmull-Clark
        subdivisions of it, whose sections have the area of the circle of the skeleton's radius

    Raises
    ------
    MeshError
        If every union tried crosses itself, or does not stay closed in 32-bit coordinates.
    OptionError
        If `scaffold` is none, or `sides` is not 4, 8 or 16.

    Examples
    --------
    >>> from scaffold_cad import Skeleton, build_scaffold, solidified
    >>> nodes = [[0, 0, 0], [9, 0, 0], [4, -5, 1], [4, 5, 1]]  # two struts that cross
    >>> crossing = Skeleton(nodes, [[0, 1], [2, 3]], 1.0)
    >>> solidified(build_scaffold(crossing)).united_edges
    array([0, 1])
    """
    check_kind(scaffold, Scaffold)
    check_sides(sides)
    return _square_solid(scaffold) if sides == 4 else _round_solid(scaffold, sides)


def _square_solid(scaffold: Scaffold) -> Solidified:
    embedded = scaffold.embedding()
    if embedded.certified:
        return Solidified(manifolds.to_manifold(scaffold.mesh), embedded.left_out, [])

    def united(wobble: Floats) -> Manifold:
        pieces = solid_pieces(scaffold, embedded, wobble)
        surfaces = [pieces.surface] if len(pieces.surface.triangles) else []
        return manifolds.union([*surfaces, *pieces.spheres], pieces.hulls)

    return _clean_union(united, scaffold.skeleton, embedded.left_out)


def _round_solid(scaffold: Scaffold, sides: int) -> Solidified:
    surface = round_surface(scaffold, sides)
    if surface.mesh is not None and len(surface.left_out) == 0:
        return Solidified(manifolds.to_manifold(surface.mesh), surface.left_out, [])
    surfaces = []
    if surface.mesh is not None:
        surfaces.append(TriangleMesh(surface.mesh.vertices, surface.mesh.triangles))

    def united(wobble: Floats) -> Manifold:
        hulls = prisms_and_balls(scaffold, surface.left_out, sides, wobble)
        return manifolds.union(surfaces, hulls)

    return _clean_union(united, scaffold.skeleton, surface.left_out)


def _clean_union(
    united: Callable[[Floats], Manifold], skeleton: Skeleton, edges: Ints
) -> Solidified:
    """Return the first union without a fault, its voids filled.

    Only struts near a fault are perturbed further: with thousands of struts, one perturbation of
    all would hardly ever be free of faults.

    Parameters
    ----------
    united : gives the union for a wobble of the struts at each node, shape (n,)
    edges : whose struts are united
    """
    tries = np.zeros(len(skeleton.nodes), dtype=np.intp)
    while True:
        filled, voids = manifolds.without_voids(united(WOBBLES[tries]))
        try:
            return Solidified(manifolds.to_manifold(clean_surface(filled)), edges, voids)
        except FaultySurfaceError as fault:
            tries[_nodes_near(fault.places, skeleton, edges)] += 1
            _log.debug("the union of %d struts %s", len(edges), fault)
            if tries.max() == len(WOBBLES):
                raise MeshError(
                    f"the union of {len(edges)} overlapping struts {fault}; need a clean surface "
                    "(try other radii)"
                ) from None


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


class FaultySurfaceError(MeshError):
    """A surface that is not that of a solid, and where."""

    def __init__(self, message: str, places: Points) -> None:
        super().__init__(message)
        self.places = places
        """Points near the faults, shape (k, 3), mm; k is 0 if they are not known."""


def clean_surface(manifold: Manifold) -> TriangleMesh:
    """Return the surface of a union without the edges that 32-bit coordinates cannot hold.

    They would be written with two ends at one place.

    Raises
    ------
    FaultySurfaceError
        If it crosses itself, or does not stay closed in 32-bit coordinates.
    """
    mesh = manifolds.manifold_triangles(manifold)
    extent = float(np.abs(mesh.vertices).max(initial=0.0))
    mesh = without_short_edges(mesh, SINGLE_PRECISION * extent)
    crossings = self_intersections(mesh)
    if len(crossings):
        places = mesh.vertices[mesh.triangles[crossings[:, 0]]].mean(axis=1)
        raise FaultySurfaceError(f"crosses itself in {len(crossings)} places", places)
    written = mesh.single_precision()
    try:
        written.check_closed()
    except MeshError as error:
        places = written.vertices[np.concatenate(written.faulty_sides())[:, 0]]
        message = f"does not stay closed in 32-bit coordinates: {error}"
        raise FaultySurfaceError(message, places) from None
    return mesh
