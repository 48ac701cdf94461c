"""A unit cell repeated in the places of a map: the struts, and how much the map stretches them."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arguments import check_kind, checks_keywords, described
from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, as_floats
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.regions import BoxRegion
from scaffold_cad.base.summaries import counted, size_text
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice.clipping import clipped
from scaffold_cad.lattice.crumbs import no_crumbs
from scaffold_cad.lattice.maps.cellmap import CellMap, extents
from scaffold_cad.lattice.maps.chords import Chords
from scaffold_cad.lattice.maps.grading import CellSize, graded, mean_size
from scaffold_cad.lattice.maps.seams import (
    SAME_PLACE,
    Placed,
    check_folds,
    check_sides,
    grid_corners,
    seams,
)
from scaffold_cad.lattice.maps.trimming import PolygonRegion
from scaffold_cad.lattice.registry import as_cell
from scaffold_cad.lattice.repetition import as_counts, repeated
from scaffold_cad.lattice.struts import Struts, leading_on
from scaffold_cad.lattice.unitcell import UnitCell, as_three
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.skeleton.overlaps import overlapping_half_edges

SHORTEST_FRACTION = 1e-3
"""Length below which the rest of a strut cut at a border is given up, in cells."""

LEAST_AROUND = 3
"""Least cells around a map that closes: with two, struts would join the same nodes twice."""

_log = logging.getLogger(__name__)

Counts: TypeAlias = "int | tuple[int, int, int]"
"""Cells along u, v and w, or one number for all three."""


@checks_keywords()
@dataclass(frozen=True, eq=False)
class MappedLattice(Frozen):
    """A lattice on a map, and how much its struts are stretched."""

    skeleton: Skeleton
    """The lattice."""
    stretch: Floats
    """Length of each strut over that in a cell of the mean size, about 1, shape (s,)."""
    counts: tuple[int, int, int]
    """Cells along u, v and w, in each patch."""

    def __str__(self) -> str:
        cells = " x ".join(map(str, self.counts))
        stretch = f"{self.least_stretch:.3g} to {self.largest_stretch:.3g}"
        counts = counted(len(self.skeleton.edges), "strut")
        size = size_text(self.skeleton.nodes)
        return f"MappedLattice: {cells} cells, {counts}, {size}, stretch {stretch}"

    @property
    def largest_stretch(self) -> float:
        """The stretch of the strut that is longest for what it is."""
        return float(self.stretch.max())

    @property
    def least_stretch(self) -> float:
        """The stretch of the strut that is shortest for what it is."""
        return float(self.stretch.min())


@checks_keywords()
def lattice_on(
    mapping: CellMap,
    cell: str | UnitCell,
    radius: Radius,
    *,
    size: CellSize | None = None,
    counts: Counts | None = None,
    dangling: bool = True,
) -> MappedLattice:
    """Return the lattice of a cell on a map, and its stretch.

    Where the map closes, cells share the nodes at its seam; where it is trimmed, struts are cut
    at the border, and loose crumbs of less than half a cell are left out.

    Parameters
    ----------
    mapping : where cells go
    cell : a unit cell or its name
    radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
    size : of a cell, mm: one number, three (along u, v and w), or a function of positions (n, 3)
        that returns (n,) numbers, as a `Field` is. The number of cells that fits best is taken
    counts : cells along u, v and w (of each patch) in place of a size
    dangling : whether struts that end free at a border stay

    Raises
    ------
    OptionError
        If an argument is out of its range, not one of size and counts is given, or there are
        less than three cells around a map that closes.
    SkeletonError
        If the map folds cells, or a cell does not meet itself between two patches; the place is
        named.

    Examples
    --------
    >>> from scaffold_cad import CylinderMap, lattice_on
    >>> tube = CylinderMap(10.0, height=12.0, thickness=3.0)
    >>> placed = lattice_on(tube, "bcc", radius=0.3, size=3.0)
    >>> placed.skeleton.component_count
    1
    """
    check_kind(mapping, CellMap, name="mapping")
    cell = as_cell(cell)
    chords, drawn_together = _placed(mapping, cell, size, counts, dangling)
    skeleton = Skeleton(chords.nodes, chords.edges, 1.0)
    if drawn_together and len(overlapping_half_edges(skeleton.nodes, skeleton.edges)):
        skeleton = skeleton.cleaned(weld_distance=0.0).skeleton
    skeleton = skeleton.with_radii(radii_at(skeleton.nodes, radius))
    lattice = MappedLattice(skeleton, chords.stretch, chords.counts)
    _log.info(
        "%d x %d x %d cells of %r: struts are %.3g to %.3g times as long as in a cell of %s mm",
        *chords.counts,
        cell.name,
        lattice.least_stretch,
        lattice.largest_stretch,
        " x ".join(f"{one:.3g}" for one in chords.cell),
    )
    return lattice


def chords_on(mapping: CellMap, cell: UnitCell, size: CellSize) -> Chords:
    """Return the struts of a cell on a map, and the curves that they are chords of.

    Raises
    ------
    OptionError, SkeletonError
        As `lattice_on` does.
    """
    check_kind(mapping, CellMap)
    return _placed(mapping, cell, size, None, True)[0]


def _placed(
    mapping: CellMap,
    cell: UnitCell,
    size: CellSize | None,
    counts: Counts | None,
    dangling: bool,
) -> tuple[Chords, bool]:
    """Return the struts of a cell on a map, and whether nodes of one patch are drawn together."""
    whole = extents(mapping)  # (3,)
    grading = None if size is None or not callable(size) else graded(mapping, size)
    numbers = _counts(mapping, cell, whole, size, counts)
    if mapping.patches > 1:
        check_sides(mapping, cell, numbers)
    struts, patch = _struts(mapping, cell, numbers)
    spans = struts.ends - struts.starts  # in cells
    around = np.asarray(mapping.wraps) & (struts.nodes > np.asarray(numbers) + SAME_PLACE)
    struts = Struts(np.where(around, struts.nodes - numbers, struts.nodes), struts.edges)
    corners = np.tile(grid_corners(numbers), (mapping.patches, 1))
    of_corner = np.repeat(np.arange(mapping.patches), len(corners) // mapping.patches)
    places = np.concatenate([struts.nodes / numbers, corners])
    of_place = np.concatenate([patch, of_corner])
    if grading is not None:
        places = grading.moved(places, of_place)
    # Both at once: a surface is asked for each place only once.
    positions = mapping.positions(places, of_place)
    nodes = positions[: len(patch)]
    check_folds(positions[len(patch) :], numbers, mapping.patches)
    mean = whole / numbers
    placed = Placed(
        mapping, struts.nodes, patch, nodes, numbers, float(mean.min()), bool(around.any())
    )
    target, drawn_together = seams(placed)
    kept, edges = _each_once(target, struts)
    if mapping.loops:
        middles = nodes[struts.edges[kept]].mean(axis=1)
        stay = _not_loose(edges, length(spans[kept]), middles, cell, dangling)
        kept, edges = kept[stay], edges[stay]
    used, ends = np.unique(edges, return_inverse=True)
    first = struts.edges[kept, 0]
    real = nodes[struts.edges[kept, 1]] - nodes[first]
    chords = Chords(
        nodes[used],
        ends.reshape(-1, 2),
        mapping=mapping,
        grading=grading,
        first=struts.nodes[first] / numbers,
        spans=spans[kept] / numbers,
        patch=patch[first],
        stretch=length(real) / length(spans[kept] * mean),
        counts=numbers,
        cell=mean,
    )
    return chords, drawn_together


def _counts(
    mapping: CellMap,
    cell: UnitCell,
    whole: Floats,
    size: CellSize | None,
    counts: Counts | None,
) -> tuple[int, int, int]:
    """Return the cells along u, v and w."""
    if (size is None) == (counts is None):
        raise OptionError("need either the size of a cell or counts of cells on the map")
    if counts is not None:
        numbers = three_counts(counts)
    elif size is not None:
        sizes = _sizes(mapping, cell, size)
        numbers = np.maximum(np.rint(whole / sizes), np.where(mapping.wraps, LEAST_AROUND, 1))
        if (whole / sizes < 0.5 - 1e-6).any():
            _log.warning(
                "a cell of %s mm is more than twice as large as the map, %s mm",
                " x ".join(f"{one:.3g}" for one in sizes),
                " x ".join(f"{one:.3g}" for one in whole),
            )
    few = np.flatnonzero((numbers < LEAST_AROUND) & mapping.wraps)
    if len(few):
        raise OptionError(
            f"{int(numbers[few[0]])} cells along {'uvw'[few[0]]}, where the map closes; "
            f"need {LEAST_AROUND} or more"
        )
    as_counts(cell, numbers * (mapping.patches, 1, 1))  # not too many
    return as_counts(cell, numbers)


def _sizes(mapping: CellMap, cell: UnitCell, size: CellSize) -> Floats:
    """Return the size of a cell along u, v and w (3,), mm; of a field the mean one."""
    if callable(size):
        mean: Floats = mean_size(mapping, size) * cell.proportions / cell.proportions[0]
        return mean
    sizes = as_floats(size, "cell size in mm", OptionError)
    if sizes.ndim == 0:
        sizes = sizes * cell.proportions / cell.proportions[0]
    return as_three(sizes, "cell size in mm")


def three_counts(counts: Counts | None) -> Ints:
    """Return `counts` as three whole numbers, shape (3,).

    Raises
    ------
    OptionError
        If they are not one or three whole numbers ≥ 1.
    """
    values = np.asarray(counts)
    if values.shape not in {(), (3,)} or values.dtype.kind not in "iu" or (values < 1).any():
        raise OptionError(f"counts are {described(counts)}; need three whole numbers >= 1")
    return np.broadcast_to(values, 3)


def _struts(mapping: CellMap, cell: UnitCell, counts: tuple[int, int, int]) -> tuple[Struts, Ints]:
    """Return the struts of all patches in cells, trimmed, and the patch of each node (n,)."""
    one = repeated(cell, np.ones(3), counts, axes=np.eye(3))
    if cell.is_net:
        one = _net_in_cube(mapping, cell, counts)
    if mapping.loops:
        # Struts of nets go on beyond the end, where the borders are those at the beginning.
        around = [(0, 1) if cell.is_net and closes else (0,) for closes in mapping.wraps[:2]]
        turns = [np.array([u, v]) * counts[:2] for u, v in product(*around)]
        loops = tuple(loop * counts[:2] + turn for loop in mapping.loops for turn in turns)
        one = clipped(one, PolygonRegion(loops), SHORTEST_FRACTION)
    used, ends = np.unique(one.edges, return_inverse=True)
    nodes, edges = one.nodes[used], ends.reshape(-1, 2)
    patch = np.repeat(np.arange(mapping.patches), len(nodes))
    first = np.arange(mapping.patches) * len(nodes)
    return (
        Struts(
            np.tile(nodes, (mapping.patches, 1)),
            (first[:, None, None] + edges).reshape(-1, 2),
        ),
        patch,
    )


def _net_in_cube(mapping: CellMap, cell: UnitCell, counts: tuple[int, int, int]) -> Struts:
    """Return the struts of a net, which may go through the faces of its box, in cells.

    Where the map closes they go on at the beginning, elsewhere they are cut at its sides.

    Raises
    ------
    OptionError
        If the map has several patches.
    """
    if mapping.patches > 1:
        raise OptionError(
            f"struts of {cell.name!r} go through the faces of its box and the map has "
            f"{mapping.patches} patches; need one patch, or another cell"
        )
    reach = int(cell.motif.moves.max())
    before = np.where(mapping.wraps, 0, reach)
    around = counts + before
    number = (int(around[0]), int(around[1]), int(around[2]))
    struts = repeated(cell, np.ones(3), number, -before.astype(np.float64), np.eye(3))
    # All struts are within reach: a box without end would have a tolerance of many cells.
    low = np.where(mapping.wraps, -1.0, 0.0)
    high = np.where(mapping.wraps, counts + np.asarray(reach + 1.0), counts)
    return clipped(struts, BoxRegion([low, high]), SHORTEST_FRACTION)


def _not_loose(
    edges: Edges, lengths: Floats, middles: Points, cell: UnitCell, dangling: bool
) -> Bools:
    """Return which struts of a trimmed map stay, (m,): no crumbs, and if asked none that dangle.

    Parameters
    ----------
    edges : of the nodes that are one at seams, (m, 2) intp
    lengths : in cells, (m,) float64
    middles : (m, 3) float64, mm

    Raises
    ------
    SkeletonError
        If none stays.
    """
    stay = np.ones(len(edges), dtype=np.bool_) if dangling else leading_on(edges)
    stay[stay] = no_crumbs(edges[stay], lengths[stay], middles[stay], cell, np.ones(3))
    if not stay.any():
        raise SkeletonError(
            f"no strut of unit cell {cell.name!r} is within the borders of the face; "
            "need one (smaller cells?)"
        )
    return stay


def _each_once(target: Ints, struts: Struts) -> tuple[Ints, Ints]:
    """Return which struts stay, (m,), and their nodes, (m, 2), when nodes become their targets."""
    ends = target[struts.edges]
    ends.sort(axis=1)
    proper = np.flatnonzero(ends[:, 0] != ends[:, 1])
    key = ends[proper, 0] * len(target) + ends[proper, 1]
    _, first = np.unique(key, return_index=True)
    kept: Ints = proper[np.sort(first)]
    return kept, target[struts.edges[kept]]
