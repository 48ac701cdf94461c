"""Grid points: corners and centers of the leaves that the surface may pass, and F there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points
from scaffold_cad.solid.field.cells import CHILDREN, Level, joined_lists, packed, unpacked
from scaffold_cad.solid.field.lattice import Lattice
from scaffold_cad.solid.field.union import FilletedUnion, Lists, values

AROUND = np.array([[i % 3, i // 3 % 3, i // 9] for i in range(27)])
"""Grid points of a group in its cells' sizes, or of a cell in half cells, shape (27, 3)."""


RIM_STEPS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Corners of a face in steps along the two axes after that at right angles to it."""


def rim_corners(axis: int, ahead: bool) -> Ints:
    """Return the corners 0..7 of a cell on a face, counter-clockwise seen from ahead, (4,)."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    return np.array([(i << u) + (j << v) + (int(ahead) << axis) for i, j in RIM_STEPS])


def rim_of(child: int, axis: int, ahead: bool) -> Ints:
    """Return `rim_corners` of a cell of a group as points in `AROUND`, shape (4,)."""
    around: Ints = (CHILDREN[child] + CHILDREN[rim_corners(axis, ahead)]) @ np.array([1, 3, 9])
    return around


class Register:
    """Finds a group of one level by its place."""

    def __init__(self, groups: Ints) -> None:
        keys = packed(groups)
        self._order = np.argsort(keys, kind="stable")
        self._keys = keys[self._order]

    def find(self, cells: NDArray[np.integer]) -> Ints:
        """Return which group stands at each cell (n, 3), or -1, shape (n,)."""
        if len(self._keys) == 0:
            return np.full(len(cells), -1)
        keys = packed(cells)
        at = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return np.where(self._keys[at] == keys, self._order[at], -1)


@dataclass(frozen=True, eq=False)
class Grid(Frozen):
    """Grid points and F there; groups of all levels are numbered one after the other."""

    lattice: Lattice
    levels: list[Level]
    registers: list[Register]
    first: Ints
    """Number of the first group of each level, shape (levels + 1,)."""
    lists: Lists
    """Struts of each group."""
    places: NDArray[np.int32]
    """Grid points in half cells from the grid's corner, shape (v, 3): corners, then the center of
    cell c of group g at `corners + 8 g + c`."""
    field: Floats
    """F at each grid point, shape (v,); inside where it is < 0."""
    corners: int
    """Number of corners."""
    keys: NDArray[np.int64]
    """Packed places of the corners, ascending, where there are several levels; (corners,)."""
    corner_of: NDArray[np.int32]
    """Corners of the cells of each group, shape (g, 27), see `AROUND`."""

    @property
    def cells(self) -> int:
        """Number of cells of all groups."""
        return 8 * int(self.first[-1])

    def groups_at(self, points: Points) -> Ints:
        """Return the finest group at local points (k, 3), or -1, shape (k,)."""
        found = np.full(len(points), -1)
        for k, (level, register) in enumerate(zip(self.levels, self.registers, strict=True)):
            if len(level.groups) == 0:
                continue
            rows = np.flatnonzero(found < 0)
            size = self.lattice.cell * 2.0 ** (k + 1)
            group = register.find(np.floor(points[rows] / size).astype(np.intp))
            found[rows] = np.where(group >= 0, group + self.first[k], -1)
        return found


def grid_of(union: FilletedUnion, lattice: Lattice, levels: list[Level]) -> Grid:
    """Return the grid points of all groups, with F."""
    first = np.append(0, np.cumsum([len(level.groups) for level in levels]))
    registers = [Register(level.groups) for level in levels]
    places, points, seen, centers = [], [], [], []
    count = 0
    for k, level in enumerate(levels):
        half = 1 << (k + 1)  # size of its cells in half cells
        found, point, owner = _corners(level, registers[k])
        places.append((found * half).astype(np.int32))
        points.append(point + count)
        seen.append(owner + first[k])
        count += len(found)
        middles = (2 * level.groups[:, None] + CHILDREN) * half + half // 2
        centers.append(middles.astype(np.int32).reshape(-1, 3))
    corner_of, owners = np.concatenate(points), np.concatenate(seen)
    corners, keys = np.concatenate(places), np.zeros(0, dtype=np.int64)
    if sum(len(level.groups) > 0 for level in levels) > 1:  # corners of several levels may agree
        keys, kept, number = np.unique(packed(corners), return_index=True, return_inverse=True)
        corners, owners, corner_of = corners[kept], owners[kept], number[corner_of]
    lists = joined_lists([level.lists for level in levels])
    places_of = np.concatenate([corners, *centers])
    owners = np.concatenate([owners, np.repeat(np.arange(int(first[-1])), 8)])
    return Grid(
        lattice=lattice,
        levels=levels,
        registers=registers,
        first=first,
        lists=lists,
        places=places_of,
        field=values(union, lattice.places(places_of), owners, lists),
        corners=len(corners),
        keys=keys,
        corner_of=corner_of.astype(np.int32),
    )


def _corners(level: Level, register: Register) -> tuple[Ints, Ints, Ints]:
    """Return the corners of the cells of a level.

    Each belongs to the group whose low corner, or a point half a group from it, it is, if that
    group is there.

    Returns
    -------
    places in cells of the level (p, 3); the corners of each group (g, 27); a group at each (p,)
    """
    count = len(level.groups)
    point = np.zeros((count, 27), dtype=np.int64)
    low = 2 * level.groups[:, None]
    lost, lost_keys = [], []
    for corner in CHILDREN:
        these = np.flatnonzero((corner == AROUND >> 1).all(axis=1))
        owner = register.find(level.groups + corner) if corner.any() else np.arange(count)
        inner = AROUND[these] & 1
        point[:, these] = 8 * owner[:, None] + inner @ np.array([1, 2, 4])
        rows = np.flatnonzero(owner < 0)
        lost.append((rows[:, None], these))
        lost_keys.append(packed(low[rows] + AROUND[these]).reshape(-1))
    keys, seen, number = np.unique(
        np.concatenate(lost_keys), return_index=True, return_inverse=True
    )
    begin, found_by = 0, []
    for rows, these in lost:
        size = len(rows) * len(these)
        point[rows, these] = 8 * count + number[begin : begin + size].reshape(len(rows), len(these))
        found_by.append(np.repeat(rows[:, 0], len(these)))
        begin += size
    own = (low + CHILDREN).reshape(-1, 3)
    owners = np.concatenate([np.repeat(np.arange(count), 8), np.concatenate(found_by)[seen]])
    return np.concatenate([own, unpacked(keys)]), point, owners
