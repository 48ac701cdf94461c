"""The solid of a scaffold: its mesh where it is embedded, a union of pieces where it is not."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING

from scaffold_cad import manifolds
from scaffold_cad.arrays import Ints
from scaffold_cad.embedding import Embedding
from scaffold_cad.errors import MeshError
from scaffold_cad.intersections import self_intersections
from scaffold_cad.pieces import solid_pieces
from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold
from scaffold_cad.trianglemesh import TriangleMesh

if TYPE_CHECKING:
    from manifold3d import Manifold

WOBBLES = (0.0, 1e-3, -1e-3, 3e-3, -3e-3, 0.01, -0.01)
"""How unlike each other the prisms of overlapping struts are made, in turn, until their union
does not cross itself; relative to their radius. The first that works is taken."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Solidified:
    """A watertight solid that does not cross itself, and how it was made."""

    manifold: Manifold
    """The solid."""
    united_edges: Ints
    """Skeleton edges whose struts went through the union, ascending; all others are as built."""
    filled_voids: list[float]
    """Volume of each void that overlapping struts enclosed, mm³; they are filled."""


def to_solid(what: Scaffold | QuadMesh | TriangleMesh) -> Manifold:
    """Return `what` as a watertight manifold3d solid.

    A scaffold's mesh is taken as it is where `Scaffold.embedding` certifies it, and the struts
    that it does not certify go through a union: `solidified` tells which. A bare mesh is taken as
    it is: where two parts of it cross, they still cross in the solid.

    Raises
    ------
    MeshError
        If a bare mesh is not closed or not outward.
    MissingBackendError
        If manifold3d is not installed.
    """
    return solidified(what).manifold if isinstance(what, Scaffold) else manifolds.to_manifold(what)


def solidified(scaffold: Scaffold) -> Solidified:
    """Return the watertight solid of `scaffold`, and which of its struts were united.

    Raises
    ------
    MeshError
        If every union tried crosses itself.
    """
    embedded = scaffold.embedding()
    if embedded.certified:
        return Solidified(manifolds.to_manifold(scaffold.mesh), embedded.left_out, [])
    crossings = 0
    for wobble in WOBBLES:
        manifold, voids = _united(scaffold, embedded, wobble)
        crossings = len(self_intersections(manifolds.manifold_triangles(manifold)))
        if crossings == 0:
            return Solidified(manifold, embedded.left_out, voids)
        _log.debug("%d crossings left in the union with a wobble of %g", crossings, wobble)
    raise MeshError(
        f"the union of {len(embedded.left_out)} overlapping struts still crosses itself "
        f"in {crossings} places; need 0 (try other radii)"
    )


def _united(scaffold: Scaffold, embedded: Embedding, wobble: float) -> tuple[Manifold, list[float]]:
    """Return the union of the pieces of a scaffold, and the volumes of the voids filled."""
    pieces = solid_pieces(scaffold, embedded, wobble)
    surfaces = [pieces.surface] if len(pieces.surface.triangles) else []
    return manifolds.without_voids(manifolds.union([*surfaces, *pieces.spheres], pieces.hulls))
