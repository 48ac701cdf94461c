"""Grid points, faces between cells, and the tetrahedra on them, where the surface passes.

Two leaves of one size that share a face span four tetrahedra: both centers and a side of the face,
or eight where finer leaves put grid points at the middles of sides. A leaf beside a coarser one
has two pyramids on its face, one to each center, of two tetrahedra each; the face is cut from the
coarse face's center. Where a neighbor was left out, all of it is on one side of the surface and a
center is put where that of an equal leaf would be. So tetrahedra match across all their faces that
the surface can pass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.solid.field.cells import CHILDREN, Level, joined_lists, packed
from scaffold_cad.solid.field.lattice import Lattice
from scaffold_cad.solid.field.union import FilletedUnion, Lists, values

AROUND = np.array([[i % 3, i // 3 % 3, i // 9] for i in range(27)])
"""Grid points of a group, in its cells' sizes, shape (27, 3)."""


@dataclass(frozen=True, eq=False)
class Grid(Frozen):
    """Grid points and F there; groups of all levels are numbered one after the other."""

    lattice: Lattice
    levels: list[Level]
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
    """Packed places of the corners, ascending, shape (corners,)."""
    corner_of: NDArray[np.int32]
    """Grid points of each group, shape (g, 27), see `AROUND`."""


def grid_of(union: FilletedUnion, lattice: Lattice, levels: list[Level]) -> Grid:
    """Return the grid points of all groups, with F."""
    counts = np.array([len(level.groups) for level in levels])
    first = np.append(0, np.cumsum(counts))
    keys, centers = [], []
    for k, level in enumerate(levels):
        half = 1 << (k + 1)  # size of its leaves in half cells
        corners = (2 * level.groups * half)[:, None]
        keys.append(packed(corners + AROUND * half).reshape(-1))
        centers.append((corners + CHILDREN * half + half // 2).astype(np.int32).reshape(-1, 3))
    unique, seen, inverse = np.unique(
        np.concatenate(keys), return_index=True, return_inverse=True
    )
    lists = joined_lists([level.lists for level in levels])
    places = _places(unique)
    field = values(union, lattice.places(places), seen // 27, lists)
    return Grid(
        lattice=lattice,
        levels=levels,
        first=first,
        lists=lists,
        places=np.concatenate([places, *centers]),
        field=np.concatenate([field, *(level.centers.reshape(-1) for level in levels)]),
        corners=len(unique),
        keys=unique,
        corner_of=inverse.reshape(-1, 27).astype(np.int32),
    )


def _places(keys: NDArray[np.int64]) -> NDArray[np.int32]:
    mask = (1 << 21) - 1
    return (np.stack([keys & mask, keys >> 21 & mask, keys >> 42], axis=-1) - 1).astype(np.int32)


@dataclass(frozen=True, eq=False)
class Tetrahedra(Frozen):
    """Tetrahedra that the surface passes."""

    corners: NDArray[np.int32]
    """Grid points of each, shape (t, 4), positively oriented."""
    owners: NDArray[np.int32]
    """A group whose struts are all that matter in each, shape (t,)."""
    places: NDArray[np.int32]
    """Grid points with those put in for cells left out, shape (v', 3)."""
    inside: Bools
    """Whether each grid point is inside, shape (v',)."""


FACES: list[tuple[int, Ints, Ints, NDArray[np.intp]]] = []


def _face_tables() -> tuple[Ints, Ints]:
    """Return cells of a group on its low and high side of each axis, in one order, (3, 4) each."""
    low = np.array([[c for c in range(8) if not c >> a & 1] for a in range(3)])
    return low, low + (1 << np.arange(3))[:, None]


LOW, HIGH = _face_tables()

RIM = np.array(
    [
        [
            [
                sum(step * 3**axis for axis, step in zip(((a + 1) % 3, (a + 2) % 3), uv, strict=True))
                for uv in ((0, 0), (1, 0), (1, 1), (0, 1))
            ]
        ]
        for a in range(3)
    ]
)[:, 0]
"""Corners of the face of a cell at right angles to each axis, counter-clockwise seen from its far
side, as numbers in `AROUND` relative to the cell's low corner, shape (3, 4)."""

CELL = CHILDREN @ np.array([1, 3, 9])
"""The low corner of each cell as a number in `AROUND`, shape (8,)."""


class TetrahedraBuilder:
    """Collects the tetrahedra of a grid that the surface passes, level by level."""

    def __init__(self, grid: Grid) -> None:
        self.grid = grid
        self.inside = grid.field < 0  # (v,)
        self.extra_places: list[NDArray[np.int32]] = []
        self.extra_inside: list[Bools] = []
        self.count = len(grid.places)
        self.corners: list[NDArray[np.int32]] = []
        self.owners: list[NDArray[np.int32]] = []
        self.sorted_keys = []
        self.order = []
        for level in grid.levels:
            keys = packed(level.groups)
            order = np.argsort(keys, kind="stable")
            self.order.append(order)
            self.sorted_keys.append(keys[order])
        self.finest = min(
            (k for k, level in enumerate(grid.levels) if level.leaf.any()), default=0
        )

    def find(self, k: int, cells: Ints) -> Ints:
        """Return which group of level k stands at each cell (n, 3), or -1."""
        if k >= len(self.sorted_keys) or len(self.sorted_keys[k]) == 0:
            return np.full(len(cells), -1)
        keys, sorted_keys = packed(cells), self.sorted_keys[k]
        at = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
        return np.where(sorted_keys[at] == keys, self.order[k][at], -1)

    def level(self, k: int) -> None:
        """Add the tetrahedra at the faces of the leaves of level k."""
        level = self.grid.levels[k]
        if not level.leaf.any():
            return
        everything = np.arange(len(level.groups))
        for axis in range(3):
            self.equal(k, axis, everything, LOW[axis], everything, HIGH[axis])
            step = np.eye(3, dtype=np.intp)[axis]
            ahead = self.find(k, level.groups + step)
            met = ahead >= 0
            self.equal(k, axis, everything[met], HIGH[axis], ahead[met], LOW[axis])
            self.border(k, axis, everything[~met], HIGH[axis], 1)
            behind = self.find(k, level.groups - step)
            self.border(k, axis, everything[behind < 0], LOW[axis], -1)

    def equal(self, k: int, axis: int, a: Ints, cells_a: Ints, b: Ints, cells_b: Ints) -> None:
        """Add what is between cells of groups a and those behind them, of groups b."""
        level = self.grid.levels[k]
        for cell_a, cell_b in zip(cells_a.tolist(), cells_b.tolist(), strict=True):
            both = level.leaf[a, cell_a] & level.leaf[b, cell_b]
            group_a, group_b = a[both] + self.grid.first[k], b[both] + self.grid.first[k]
            rim = self.grid.corner_of[group_b[:, None], CELL[cell_b] + RIM[axis]]  # (f, 4)
            before = self.grid.corners + 8 * group_a + cell_a
            behind = self.grid.corners + 8 * group_b + cell_b
            self.spanned(k, group_a, before, behind, rim)

    def border(self, k: int, axis: int, a: Ints, cells: Ints, way: int) -> None:
        """Add what is between cells of groups a and coarser leaves beside them, or none."""
        if len(a) == 0:
            return
        level = self.grid.levels[k]
        step = way * np.eye(3, dtype=np.intp)[axis]
        beside = level.groups[a] + step
        coarse = self.find(k + 1, beside >> 1)
        alone = a[coarse < 0]
        groups, coarse = a[coarse >= 0], coarse[coarse >= 0]
        for cell in cells.tolist():
            rim_of = CELL[cell] + (3**axis if way > 0 else 0) + RIM[axis]
            leaf = level.leaf[alone, cell]
            self.beside_nothing(k, step, way, alone[leaf] + self.grid.first[k], cell, rim_of)
            leaf = level.leaf[groups, cell]
            self.beside_coarse(k, step, way, groups[leaf], cell, rim_of, coarse[leaf])

    def beside_nothing(
        self, k: int, step: Ints, way: int, group: Ints, cell: int, rim_of: Ints
    ) -> None:
        """Add what is between a cell and a neighbor that was left out."""
        rim = self.grid.corner_of[group[:, None], rim_of]
        before = self.grid.corners + 8 * group + cell
        out = self.inside[rim[:, 0]]
        needed = self.inside[before] != out
        group, rim, before, out = group[needed], rim[needed], before[needed], out[needed]
        behind = self.count + np.arange(len(group))
        self.count += len(group)
        self.extra_places.append((self.grid.places[before] + step * (2 << k)).astype(np.int32))
        self.extra_inside.append(out)
        self.spanned(k, group, *((before, behind) if way > 0 else (behind, before)), rim)

    def beside_coarse(
        self, k: int, step: Ints, way: int, local: Ints, cell: int, rim_of: Ints, coarse: Ints
    ) -> None:
        """Add the pyramids on the face between a cell and a coarser leaf."""
        if len(local) == 0:
            return
        group = local + self.grid.first[k]
        rim = self.grid.corner_of[group[:, None], rim_of]  # (f, 4)
        before = self.grid.corners + 8 * group + cell
        beside = self.grid.levels[k].groups[local] + step
        owner = coarse + self.grid.first[k + 1]
        child = (beside & 1) @ np.array([1, 2, 4])
        behind = self.grid.corners + 8 * owner + child
        # The diagonal runs through the center of the coarse face: that corner of the rim goes first.
        axes = [axis for axis in range(3) if step[axis] == 0]
        middle = self.grid.places[behind]  # (f, 3)
        from_middle = np.abs(self.grid.places[rim] - middle[:, None])[:, :, axes].sum(axis=2)
        turn = np.argmin(from_middle, axis=1)
        rim = np.take_along_axis(rim, (turn[:, None] + np.arange(4)) % 4, axis=1)
        if way > 0:
            self.pyramids(group, before, rim, ahead=True)
            self.pyramids(owner, behind, rim, ahead=False)
        else:
            self.pyramids(group, before, rim, ahead=False)
            self.pyramids(owner, behind, rim, ahead=True)

    def pyramids(self, owner: Ints, apex: Ints, rim: Ints, ahead: bool) -> None:
        """Add the two tetrahedra of each pyramid; the rim is ahead of the apex or behind it."""
        for i, j in ((1, 2), (2, 3)):
            p, q = (i, j) if ahead else (j, i)
            self.add(np.stack([apex, rim[:, 0], rim[:, p], rim[:, q]], axis=1), owner)

    def spanned(self, k: int, owner: Ints, before: Ints, behind: Ints, rim: Ints) -> None:
        """Add the tetrahedra of two centers and each side of the rim between them."""
        middles = self.middles(k, rim)
        sure = self.inside_of(before)
        some = self.inside_of(behind) != sure
        for i in range(4):
            some |= self.inside[rim[:, i]] != sure
            if middles is not None:
                some |= (middles[:, i] >= 0) & (self.inside[middles[:, i]] != sure)
        owner, before, behind, rim = owner[some], before[some], behind[some], rim[some]
        for i in range(4):
            p, q = rim[:, i], rim[:, (i + 1) % 4]
            if middles is None:
                self.add(np.stack([before, behind, p, q], axis=1), owner)
                continue
            middle = middles[some, i]
            whole, split = middle < 0, middle >= 0
            self.add(np.stack([before, behind, p, q], axis=1)[whole], owner[whole])
            self.add(np.stack([before, behind, p, middle], axis=1)[split], owner[split])
            self.add(np.stack([before, behind, middle, q], axis=1)[split], owner[split])

    def middles(self, k: int, rim: Ints) -> Ints | None:
        """Return the grid points at the middles of the rims' sides, -1 where none, (f, 4)."""
        if k <= self.finest:
            return None
        ends = self.grid.places[rim]  # (f, 4, 3)
        keys = packed((ends + np.roll(ends, -1, axis=1)) >> 1)
        at = np.minimum(np.searchsorted(self.grid.keys, keys), len(self.grid.keys) - 1)
        return np.where(self.grid.keys[at] == keys, at, -1)

    def inside_of(self, points: Ints) -> Bools:
        """Return whether grid points are inside, those put in among them."""
        if len(points) == 0 or points.max() < len(self.inside):
            return self.inside[points]
        base = len(self.inside)
        latest = self.extra_inside[-1]
        offset = self.count - len(latest)
        return np.where(
            points < base, self.inside[np.minimum(points, base - 1)], latest[points - offset]
        )

    def add(self, corners: Ints, owner: Ints) -> None:
        """Add those of the tetrahedra (t, 4) that have corners on both sides."""
        sides = np.stack([self.inside_of(corners[:, i]) for i in range(4)])
        count = sides.sum(axis=0)
        some = (count > 0) & (count < 4)
        self.corners.append(corners[some].astype(np.int32))
        self.owners.append(owner[some].astype(np.int32))

    def result(self) -> Tetrahedra:
        """Return what was added."""
        return Tetrahedra(
            corners=np.concatenate([np.zeros((0, 4), np.int32), *self.corners]),
            owners=np.concatenate([np.zeros(0, np.int32), *self.owners]),
            places=np.concatenate([self.grid.places, *self.extra_places]),
            inside=np.concatenate([self.inside, *self.extra_inside]),
        )


def tetrahedra_of(grid: Grid) -> Tetrahedra:
    """Return the tetrahedra of a grid that the surface passes."""
    builder = TetrahedraBuilder(grid)
    for k in range(len(grid.levels)):
        builder.level(k)
    return builder.result()
