"""Parts that a body cuts out of struts, made clean: without crossings, slivers or loose crumbs."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints, place_text
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.collapse import without_short_edges
from scaffold_cad.mesh.pieces import Pieces, pieces_of, without_bodies, without_pieces
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.overlaps import to_unite
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import clean_surface, manifolds

if TYPE_CHECKING:
    from manifold3d import Manifold

NUDGES = (0.0, 1e-3, -1e-3, 3e-3, -3e-3)
"""How far the lattice is moved, in turn, until the part does not cross itself; in cell sizes.
Faces of struts that lie in faces of the part are hard to unite. The first that works is taken."""

SLIVER = 2.0**-20
"""Height below which triangles go, in greatest coordinates: a few roundings to 32 bits.
The boolean leaves such slivers where it cuts the triangles of the body, and files lose them."""

CRUMB = 0.01
"""Volume below which a loose piece is a crumb, in that of the largest piece."""

NUDGE_DIRECTION = np.array([0.6, 0.5, 0.62])
"""Where the lattice is moved: along no face of a cell."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Attempt:
    """A part that may cross itself, as struts cut by a body can."""

    part: Manifold
    """The part."""
    struts: Skeleton
    """The struts in it."""
    united_edges: Ints
    """Those that went through the union, ascending."""


def first_clean(
    what: str, made: Callable[[float], Attempt], nudges: Sequence[float], extent: float
) -> Manifold:
    """Return the first part that does not cross itself.

    Parameters
    ----------
    what : what messages call it
    made : makes it with the lattice moved so far, in cell sizes
    nudges : the ways to move it, in turn
    extent : greatest coordinate of the part, mm

    Raises
    ------
    MeshError
        If all of them cross themselves; the last fault is named.
    """
    fault = ""
    for nudge in nudges:
        attempt = made(nudge)
        try:
            whole = manifolds.to_manifold(clean_surface(_without_slivers(attempt.part, extent)))
        except MeshError as error:
            fault = _with_place(error)
        else:
            to_unite("unite", attempt.united_edges, attempt.struts)
            return whole
        _log.debug("with the lattice moved by %g cells the %s %s", nudge, what, fault)
    raise MeshError(f"the {what} {fault}, however the lattice is moved; need a clean surface there")


def without_crumbs(part: Manifold) -> Manifold:
    """Return the part without pieces that are small beside the largest; the log counts them."""
    mesh = manifolds.manifold_triangles(part)
    pieces = pieces_of(mesh)
    volumes = pieces.volumes
    crumbs = (volumes > 0) & (volumes < CRUMB * volumes.max(initial=0.0))
    if not crumbs.any():
        return part
    _log.info(
        "%s of %.3g mm³ left out, as at %s: cut off by the surface",
        counted(int(crumbs.sum()), "loose crumb"),
        float(volumes[crumbs].sum()),
        _place_of(mesh, pieces, crumbs),
    )
    return manifolds.to_manifold(without_bodies(mesh, pieces, crumbs))


def without_pockets(part: Manifold, width: float) -> Manifold:
    """Return the part without voids smaller than a ball `width` mm wide; the log counts them.

    Struts enclose such pockets where they meet a skin.
    """
    mesh = manifolds.manifold_triangles(part)
    pieces = pieces_of(mesh)
    volumes = pieces.volumes
    pockets = (volumes < 0) & (volumes > -np.pi / 6 * width**3)
    if not pockets.any():
        return part
    _log.info(
        "%s of %.3g mm³ filled, as at %s: smaller than a ball of %g mm",
        counted(int(pockets.sum()), "closed pocket"),
        float(-volumes[pockets].sum()),
        _place_of(mesh, pieces, pockets),
        width,
    )
    return manifolds.to_manifold(without_pieces(mesh, pieces, pockets))


def _place_of(mesh: TriangleMesh, pieces: Pieces, marked: Bools) -> str:
    """Return a place of the first piece marked in (p,)."""
    return place_text(mesh.vertices[np.argmax(marked[pieces.piece_of])])


def _with_place(error: MeshError) -> str:
    """Return what is wrong, and where if that is known."""
    places = getattr(error, "places", np.zeros((0, 3)))
    where = f" near {place_text(places[0])}" if len(places) else ""
    return f"{error}{where}"


def _without_slivers(part: Manifold, extent: float) -> Manifold:
    """Return the part without triangles that 32-bit coordinates up to `extent` cannot hold."""
    height = SLIVER * extent
    short = without_short_edges(manifolds.manifold_triangles(part), height)
    # Made again: of a boolean's result manifold3d keeps the slivers between the operands.
    return manifolds.to_manifold(short).simplify(height)
