"""Boxes of struts that are cut flush with their faces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Floats, place_text
from scaffold_cad.base.placements import AxesLike, BoxLike
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import BoxRegion
from scaffold_cad.base.segments import meet_box
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling.cleaning import (
    NUDGE_DIRECTION,
    NUDGES,
    Attempt,
    first_clean,
    without_crumbs,
)
from scaffold_cad.filling.fill import fill
from scaffold_cad.filling.models import RoundOptions, Section, sided_maker, sides_of
from scaffold_cad.filling.reaching import REACH, Reaching, movable
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.models import Make
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import manifolds, solidified

if TYPE_CHECKING:
    from manifold3d import Manifold
    from typing_extensions import Unpack


def flush_box(
    box: BoxLike,
    cell: str | UnitCell,
    size: CellSize,
    radius: Radius,
    *,
    axes: AxesLike | None = None,
    on: CellMap | None = None,
    section: Section | None = None,
    sides: int | None = None,
    **options: Unpack[RoundOptions],
) -> Manifold:
    """Return a box of lattice whose struts are cut flush with its faces: it measures as the box.

    Parameters
    ----------
    box : lowest and highest corner, mm
    cell, size, radius, axes, on : as for `fill`
    section, sides : of the struts, as for `lattice_part`
    **options : those of `round_struts`, for round ones

    Raises
    ------
    OptionError
        If an argument is out of its range.
    MeshError
        If the cut struts cross themselves, whatever way they are moved by 1/300 of a cell.
    SkeletonError
        If no strut is in the box.

    Examples
    --------
    >>> from scaffold_cad.filling.flush import flush_box
    >>> [round(side, 6) for side in flush_box([[0] * 3, [30, 20, 20]], "bcc", 10, 1).bounding_box()]
    [0.0, 0.0, 0.0, 30.0, 20.0, 20.0]
    """
    sides = sides_of(section, sides)
    make = sided_maker(sides, **options)
    low, high = BoxRegion(box).bounds
    known = as_cell(cell)
    if on is not None:
        margin = float((high - low).max()) / 2
    elif callable(size):
        raise OptionError("the cell size is a function without a map; need one (on=BoxMap(...))")
    else:
        margin = float(cell_size(known, size).max())

    bounds = [low - margin, high + margin]

    if on is not None:
        return trimmed_box(box, movable(fill(bounds, known, size, radius, on=on)), make, sides)

    def reaching(nudge: float) -> Skeleton:
        origin = low + nudge * margin * NUDGE_DIRECTION
        return fill(bounds, known, size, radius, origin=origin, axes=axes)

    return trimmed_box(box, reaching, make, sides)


def trimmed_box(box: BoxLike, struts: Reaching, make: Make, sides: int) -> Manifold:
    """Return struts that are cut flush with a box; see `flush_box`.

    Parameters
    ----------
    struts : those that reach into the box, and maybe others that have no part in the box
    """
    import manifold3d

    bounds = BoxRegion(box).bounds
    low, high = bounds

    def made(nudge: float) -> Attempt:
        whole = struts(nudge)
        start, end = whole.nodes[whole.edges].transpose(1, 0, 2)
        reach = REACH * float(whole.edge_radii.max())
        inside = meet_box(start, end, low - reach, high + reach)
        if not inside.any():
            raise SkeletonError(
                f"no strut is in the box from {place_text(low)} to {place_text(high)}; need one "
                "(smaller cells?)"
            )
        met = whole.with_edges(inside)
        solid = solidified(make(met), sides=None if sides == 4 else sides)
        cutter = manifold3d.Manifold.cube((high - low).tolist()).translate(low.tolist())
        return Attempt(solid.manifold ^ cutter, met, solid.united_edges)

    part = first_clean("box", made, NUDGES, float(np.abs(bounds).max()))
    return _on_faces(without_crumbs(part), bounds)


def _on_faces(part: Manifold, bounds: Floats) -> Manifold:
    """Return a part whose vertices are where a box's faces are, not where 32 bits put these."""
    mesh = manifolds.manifold_triangles(part)
    vertices = mesh.vertices
    for bound in bounds:
        vertices = np.where(vertices == bound.astype(np.float32), bound, vertices)
    return manifolds.to_manifold(TriangleMesh(vertices, mesh.triangles))
