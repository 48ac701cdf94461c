"""Where a map's cells meet themselves: at seams, between patches, at poles, and in folds."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats, Ints, Points, place_text
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import length, triple
from scaffold_cad.errors import SkeletonError
from scaffold_cad.lattice.maps.cellmap import CellMap
from scaffold_cad.lattice.unitcell import UnitCell

WELD_FRACTION = 1e-6
"""Distance within which nodes on the sides of patches are one, in mean lengths of a cell."""

SAME_PLACE = 1e-9
"""Difference below which two places are the same, in cells."""

SAME_NODE = 1e-6
"""Distance below which nodes of two sides of a cell are the same, in cells, about."""

FOLD = 1e-9
"""Least volume at the corner of a cell, in mean volumes of a cell, below which it is folded."""


@dataclass(frozen=True, eq=False)
class Placed:
    """Nodes of cells and where a map puts them."""

    mapping: CellMap
    places: Points
    """u, v and w of each node, shape (n, 3), in cells."""
    patch: Ints
    """Its unit cube, shape (n,)."""
    nodes: Points
    """Its position, shape (n, 3), mm."""
    counts: tuple[int, int, int]
    """Cells along u, v and w."""
    cell: float
    """Shortest side of a mean cell, mm."""
    goes_around: bool = False
    """Whether struts were continued at the beginning where the map closes: any nodes may meet."""


def seams(placed: Placed) -> tuple[Ints, bool]:
    """Return the node that each node becomes, shape (n,), and whether some are drawn together.

    Nodes at seams are one by their place; those on the sides of patches, and where a side is
    drawn together to a point as at a pole, by their position.
    """
    mapping, places = placed.mapping, placed.places
    on_side = (np.abs(places) < SAME_PLACE) | (np.abs(places - placed.counts) < SAME_PLACE)
    side = np.flatnonzero(on_side[:, :2].any(axis=1) | (on_side[:, 2] & mapping.wraps[2]))
    if placed.goes_around:
        side = np.arange(len(places))
    pairs = np.zeros((0, 2), dtype=np.intp)
    if any(mapping.wraps):
        once = places[side].copy()
        for axis in np.flatnonzero(mapping.wraps).tolist():
            once[np.abs(once[:, axis] - placed.counts[axis]) < SAME_PLACE, axis] = 0.0
        pairs = side[cKDTree(once).query_pairs(SAME_PLACE, output_type="ndarray")]
    label = component_labels(pairs, len(places))
    near = WELD_FRACTION * placed.cell
    met = side[cKDTree(placed.nodes[side]).query_pairs(near, output_type="ndarray")]
    new = label[met[:, 0]] != label[met[:, 1]]
    drawn = new & (placed.patch[met[:, 0]] == placed.patch[met[:, 1]])
    if new.any():
        label = component_labels(np.concatenate([pairs, met]), len(places))
    _, first = np.unique(label, return_index=True)
    return first[label], bool(drawn.any())


def check_sides(mapping: CellMap, cell: UnitCell, counts: tuple[int, int, int]) -> None:
    """Raise where cells do not meet themselves between two patches.

    Raises
    ------
    SkeletonError
        If the nodes on a side of the cell are not those on the side that it meets, turned and
        mirrored as the patches are, or their counts differ; the place is named.
    """
    patterns = [_pattern(cell, axis) for axis in (1, 0)]  # of sides v = 0 and 1, u = 0 and 1
    sides = ("v", "v", "u", "u")
    for one, other, mirrored, place in _meetings(mapping):
        a, b = patterns[one // 2], patterns[other // 2]
        if mirrored:
            b = np.column_stack([-b[:, 0] % 1.0, b[:, 1]])
        same = len(a) == len(b)
        if same and len(a):
            gaps = np.asarray(cKDTree(_on_torus(a)).query(_on_torus(b))[0])
            same = float(gaps.max()) < SAME_NODE
        where = (
            f"at {place_text(place)}, where the side {sides[one]} of a patch is the "
            f"{'mirrored ' * mirrored}side {sides[other]} of the next"
        )
        if not same:
            raise SkeletonError(
                f"cells of {cell.name!r} do not meet {where}; need a cell with four equal sides, "
                "such as bcc, octet or kelvin"
            )
        if one // 2 != other // 2 and counts[0] != counts[1]:
            raise SkeletonError(
                f"{counts[0]} cells along u and {counts[1]} along v do not meet {where}; need as "
                "many along both"
            )


def _pattern(cell: UnitCell, axis: int) -> Floats:
    """Return where nodes of an endless lattice are on the cell's side normal to an axis, (k, 2).

    Parameters
    ----------
    axis : 0 or 1; the first column is along the other of the two, the second along w
    """
    sites = cell.motif.sites
    on_side = sites[sites[:, axis] == 0.0]
    return np.asarray(on_side[:, [1 - axis, 2]])


def _on_torus(places: Floats) -> Floats:
    """Return points (k, 4) that are close where places (k, 2) are, modulo 1."""
    turn = 2 * np.pi * places
    return np.concatenate([np.cos(turn), np.sin(turn)], axis=1)


def _meetings(mapping: CellMap) -> list[tuple[int, int, bool, Points]]:
    """Return how sides of patches meet: both sides, whether mirrored, and where, each way once.

    Sides are numbered: v = 0, v = 1, u = 0, u = 1.
    """
    along = np.array([0.25, 0.5, 0.75])
    zero, one, half = np.zeros(3), np.ones(3), np.full(3, 0.5)
    places = [(along, zero), (along, one), (zero, along), (one, along)]
    unit = np.stack([np.stack([u, v, half], axis=1) for u, v in places])  # (4, 3, 3)
    patch = np.repeat(np.arange(mapping.patches), 12)
    points = mapping.positions(np.tile(unit.reshape(-1, 3), (mapping.patches, 1)), patch)
    points = points.reshape(-1, 3, 3)  # side of a patch, place along it
    near = WELD_FRACTION * float(np.ptp(points.reshape(-1, 3), axis=0).max())
    pairs = cKDTree(points[:, 1]).query_pairs(near, output_type="ndarray")
    ahead = length(points[pairs[:, 0], 0] - points[pairs[:, 1], 0])
    back = length(points[pairs[:, 0], 0] - points[pairs[:, 1], 2])
    ways = np.column_stack([pairs % 4, back < ahead])
    _, first = np.unique(ways, axis=0, return_index=True)
    return [
        (int(ways[k, 0]), int(ways[k, 1]), bool(ways[k, 2]), points[pairs[k, 0], 1]) for k in first
    ]


def grid_corners(counts: tuple[int, int, int]) -> Points:
    """Return the corners of cells in the unit cube, shape (c, 3), those along w together."""
    steps = [np.arange(count + 1) / count for count in counts]
    return np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)


def check_folds(corners: Points, counts: tuple[int, int, int], patches: int) -> None:
    """Raise where a corner of a cell is inside out, or all of a patch has no volume.

    Parameters
    ----------
    corners : (patches · c, 3) float64, positions of the corners of cells, mm
    """
    shape = tuple(count + 1 for count in counts)
    for grid in corners.reshape(patches, *shape, 3):
        volumes = _corner_volumes(grid)
        mean = float(volumes.mean())
        folded = np.argwhere((volumes * np.sign(mean)).min(axis=0) < -FOLD * abs(mean))
        if len(folded) or mean == 0:
            at = tuple(folded[0].tolist()) if len(folded) else (0, 0, 0)
            raise SkeletonError(
                f"the map folds cell {list(at)} at {place_text(grid[at])}; need a layer that is "
                "thinner than the surface is curved there and nowhere of thickness 0, or more cells"
            )


def _corner_volumes(grid: Floats) -> Floats:
    """Return the signed volume of the edges at each corner of each cell, (8, i, j, k), mm³."""
    near, far = slice(None, -1), slice(1, None)
    x, y, z = (np.diff(grid, axis=axis) for axis in range(3))
    return np.stack(
        [triple(x[:, j, k], y[i, :, k], z[i, j, :]) for i, j, k in product((near, far), repeat=3)]
    )
