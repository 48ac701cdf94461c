"""Regions filled with a lattice, its struts cut at the surface or kept whole."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_flag, as_vector, check_choice, checks_keywords, described
from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.placements import (
    AxesLike,
    BoxLike,
    OriginLike,
    PositionLike,
    numbers_of,
    placed_by,
)
from scaffold_cad.base.radii import Radius, check_radius
from scaffold_cad.base.regions import BoxRegion, ImplicitRegion, Keep, Region
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.filling.innercell import is_full
from scaffold_cad.lattice.clipping import clipped, least_length
from scaffold_cad.lattice.crumbs import report_small, without_crumbs
from scaffold_cad.lattice.maps import CellMap
from scaffold_cad.lattice.maps.grading import CellSize
from scaffold_cad.lattice.maps.placing import chords_on
from scaffold_cad.lattice.maps.solids import as_axes
from scaffold_cad.lattice.meshregion import MeshRegion
from scaffold_cad.lattice.periodic import PeriodicLattice
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.repetition import as_counts, repeated
from scaffold_cad.lattice.struts import Struts
from scaffold_cad.lattice.tiling import cell_size
from scaffold_cad.lattice.unitcell import UnitCell
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.products.surfaces import surface_error, surface_of
from scaffold_cad.skeleton import Skeleton

if TYPE_CHECKING:
    from build123d import Shape

_log = logging.getLogger(__name__)

SHORTEST_FRACTION = 1e-3
"""Length below which the rest of a cut strut is given up, as a fraction of the cell's size."""

MOST_CELLS = 1e9
"""Most cells along a side of a lattice that is not made whole."""

COUNT_SLACK = 1e-6
"""How much larger than whole cells a region may be without a further cell, in cells."""


class HasTriangles(Protocol):
    """A mesh of any library: `vertices`, and `faces` or `triangles` (t, 3) as their indices."""

    @property
    def vertices(self) -> Any:
        """Vertex positions, shape (v, 3), mm."""


FillRegion: TypeAlias = "BoxLike | Shape | HasTriangles | Callable[[Points], ArrayLike] | Region"
"""A box (two corners), a solid of build123d, a closed triangle mesh, a function that is negative
inside, or a region of `scaffold_cad.base.regions`."""


@checks_keywords()
def fill(
    region: FillRegion,
    cell: str | UnitCell,
    size: CellSize,
    radius: Radius,
    *,
    keep: Keep = "clip",
    dangling: bool = True,
    crumbs: bool = False,
    bounds: BoxLike | None = None,
    origin: OriginLike | None = None,
    axes: AxesLike | None = None,
    on: CellMap | None = None,
    shortest: float | None = None,
) -> Skeleton:
    """Return the part of an endless lattice that lies in a region, its surface included.

    Parameters
    ----------
    region : a box (its lowest and highest corner, mm, or a BoundBox of build123d); or a build123d
        solid; or a closed triangle mesh, anything with arrays `vertices` and `faces` or
        `triangles`, counter-clockwise seen from outside; or a function of positions (n, 3) that
        returns signed distances (n,), negative inside
    cell : a unit cell or its name
    size : of one cell, mm: three numbers, or one for a cell that is not distorted
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    keep : "clip" cuts struts at the surface, where they get a new node; "whole" keeps those
        whole that have their middle in the region, and drops the others
    dangling : whether struts that end free, at the surface or for want of a neighbor, stay
    crumbs : whether loose pieces stay that have less than half the struts of a cell, as the
        surface cuts them off at edges; the log says how many were left out
    bounds : lowest and highest corner of a box around the region; for a function only
    origin : a corner of a cell, mm; by default the lowest corner of the bounds
    axes : directions of the sides of cells, rows (3, 3), or those of a Plane or Location, to turn
        the lattice; by default x, y, z, or the cell's own
    on : a map that cells are put on, such as `face_map`, before they are cut to the region; `size`
        may then be a function of positions
    shortest : pieces of cut struts shorter than this are shrunk to a node on the surface, mm;
        by default 1/1000 of the cell's size

    Raises
    ------
    OptionError
        If an argument is out of its range, the region is of another type, or its bounds hold more
        than 1e8 struts.
    MeshError
        If the mesh is not closed.
    SkeletonError
        If no strut is in the region.

    Examples
    --------
    >>> from scaffold_cad import fill
    >>> len(fill([[0, 0, 0], [10, 10, 10]], "bcc", 5.0, radius=0.5).edges)
    64
    """
    check_choice(keep, "keep", get_args(Keep))
    dangling, crumbs = as_flag(dangling, "dangling"), as_flag(crumbs, "crumbs")
    cell, space = as_cell(cell), as_region(region, bounds)
    check_radius(radius)
    if on is None:
        struts, sizes = _endless(space, cell, size, origin, axes)
        report_small(space.bounds, cell, sizes)
        if is_full(cell, sizes, radius):
            _log.warning(
                "the struts fill the region: a radius of %g mm is too large for its cells", radius
            )
    elif origin is None and axes is None:
        struts, sizes = _on_map(on, cell, size)
    else:
        raise OptionError("origin or axes are given with a map; need them left out")
    shortest = least_length(shortest, SHORTEST_FRACTION * float(sizes.min()))
    if keep == "whole":
        struts = struts.kept(space.contains(struts.middles))
    else:
        struts = clipped(struts, space, shortest)
    if not dangling:
        struts = struts.without_dangling()
    if not crumbs:
        struts = without_crumbs(struts, cell, sizes)
    if len(struts.edges) == 0:
        raise SkeletonError(
            f"no strut of unit cell {cell.name!r} of size {sizes.tolist()} mm is left in the "
            f"region from {space.bounds[0].tolist()} to {space.bounds[1].tolist()} mm; need one "
            "(smaller cells?)"
        )
    is_clean = keep == "whole" and on is None
    return struts.skeleton(radius) if is_clean else struts.cleaned_skeleton(radius)


def struts_around(
    space: Region,
    cell: UnitCell,
    size: CellSize,
    *,
    origin: OriginLike | None = None,
    axes: AxesLike | None = None,
    on: CellMap | None = None,
) -> Struts:
    """Return the struts of an endless lattice in the cells around a region, or of one on a map.

    Raises
    ------
    OptionError
        If an argument is out of its range.
    """
    if on is None:
        margin = np.zeros(3) if callable(size) else cell_size(cell, size)
        low, high = space.bounds
        around = BoxRegion([low - margin, high + margin])
        return _endless(around, cell, size, low if origin is None else origin, axes)[0]
    if origin is None and axes is None:
        return _on_map(on, cell, size)[0]
    raise OptionError("origin or axes are given with a map; need them left out")


def _endless(
    space: Region,
    cell: UnitCell,
    size: CellSize,
    origin: OriginLike | None,
    axes: AxesLike | None,
) -> tuple[Struts, Floats]:
    """Return the struts of a lattice around a region, and the size of a cell (3,), mm."""
    if callable(size):
        raise OptionError("the cell size is a function without a map; need one (on=BoxMap(...))")
    if origin is not None:
        origin, axes = placed_by(origin, axes)
    sizes = cell_size(cell, size)
    frame = cell.axes if axes is None else cell.axes @ as_axes(axes)
    counts, corner = cells_around(space.bounds, cell, sizes, origin, frame)
    return repeated(cell, sizes, counts, corner, frame), sizes


def _on_map(on: CellMap, cell: UnitCell, size: CellSize) -> tuple[Struts, Floats]:
    """Return the struts of a lattice on a map, and the size of a mean cell (3,), mm."""
    chords = chords_on(on, cell, size)
    return chords, chords.cell


def as_region(region: FillRegion, bounds: BoxLike | None = None) -> Region:
    """Return `region` as one of those that struts can be clipped to; see `fill`."""
    region = numbers_of(region)
    if bounds is not None and not callable(region):
        raise OptionError("bounds are given for a region that has its own; need a function")
    if isinstance(region, Region):
        return region
    surface = surface_of(region)
    if surface is not None:
        off = surface_error(region)
        return MeshRegion(TriangleMesh(surface.vertices, surface.triangles), off)
    if callable(region):
        if bounds is None:
            raise OptionError("the region is a function without bounds; need a box around it")
        return ImplicitRegion(region, bounds)
    if not isinstance(region, Sequence | np.ndarray) or isinstance(region, str):
        raise OptionError(
            f"the region is {described(region)}; need a box, a function, a triangle mesh "
            "with arrays of vertices and triangles, or a build123d solid"
        )
    return BoxRegion(region)


def cells_around(
    bounds: Floats,
    cell: UnitCell,
    size: Floats,
    origin: PositionLike | None = None,
    axes: Floats | None = None,
) -> tuple[tuple[int, int, int], Points]:
    """Return how many cells along their sides a box meets, and the corner of the first.

    They are not too many to be made; see `lattice_around` for more.

    Parameters
    ----------
    bounds : (2, 3) float64, lowest and highest corner of the box, mm
    origin : a corner of a cell, mm; by default the lowest corner of the box
    axes : (3, 3) float64, unit directions of the sides of cells, rows; by default the cell's own

    Raises
    ------
    OptionError
        If `origin` is not a position, or the cells have too many struts, see `as_counts`.
    """
    found, corner = _cells_around(bounds, cell, size, origin, axes)
    return as_counts(cell, found), corner


def lattice_around(
    bounds: Floats, cell: UnitCell, size: Floats, radius: Radius, **struts: Any
) -> PeriodicLattice:
    """Return the lattice of all cells that a box meets, of which no strut is made yet.

    Parameters
    ----------
    bounds : (2, 3) float64, lowest and highest corner of the box, mm
    struts : how round struts are made, see `PeriodicLattice`

    Raises
    ------
    OptionError
        If there are too many cells to be counted.
    """
    counts, corner = whole_cells_around(bounds, cell, size)
    return PeriodicLattice(cell, size, counts, radius=radius, origin=corner, **struts)


def whole_cells_around(
    bounds: Floats, cell: UnitCell, size: Floats
) -> tuple[tuple[int, int, int], Points]:
    """Return how many cells along their sides a lattice around a box has, and its corner.

    Raises
    ------
    OptionError
        If there are too many cells to be counted.
    """
    found, corner = _cells_around(bounds, cell, size, None, None)
    if not (found < MOST_CELLS).all():
        raise OptionError(
            f"a cell of {size.tolist()} mm is too small for a box of "
            f"{(bounds[1] - bounds[0]).tolist()} mm; need fewer than {MOST_CELLS:g} cells aside"
        )
    x, y, z = found.astype(np.intp).tolist()
    return (x, y, z), corner


def _cells_around(
    bounds: Floats, cell: UnitCell, size: Floats, origin: PositionLike | None, axes: Floats | None
) -> tuple[Floats, Points]:
    """Return how many cells along their sides a box meets (3,), and the corner of the first."""
    corner = bounds[0] if origin is None else as_vector(origin, "origin")
    frame = cell.axes if axes is None else axes
    corners = np.array(list(product(*bounds.T))) - corner  # (8, 3)
    if not np.array_equal(frame, np.eye(3)):
        corners = corners @ np.linalg.inv(frame)
    with np.errstate(over="ignore", invalid="ignore"):  # too many cells to count are too many
        first = np.floor(corners.min(axis=0) / size + COUNT_SLACK)
        last = np.ceil(corners.max(axis=0) / size - COUNT_SLACK)
        if cell.is_net:  # struts come from below through the faces of the first cells
            first -= cell.motif.moves.max()
        counts: Floats = np.maximum(last - first, 1)
        return counts, corner + (first * size) @ frame
