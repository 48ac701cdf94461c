"""Parts filled with a lattice or with other struts, with or without a closed skin."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import checks_keywords
from scaffold_cad.base.placements import AxesLike, PositionLike
from scaffold_cad.base.radii import Radius
from scaffold_cad.errors import OptionError
from scaffold_cad.filling.cleaning import (
    NUDGES,
    Attempt,
    first_clean,
    without_crumbs,
    without_pockets,
)
from scaffold_cad.filling.drains import drained
from scaffold_cad.filling.fill import as_region
from scaffold_cad.filling.hollowing import Body, HollowPart, hollowed
from scaffold_cad.filling.innercell import FULL
from scaffold_cad.filling.models import RoundOptions, Section, sided_maker, sides_of
from scaffold_cad.filling.reaching import (
    Reaching,
    lattice_reaching,
    skeleton_reaching,
)
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.products.models import Make
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import solidified
from scaffold_cad.struts import round_struts

if TYPE_CHECKING:
    from manifold3d import Manifold
    from typing_extensions import Unpack

_log = logging.getLogger(__name__)


@checks_keywords(round_struts)
def lattice_part(
    body: Body,
    cell: str | UnitCell,
    size: CellSize,
    radius: Radius,
    *,
    skin: float | None = None,
    section: Section | None = None,
    sides: int | None = None,
    drain: float | None = None,
    drain_places: ArrayLike | None = None,
    origin: PositionLike | None = None,
    axes: AxesLike | None = None,
    on: CellMap | None = None,
    **options: Unpack[RoundOptions],
) -> Manifold:
    """Return `body` with a lattice for its inside: one watertight solid.

    The lattice goes on beyond the body, whose surface cuts it flush; crumbs that hang loose then
    are left out. With a skin the part is closed: what is left between the struts is a void, and
    powder or resin in it needs a hole to get out. Parts of the body that overlap are united, shells
    that are inside out are turned; the log says so.

    Parameters
    ----------
    body : a build123d solid, or a closed triangle mesh, anything with arrays `vertices` and
        `faces` or `triangles`, counter-clockwise seen from outside
    cell, size, radius, origin, axes, on : as for `fill`
    skin : thickness of the closed wall at the body's surface, mm; none by default. Where the body
        is more tightly curved than that, making it takes some 3 ms per triangle
    section : of the struts, "square" or "round"; by default as `sides` say, else square, while
        those of `lattice_solid` are round
    sides : of the struts: 4 for square ones, 8 or another multiple of 4 for round ones; by default
        16 where the section is round
    drain : diameter of holes through the skin, mm, for powder and resin to get out; none by
        default
    drain_places : where the holes are, on or near the surface, (k, 3), mm; by default two for each
        void, one low and one high along z, where struts leave most room
    **options : those of `round_struts`, for round ones

    Raises
    ------
    OptionError
        If an argument is out of its range.
    MeshError
        If the body is not closed or crosses itself, has too many triangles for the skin where it is
        tightly curved, a void stays closed that is to be drained, or the part crosses itself
        wherever the lattice is put; places are named.
    SkeletonError
        If no strut is in the body.

    Examples
    --------
    >>> from scaffold_cad import TriangleMesh, lattice_part
    >>> corners = [[x, y, z] for z in (0, 8) for y in (0, 8) for x in (0, 8)]
    >>> sides = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4]]
    >>> sides += [[2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
    >>> part = lattice_part(TriangleMesh(corners, sides), "bcc", 8.0, radius=0.5, skin=1.0)
    >>> 8**3 - 6**3 < part.volume() < 8**3
    True
    """
    hollow, make, sides = _prepared(body, skin, section, sides, drain, drain_places, options)
    region = as_region(hollow.surface)
    reaching = lattice_reaching(region, cell, size, radius, skin, origin=origin, axes=axes, on=on)
    return filled_part(hollow, reaching, make, sides=sides, drain_places=drain_places)


@checks_keywords(round_struts)
def strut_part(
    body: Body,
    struts: Skeleton,
    *,
    skin: float | None = None,
    section: Section | None = None,
    sides: int | None = None,
    drain: float | None = None,
    drain_places: ArrayLike | None = None,
    **options: Unpack[RoundOptions],
) -> Manifold:
    """Return `body` with struts for its inside, such as a foam or your own: one watertight solid.

    Those that have a part in the body are cut where they leave it: they are best made larger than
    it, and rods right through it stay. The rest is as for `lattice_part`.

    Parameters
    ----------
    struts : where the body is
    body, skin, section, sides, drain, drain_places, **options : as for `lattice_part`

    Raises
    ------
    OptionError, MeshError
        As `lattice_part` does.
    SkeletonError
        If no strut is in the body.

    Examples
    --------
    >>> import trimesh
    >>> from scaffold_cad import strut_part, voronoi_foam
    >>> foam = voronoi_foam(None, [[-15] * 3, [15] * 3], 0.6, size=6, regularity=0.6)
    >>> part = strut_part(trimesh.creation.icosphere(3, 10), foam, skin=1.0)
    >>> [round(side) for side in part.bounding_box()]
    [-10, -10, -10, 10, 10, 10]
    """
    hollow, make, sides = _prepared(body, skin, section, sides, drain, drain_places, options)
    reaching = skeleton_reaching(as_region(hollow.surface), struts, skin)
    return filled_part(hollow, reaching, make, sides=sides, drain_places=drain_places)


def _prepared(
    body: Body,
    skin: float | None,
    section: Section | None,
    sides: int | None,
    drain: float | None,
    drain_places: ArrayLike | None,
    options: RoundOptions,
) -> tuple[HollowPart, Make, int]:
    """Return the body with its skin, what makes its struts, and how many sides these have."""
    sides = sides_of(section, sides)
    make = sided_maker(sides, **options)
    if drain is None and drain_places is not None:
        raise OptionError("drain_places are given without drain, their diameter; need it")
    return hollowed(body, skin, drain=drain), make, sides


def filled_part(
    hollow: HollowPart,
    struts: Reaching,
    make: Make,
    *,
    sides: int,
    drain_places: ArrayLike | None = None,
) -> Manifold:
    """Return a body with struts for its inside, whose skin is made already; see `lattice_part`."""
    skin, outer, inner = hollow.skin, hollow.outer, hollow.inner
    extent = float(np.abs(hollow.surface.vertices).max())

    def made(nudge: float) -> Attempt:
        reaching = struts(nudge)
        solid = solidified(make(reaching), sides=None if sides == 4 else sides)
        lattice = solid.manifold
        if skin is None:
            return Attempt(lattice ^ outer, reaching, solid.united_edges)
        closed = outer - (inner - lattice)
        part = without_pockets(closed, max(skin, hollow.drain or 0.0))
        if hollow.drain is not None:
            _check_drain(hollow.drain, closed, part)
            part = drained(part, hollow.surface, skin, hollow.drain, drain_places)
        return Attempt(part, reaching, solid.united_edges)

    whole = first_clean("part", made, NUDGES, extent)
    _report_full(whole, outer)
    return whole if skin is not None else without_crumbs(whole)


def _check_drain(drain: float, closed: Manifold, part: Manifold) -> None:
    """Raise an `OptionError` if all voids are pockets to holes so wide, which are filled."""
    before, after = (min(piece.volume() for piece in each.decompose()) for each in (closed, part))
    if before < 0 <= after:
        width = (6 / np.pi * -before) ** (1 / 3)
        raise OptionError(
            f"drain holes of {drain:g} mm are wider than all voids: the largest is as a ball of "
            f"{width:.3g} mm; need narrower ones"
        )


def _report_full(part: Manifold, outer: Manifold) -> None:
    """Log if the struts leave next to nothing of the body free."""
    share = part.volume() / outer.volume()
    if share > FULL:
        _log.warning(
            "the struts fill the body: %.1f %% of its volume are solid; they are too thick for "
            "their cells",
            100 * share,
        )
