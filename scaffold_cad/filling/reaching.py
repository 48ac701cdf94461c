"""Struts that reach into a body: whole ones, which the body is to cut."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arguments import as_vector, check_kind
from scaffold_cad.base.arrays import Bools, Edges, Floats, place_text
from scaffold_cad.base.placements import AxesLike, PositionLike
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.regions import Region
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import SkeletonError
from scaffold_cad.filling.cleaning import NUDGE_DIRECTION
from scaffold_cad.filling.fill import struts_around
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.lattice.crumbs import report_small
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.skeleton import Skeleton

REACH = 1.5
"""How far from their axes struts have a part in a body, in their radii: a strut's own reaches 1
far, its fillets 1.5."""

SLANT = 2.0
"""How long a strut may be from the surface to a node that is within reach of it, in reaches: struts
are up to 60 degrees off the normal there."""

Reaching: TypeAlias = Callable[[float], Skeleton]
"""Returns the struts that have a part in a body, moved by a part of a cell, see `NUDGE_DIRECTION`.
"""


def lattice_reaching(
    region: Region,
    cell: str | UnitCell,
    size: CellSize,
    radius: Radius,
    skin: float | None,
    *,
    origin: PositionLike | None = None,
    axes: AxesLike | None = None,
    on: CellMap | None = None,
) -> Reaching:
    """Return the struts of a lattice around a body, with a node in the corner of its bounds.

    Parameters
    ----------
    cell, size, radius, origin, axes, on : as for `fill`
    skin : thickness of the body's wall, mm; None for none
    """
    known = as_cell(cell)
    low = region.bounds[0]
    corner = low if origin is None else as_vector(origin, "origin")
    if on is None and not callable(size):
        report_small(region.bounds, known, cell_size(known, size))

    def reaching(nudge: float) -> Skeleton:
        if on is not None or callable(size):
            whole = struts_around(region, known, size, origin=origin, axes=axes, on=on)
            whole = Struts(whole.nodes + offset(whole, nudge), whole.edges)
        else:
            shift = nudge * float(cell_size(known, size).min()) * NUDGE_DIRECTION
            whole = struts_around(region, known, size, origin=corner + shift, axes=axes)
        met = touching(region, whole, radius, skin, through=skin is not None)
        return whole.kept(met).skeleton(radius)

    return reaching


def skeleton_reaching(region: Region, struts: Skeleton, skin: float | None) -> Reaching:
    """Return those that reach into a body of struts that are there already."""
    check_kind(struts, Skeleton)
    whole = movable(struts)
    widest = float(struts.edge_radii.max()) if len(struts.edges) else 1.0

    def reaching(nudge: float) -> Skeleton:
        moved = whole(nudge)
        bare = Struts(moved.nodes, moved.edges)
        return moved.with_edges(touching(region, bare, widest, skin, through=True))

    return reaching


def movable(struts: Skeleton) -> Reaching:
    """Return all struts, moved by parts of their mean length."""
    return lambda nudge: struts.moved(struts.nodes + offset(struts, nudge))


def offset(struts: Struts | Skeleton, nudge: float) -> Floats:
    """Return how far struts are moved for a part of their mean length, (3,), mm."""
    start, end = struts.nodes[struts.edges].transpose(1, 0, 2)
    mean = float(length(end - start).mean()) if len(start) else 0.0
    return nudge * mean * NUDGE_DIRECTION


def touching(
    region: Region, struts: Struts, radius: Radius, skin: float | None, *, through: bool
) -> Bools:
    """Return which struts (m,) have a part in a body, or in what is inside its skin.

    Those outside count too whose nodes are so near that the surface cuts them: it cuts struts that
    go on.

    Parameters
    ----------
    through : whether those count of which the middle alone is in the body; without a skin these
        are loose pieces

    Raises
    ------
    SkeletonError
        If no strut has a part in it.
    """
    crossed, along = region.crossings(struts.nodes, struts.edges)
    away = np.stack([along, 1 - along], axis=1) * struts.lengths[crossed, None]  # (k, 2)
    met = struts.edges[crossed]  # (k, 2)
    reach = REACH * _radii(struts, met, radius) - (0.0 if skin is None else skin)
    near = np.zeros(len(struts.nodes), dtype=np.bool_)
    near[met[away < SLANT * reach]] = True
    found = np.asarray(near[struts.edges].any(axis=1))
    if through:
        found |= region.contains(struts.nodes[struts.edges].mean(axis=1))
        found[crossed[away.min(axis=1, initial=np.inf) > region.tolerance]] = True
    else:
        found |= region.contains(struts.nodes)[struts.edges].any(axis=1)
    if not found.any():
        low, high = region.bounds
        where = f"in the body from {place_text(low)} to {place_text(high)}"
        if len(crossed) and not through:
            count = len(np.unique(crossed))
            raise SkeletonError(
                f"no strut has a node {where}: the middles of {count} alone are, which would be "
                "loose; need nodes in it, or a skin"
            )
        raise SkeletonError(f"no strut is {where}; need one (smaller cells?)")
    return found


def _radii(struts: Struts, nodes: Edges, radius: Radius) -> Floats:
    """Return the radius at nodes (k, 2), shape (k, 2) or (), mm."""
    radii = radii_at(struts.nodes[nodes.reshape(-1)], radius)
    return radii.reshape(nodes.shape) if radii.ndim else radii
