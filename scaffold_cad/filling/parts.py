"""Parts filled with a lattice, with or without a closed skin around it."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, get_args

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import check_choice, checks_keywords
from scaffold_cad.base.arrays import Floats, as_floats, place_text
from scaffold_cad.base.radii import Radius
from scaffold_cad.base.regions import BoxRegion, Region
from scaffold_cad.base.segments import meet_box
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling.cleaning import (
    NUDGE_DIRECTION,
    NUDGES,
    Attempt,
    first_clean,
    without_crumbs,
)
from scaffold_cad.filling.drains import drained
from scaffold_cad.filling.fill import as_region, fill
from scaffold_cad.filling.hollowing import Body, HollowPart, hollowed
from scaffold_cad.filling.innercell import FULL
from scaffold_cad.filling.models import RoundOptions, Section, maker
from scaffold_cad.lattice import CellMap, UnitCell
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.models import Make
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import manifolds, solidified
from scaffold_cad.solid.rounds import SIDES, check_sides
from scaffold_cad.struts import round_struts

if TYPE_CHECKING:
    from manifold3d import Manifold
    from typing_extensions import Unpack

REACH = 1.5
"""How far from a box the axes of struts are that have a part in it, in their radii: a strut's own
reaches 1 far, its fillets 1.5."""

_log = logging.getLogger(__name__)


@checks_keywords(round_struts)
def lattice_part(
    body: Body,
    cell: str | UnitCell,
    size: ArrayLike,
    radius: Radius,
    *,
    skin: float | None = None,
    section: Section | None = None,
    sides: int | None = None,
    drain: float | None = None,
    drain_places: ArrayLike | None = None,
    **options: Unpack[RoundOptions],
) -> Manifold:
    """Return `body` with a lattice for its inside: one watertight solid.

    Struts are cut where they leave the body, and crumbs that hang loose then are left out. With a
    skin the part is closed: what is left between the struts is a void, and powder or resin in it
    needs a hole to get out. Parts of the body that overlap are united, shells that are inside out
    are turned; the log says so.

    Parameters
    ----------
    body : a build123d solid, or a closed triangle mesh, anything with arrays `vertices` and
        `faces` or `triangles`, counter-clockwise seen from outside
    cell : a unit cell or its name, see `cells`
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    radius : of the struts, mm; one number, or a function of positions (n, 3) that returns (n,)
    skin : thickness of the closed wall at the body's surface, mm; none by default. Where the body
        is more tightly curved than that, making it takes some 3 ms per triangle
    section : of the struts, "square" or "round"; by default as `sides` say, else square
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
    sides = _sides(section, sides)
    make = sided_maker(sides, **options)
    if drain is None and drain_places is not None:
        raise OptionError("drain_places are given without drain, their diameter; need it")
    hollow = hollowed(body, skin, drain=drain)
    return filled_part(hollow, cell, size, radius, make, sides=sides, drain_places=drain_places)


def filled_part(
    hollow: HollowPart,
    cell: str | UnitCell,
    size: ArrayLike,
    radius: Radius,
    make: Make,
    *,
    sides: int,
    drain_places: ArrayLike | None = None,
) -> Manifold:
    """Return what `lattice_part` makes of a body whose skin is made already."""
    region = as_region(hollow.surface)
    skin, outer, inner = hollow.skin, hollow.outer, hollow.inner
    extent = float(np.abs(hollow.surface.vertices).max())

    def made(nudge: float) -> Attempt:
        struts = _struts_touching(region, cell, size, radius, nudge, skin is not None)
        solid = solidified(make(struts), sides=None if sides == 4 else sides)
        lattice = solid.manifold
        part = lattice ^ outer if skin is None else outer - (inner - lattice)
        if skin is not None and hollow.drain is not None:
            part = drained(part, hollow.surface, skin, hollow.drain, drain_places)
        return Attempt(part, struts, solid.united_edges)

    whole = first_clean("part", made, NUDGES, extent)
    _report_full(whole, outer, radius)
    return whole if skin is not None else without_crumbs(whole)


def flush_box(
    box: ArrayLike,
    cell: str | UnitCell,
    size: CellSize,
    radius: Radius,
    *,
    axes: ArrayLike | None = None,
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
    >>> from scaffold_cad.filling.parts import flush_box
    >>> [round(side, 6) for side in flush_box([[0] * 3, [30, 20, 20]], "bcc", 10, 1).bounding_box()]
    [0.0, 0.0, 0.0, 30.0, 20.0, 20.0]
    """
    import manifold3d

    sides = _sides(section, sides)
    make = sided_maker(sides, **options)
    region = BoxRegion(box)
    low, high = region.bounds
    known = as_cell(cell)
    if on is not None:
        margin = float((high - low).max()) / 2
    elif callable(size):
        raise OptionError("the cell size is a function without a map; need one (on=BoxMap(...))")
    else:
        margin = float(cell_size(known, size).max())

    def made(nudge: float) -> Attempt:
        origin = None if on is not None else low + nudge * margin * NUDGE_DIRECTION
        around = [low - margin, high + margin]
        whole = fill(around, known, size, radius, origin=origin, axes=axes, on=on)
        start, end = whole.nodes[whole.edges].transpose(1, 0, 2)
        reach = REACH * float(whole.edge_radii.max())
        struts = whole.with_edges(meet_box(start, end, low - reach, high + reach))
        solid = solidified(make(struts), sides=None if sides == 4 else sides)
        cutter = manifold3d.Manifold.cube((high - low).tolist()).translate(low.tolist())
        return Attempt(solid.manifold ^ cutter, struts, solid.united_edges)

    nudges = NUDGES if on is None else NUDGES[:1]
    part = first_clean("box", made, nudges, float(np.abs(region.bounds).max()))
    return _on_faces(without_crumbs(part), region.bounds)


def _on_faces(part: Manifold, bounds: Floats) -> Manifold:
    """Return a part whose vertices are where a box's faces are, not where 32 bits put these."""
    mesh = manifolds.manifold_triangles(part)
    vertices = mesh.vertices
    for bound in bounds:
        vertices = np.where(vertices == bound.astype(np.float32), bound, vertices)
    return manifolds.to_manifold(TriangleMesh(vertices, mesh.triangles))


def _sides(section: Section | None, sides: int | None) -> int:
    """Return how many sides struts of a section have; 4 are square."""
    if section is None:
        return 4 if sides is None else sides
    check_choice(section, "section", get_args(Section))
    found = (4 if section == "square" else SIDES) if sides is None else sides
    if (found == 4) != (section == "square"):
        raise OptionError(
            f"sides is {found} for section={section!r}; need 4 for square struts, 8 or more for "
            "round ones"
        )
    return found


def sided_maker(sides: int, **options: Unpack[RoundOptions]) -> Make:
    """Return what makes struts with this number of sides."""
    check_sides(sides)
    if sides == 4 and options:
        raise OptionError(
            f"{', '.join(options)} given with sides=4, square struts; need sides=8 or more, round "
            "ones"
        )
    return maker(section="square" if sides == 4 else "round", **options)


def _report_full(part: Manifold, outer: Manifold, radius: Radius) -> None:
    """Log if the struts leave next to nothing of the body free."""
    share = part.volume() / outer.volume()
    if share > FULL:
        size = "their radii are" if callable(radius) else f"a radius of {radius:g} mm is"
        _log.warning(
            "the struts fill the body: %.1f %% of its volume are solid; %s too large for its cells",
            100 * share,
            size,
        )


def _struts_touching(
    region: Region,
    cell: str | UnitCell,
    size: ArrayLike,
    radius: Radius,
    nudge: float,
    through: bool,
) -> Skeleton:
    """Return the struts of an endless lattice that have an end in the region, not yet cut.

    Parameters
    ----------
    nudge : how far the lattice is moved, in cell sizes
    through : whether struts stay of which only the middle is in the region: they hang on the skin
    """
    low, high = region.bounds
    shortest = float(as_floats(size, "cell size in mm", OptionError).min())
    origin = low + nudge * shortest * NUDGE_DIRECTION
    whole = fill(region.bounds, cell, size, radius, origin=origin)
    struts = Struts(whole.nodes, whole.edges)
    touching = np.asarray(region.contains(whole.nodes)[whole.edges].any(axis=1))
    if through:
        touching[region.crossings(struts.nodes, struts.edges)[0]] = True
    if not touching.any():
        raise SkeletonError(
            f"no strut of the lattice is in the body from {place_text(low)} to {place_text(high)}; "
            "need one (smaller cells?)"
        )
    return struts.kept(touching).skeleton(radius)
