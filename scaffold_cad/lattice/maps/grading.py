"""Cells of sizes that vary: the places of a map moved so that cells are as large as asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import spsolve

from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    as_floats,
    place_text,
)
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice.maps.cellmap import CellMap

CellSize: TypeAlias = "ArrayLike | Callable[[Points], ArrayLike]"
"""One size of a cell, three along u, v and w, or a function of positions (n, 3), mm."""

GRID = ((1, 13), (64, 7), (np.inf, 4))
"""Most patches, and places along each axis of the grid of each on which sizes are graded."""

ROUNDS = 12
"""How often sizes are looked up again where the places have moved to."""


@dataclass(frozen=True, eq=False)
class Grading(Frozen):
    """Places of unit cubes moved within them, their sides kept, so that cell sizes vary."""

    grid: Floats
    """Where the places of a regular grid of each patch go, shape (patches, k, k, k, 3)."""

    def moved(self, places: Points, patch: Ints) -> Points:
        """Return where places (n, 3) of patches (n,) go, between the grid's by threes."""
        steps = self.grid.shape[1] - 1
        scaled = np.clip(places, 0.0, 1.0) * steps
        low = np.minimum(scaled.astype(np.intp), steps - 1)
        share = scaled - low
        moved = np.zeros_like(places)
        for corner in product((0, 1), repeat=3):
            u, v, w = (low + corner).T
            weight = np.where(corner, share, 1.0 - share).prod(axis=1)
            moved += weight[:, None] * self.grid[patch, u, v, w]
        return moved


def graded(mapping: CellMap, size: Callable[[Points], ArrayLike]) -> Grading:
    """Return the grading under which cells on a map are as large as a function asks.

    Neighboring places of a grid are joined by springs that are as soft as cells are to be large
    there; each coordinate is at rest on its own. Along one axis that is exact; where sizes vary
    along several, it is a compromise, as cells must go on as cells. Each of several patches has as
    many cells as the others: sizes vary within it, and sides are divided alike by both patches.

    Raises
    ------
    OptionError
        If a size is not > 0.
    """
    rest, patch = _grid(mapping)
    edges, axis = _grid_edges(mapping.patches, _count(mapping.patches))
    same = [_seams(mapping, axis) for axis in range(3)]
    rows = _rows_of(edges, rest, mapping.patches > 1)
    places = rest.copy()
    for _ in range(ROUNDS):
        points = mapping.positions(places, patch)
        wanted = sizes_at(size, points)
        spans = length(points[edges[:, 1]] - points[edges[:, 0]])
        moves = np.abs(places[edges[:, 1]] - places[edges[:, 0]])[np.arange(len(edges)), axis]
        speed = spans / np.maximum(moves, 1e-12)
        # A chain of springs of these stiffnesses has steps in mm as the wanted sizes.
        stiffness = speed / wanted[edges].mean(axis=1)
        places = np.stack(
            [_at_rest(edges, stiffness, rows, rest[:, k], same[k]) for k in range(3)], axis=1
        )
    count = _count(mapping.patches)
    return Grading(places.reshape(mapping.patches, count, count, count, 3))


def mean_size(mapping: CellMap, size: Callable[[Points], ArrayLike]) -> Floats:
    """Return the harmonic mean of a size over a map, as counts of cells ask, three times."""
    points = mapping.positions(*_grid(mapping))
    return np.full(3, 1.0 / float((1.0 / sizes_at(size, points)).mean()))


def _count(patches: int) -> int:
    """Return how many places the grid of each of some patches has along an axis."""
    return next(count for most, count in GRID if patches <= most)


def _grid(mapping: CellMap) -> tuple[Points, Ints]:
    """Return the places of the grids of all patches (n, 3), and the patch of each (n,)."""
    steps = np.linspace(0.0, 1.0, _count(mapping.patches))
    one = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.tile(one, (mapping.patches, 1)), np.repeat(np.arange(mapping.patches), len(one))


def sizes_at(size: Callable[[Points], ArrayLike], points: Points) -> Floats:
    """Return the wanted size at positions (n, 3), shape (n,), mm.

    Raises
    ------
    OptionError
        If the function returns another shape, or a number that is not > 0; the place is named.
    """
    values = as_floats(size(points), "what the function size returned", OptionError)
    if values.shape not in {(), (len(points),)}:
        raise OptionError(
            f"size returned shape {values.shape} for points ({len(points)}, 3); "
            f"need ({len(points)},)"
        )
    values = np.broadcast_to(values, (len(points),))
    bad = np.flatnonzero(~(np.isfinite(values) & (values > 0)))
    if len(bad):
        raise OptionError(
            f"the cell size is {values[bad[0]]:g} mm at {place_text(points[bad[0]])}; need > 0"
        )
    return values


def _grid_edges(patches: int, count: int) -> tuple[Edges, Ints]:
    """Return the neighbors in the grids (e, 2), and the axis along which each pair lies (e,)."""
    number = np.arange(patches * count**3).reshape(patches, count, count, count)
    pairs = [
        np.stack([np.delete(number, -1, axis).ravel(), np.delete(number, 0, axis).ravel()], axis=1)
        for axis in (1, 2, 3)
    ]
    return np.concatenate(pairs), np.repeat(np.arange(3), [len(one) for one in pairs])


def _rows_of(edges: Edges, rest: Points, has_several: bool) -> Bools:
    """Return which springs (e, 2) pull at each of their ends, (2, e).

    What lies on a side between patches is pulled at by springs in that side only: so both patches
    find it at one place, whatever is within them.
    """
    if not has_several:
        return np.ones((2, len(edges)), dtype=np.bool_)
    on_side = np.concatenate([rest[:, :2] == 0.0, rest[:, :2] == 1.0], axis=1)  # (n, 4)
    one, other = on_side[edges[:, 0]], on_side[edges[:, 1]]
    return np.stack([(other | ~one).all(axis=1), (one | ~other).all(axis=1)])


def _seams(mapping: CellMap, coordinate: int) -> Ints:
    """Return the place of the grid that each place must share a coordinate with, (n,)."""
    count = _count(mapping.patches)
    number = np.arange(mapping.patches * count**3).reshape(-1, count, count, count)
    for axis in range(3):
        if mapping.wraps[axis] and axis != coordinate:
            ends = np.moveaxis(number, axis + 1, 0)  # a view
            ends[-1] = ends[0]
    return number.reshape(-1)


def _at_rest(edges: Edges, stiffness: Floats, pulls: Bools, rest: Floats, same: Ints) -> Floats:
    """Return one coordinate of all places where springs are at rest, its two sides held.

    Parameters
    ----------
    edges, stiffness : springs, (e, 2) and (e,)
    pulls : (2, e) whether each pulls at either of its ends
    rest : (n,) the coordinate before
    same : (n,) the place that each place moves with
    """
    count = len(rest)
    pairs = same[edges]
    ends = np.concatenate([pairs, pairs[:, ::-1]])
    weights = np.concatenate([stiffness, stiffness]) * pulls.reshape(-1)
    joined = csr_array(coo_array((weights, (ends[:, 0], ends[:, 1])), shape=(count, count)))
    held: Bools = (rest == 0.0) | (rest == 1.0)
    free = np.flatnonzero(~held & (same == np.arange(count)))
    rows = joined[free]
    total = np.asarray(rows.sum(axis=1)).reshape(-1)
    diagonal = coo_array((total, (np.arange(len(free)),) * 2), shape=(len(free),) * 2)
    moved = rest.copy()
    moved[free] = spsolve(
        (diagonal - rows[:, free]).tocsc(), rows[:, np.flatnonzero(held)] @ rest[held]
    )
    return moved[same]
