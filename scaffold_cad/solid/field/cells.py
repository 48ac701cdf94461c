"""Which cells the surface may pass: an octree around it, refined by the radii of the struts.

Cells come in groups of eight, the children of one cell. Bounds on the distances prove of most cells
that the whole of them, with the ball around them, is inside one strut or outside all fillets. A
group is kept where this is not so for one of its leaves, the cells that are not refined, and then
all its leaves are kept. Leaves that touch differ by one level at most.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.blocks import CACHE, uneven_blocks
from scaffold_cad.base.counts import tracked
from scaffold_cad.base.memory import MOST_MEMORY, machine_memory
from scaffold_cad.base.threads import in_order
from scaffold_cad.errors import OptionError
from scaffold_cad.solid.field.lattice import Lattice, least_cells
from scaffold_cad.solid.field.union import (
    FilletedUnion,
    Lists,
    any_of,
    least_values,
)

PAIR_BYTES = 128
"""What a pair of group and strut takes where it is refined."""

SAFETY = 1.0 + 1e-9
"""Factor on radii of balls around cells, for rounding."""

CHILDREN = np.array([[c & 1, c >> 1 & 1, c >> 2] for c in range(8)])
"""Place of each of a group's cells in it, shape (8, 3)."""

MOST_GROUPS = 10_000_000
"""Most groups of eight cells of one solid."""

GROUP_BYTES = 2500
"""Memory that a group takes at the peak, with its triangles."""

GROWTH = 2
"""Groups of the next finer level, at least, for each group to be refined."""


@dataclass(frozen=True, eq=False)
class Level(Frozen):
    """Groups of one size, and the struts that matter in each."""

    groups: Ints
    """Place of each group, in its own sizes from the grid's corner, shape (g, 3)."""
    lists: Lists
    """Struts of each group."""
    leaf: Bools
    """Which of its cells are not refined, shape (g, 8)."""

    def has_leaves(self, groups: Ints, children: Ints | int) -> Bools:
        """Return whether a child of each of some groups (k,) is a leaf; group -1 has none."""
        there = np.flatnonzero(groups >= 0)
        result = np.zeros(len(groups), dtype=np.bool_)
        result[there] = self.leaf[groups[there], np.broadcast_to(children, groups.shape)[there]]
        return result


def levels_of(
    union: FilletedUnion, lattice: Lattice, wanted: Callable[[Floats, Ints], Floats]
) -> list[Level]:
    """Return the groups of each level, those of two finest cells a side first.

    Parameters
    ----------
    wanted : gives the largest cells, mm, from the local radii of struts and their numbers

    Raises
    ------
    OptionError
        If there are more than `MOST_GROUPS`, or more than the machine's memory holds.
    """
    everything = np.arange(union.rows.shape[1])
    level = Level(
        groups=np.zeros((1, 3), dtype=np.intp),
        lists=Lists(np.array([0, len(everything)]), everything),
        leaf=np.zeros((1, 8), dtype=np.bool_),
    )
    groups, lists, found, total = level.groups, level.lists, [], 0
    for size in range(lattice.levels, 0, -1):
        level, groups, lists = _refined(union, lattice, wanted, size, groups, lists)
        total += len(level.groups)
        check_size(total + len(groups) * GROWTH ** (size - 1))
        found.append(level)
    return balanced(_with_leaves(found[::-1]))


def _with_leaves(levels: list[Level]) -> list[Level]:
    """Return the levels with those refined cells as leaves of which nothing finer was kept.

    The surface passes none of them, but a coarser leaf beside them has to find what is there.
    """
    result = []
    held = np.zeros(0, dtype=np.int64)  # cells that hold a group of a finer level
    for level in levels:
        cells = packed(2 * level.groups[:, None] + CHILDREN)  # (g, 8)
        result.append(Level(level.groups, level.lists, level.leaf | ~np.isin(cells, held)))
        held = np.union1d(packed(level.groups), np.unique(packed(unpacked(held) >> 1)))
    return result


def check_size(groups: float) -> None:
    """Raise if there are more than `MOST_GROUPS` groups, or the machine's memory holds."""
    most = min(MOST_GROUPS, MOST_MEMORY * machine_memory() / GROUP_BYTES)
    if groups > most:
        raise OptionError(
            f"the solid of overlapping struts needs some {8 * groups:.2g} cells or more and "
            f"{memory_of(groups):.0f} GB of memory; need at most {8 * most:.2g} cells here: "
            "thicker struts or walls, fewer sides (down to 16), fewer struts, or tiles of them"
        )


def memory_of(groups: float) -> float:
    """Return the memory that `count` groups take, GB."""
    return groups * GROUP_BYTES / 1e9


def _refined(
    union: FilletedUnion,
    lattice: Lattice,
    wanted: Callable[[Floats, Ints], Floats],
    size: int,
    groups: Ints,
    lists: Lists,
) -> tuple[Level, Ints, Lists]:
    """Return the level of some groups, and the groups of the next finer level."""
    pieces = list(uneven_blocks(np.diff(lists.starts), PAIR_BYTES, CACHE))
    refined = in_order(
        lambda some: _refine_some(union, lattice, wanted, size, groups[some], _sub(lists, some)),
        pieces,
    )
    sizes = [8 * len(groups[some]) for some in pieces]
    parts = list(tracked("cells", refined, sizes))
    kept = [part[0] for part in parts]
    finer = [part[1] for part in parts]
    level = Level(
        groups=np.concatenate([part.groups for part in kept]) if kept else groups[:0],
        lists=joined_lists([part.lists for part in kept]),
        leaf=np.concatenate([part.leaf for part in kept]) if kept else np.zeros((0, 8), np.bool_),
    )
    next_groups = np.concatenate([part[0] for part in finer]) if finer else groups[:0]
    return level, next_groups, joined_lists([part[1] for part in finer])


def _refine_some(
    union: FilletedUnion,
    lattice: Lattice,
    wanted: Callable[[Floats, Ints], Floats],
    size: int,
    groups: Ints,
    lists: Lists,
) -> tuple[Level, tuple[Ints, Lists]]:
    """Do as `_refined` for a block of groups."""
    cells = (2 * groups[:, None] + CHILDREN).reshape(-1, 3)  # (8 g, 3)
    edge = lattice.cell * 2.0 ** (size - 1)
    ball = np.sqrt(0.75) * edge * SAFETY
    which, struts, starts = lists.of(np.repeat(np.arange(len(groups)), 8))
    centers = (cells + 0.5) * edge
    distance, place = union.distances(centers[which], struts)
    blend = union.blend[struts]
    near = distance - ball  # the least distance in the cell
    whole = any_of(distance + ball < 0, starts)
    least = least_values(near / blend, starts)
    active = ~whole & (least <= 0)
    kept = (near < blend) & active[which]
    refine = np.zeros(len(cells), dtype=np.bool_)
    if size > 1:
        asked = np.full(len(which), np.inf)
        asked[kept] = wanted(union.local_radii(place[kept], struts[kept], ball), struts[kept])
        if union.capped:
            asked[kept] *= union.rim_sizes(centers[which[kept]], struts[kept], ball)
        smallest = np.minimum.reduceat(asked, starts)
        refine = active & (edge > smallest * SAFETY)
        far = least_cells(np.abs(centers + lattice.origin) + edge)
        refine &= edge / 2 >= far
    rows = np.flatnonzero((active & ~refine).reshape(-1, 8).any(axis=1))
    level = Level(
        groups=groups[rows],
        lists=_sub(lists, rows),
        leaf=~refine.reshape(-1, 8)[rows],
    )
    pairs = kept & refine[which]
    counts = np.add.reduceat(pairs.astype(np.intp), starts)[refine]
    return level, (cells[refine], Lists(np.append(0, np.cumsum(counts)), struts[pairs]))


def balanced(levels: list[Level]) -> list[Level]:
    """Return the levels with leaves refined until those that touch differ by one level at most."""
    used = [k for k, level in enumerate(levels) if len(level.groups) and level.leaf.any()]
    if len(used) < 2:
        return levels
    needed = [np.zeros(0, dtype=np.int64)]  # cells that hold neighbors of groups one level below
    for level in levels[:-1]:
        cells = unpacked(np.union1d(packed(level.groups), needed[-1]))
        around = [(cells + 2 * corner - 1) >> 1 for corner in CHILDREN]
        needed.append(np.unique(packed(np.concatenate(around))))
    result = list(levels)
    for k in range(len(levels) - 1, 0, -1):
        result[k - 1 : k + 1] = _split(result[k - 1], result[k], needed[k - 1])
    return result


def _split(
    fine: Level,
    coarse: Level,
    needed: NDArray[np.int64],
) -> list[Level]:
    """Return two levels that follow each other, with the leaves refined whose keys are needed."""
    cells = 2 * coarse.groups[:, None] + CHILDREN  # (g, 8, 3)
    split = coarse.leaf & np.isin(packed(cells), needed)
    if not split.any():
        return [fine, coarse]
    parents = np.nonzero(split)[0]
    groups = cells[split]
    lists = _sub(coarse.lists, parents)
    finer = Level(
        groups=np.concatenate([fine.groups, groups]),
        lists=joined_lists([fine.lists, lists]),
        leaf=np.concatenate([fine.leaf, np.ones((len(groups), 8), dtype=np.bool_)]),
    )
    return [finer, Level(coarse.groups, coarse.lists, coarse.leaf & ~split)]


def packed(cells: NDArray[np.integer]) -> NDArray[np.int64]:
    """Return whole numbers (..., 3), from -1 up, as one number each, (...)."""
    c = cells.astype(np.int64) + 1
    return c[..., 0] | c[..., 1] << 21 | c[..., 2] << 42


def unpacked(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the whole numbers that were `packed`, shape (..., 3)."""
    mask = (1 << 21) - 1
    return np.stack([keys & mask, keys >> 21 & mask, keys >> 42], axis=-1) - 1


def joined_lists(lists: list[Lists]) -> Lists:
    """Return lists one after the other."""
    if not lists:
        return Lists(np.zeros(1, dtype=np.intp), np.zeros(0, dtype=np.intp))
    counts = np.concatenate([np.diff(part.starts) for part in lists])
    return Lists(np.append(0, np.cumsum(counts)), np.concatenate([part.struts for part in lists]))


def _sub(lists: Lists, rows: Ints | slice) -> Lists:
    """Return the lists of some rows."""
    owners = np.arange(len(lists))[rows]
    _, struts, starts = lists.of(owners)
    return Lists(np.append(starts, len(struts)), struts)
