"""Which axis-aligned boxes overlap: the broad phase of every search for what meets.

The boxes are the leaves of a complete binary tree, sorted so that neighbors in space are
neighbors in it, and the tree is walked against itself level by level, with whole arrays.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Ints, Points
from scaffold_cad.base.counts import Count

PAIRS_AT_ONCE = 1 << 16
"""Pairs of boxes looked at together: some 10 MB, however many boxes there are."""

OnGrid: TypeAlias = NDArray[np.int64]
"""Coordinates on the grid, shape (3, n), each of 20 bits."""

Packed: TypeAlias = NDArray[np.int64]
"""Three coordinates on the grid in each number, with a spare bit above each, shape (n,)."""

GRID_BITS = 20
FIELD_BITS = GRID_BITS + 1
SPARE_BITS = sum(1 << (axis * FIELD_BITS + GRID_BITS) for axis in range(3))


@dataclass(frozen=True, eq=False)
class Spans:
    """Spans of things along three axes, rounded down to a grid of 2**20 steps.

    With the spare bits set in `highs`, `highs[i] - lows[j]` keeps them all just where span i ends
    nowhere below the start of span j: one subtraction compares three coordinates.
    """

    lows: Packed
    highs: Packed
    """Both shape (n,)."""

    def overlap(self, i: Ints, j: Ints) -> Bools:
        """Return which pairs overlap along all axes, (k,); rounding never parts spans that do."""
        low, high = self.lows, self.highs
        overlap: Bools = (high[i] - low[j]) & (high[j] - low[i]) & SPARE_BITS == SPARE_BITS
        return overlap


def spans_of(low: Points, high: Points) -> Spans:
    """Return the spans from `low` to `high` (n, 3)."""
    lows, highs = _on_grid(low, high)
    return Spans(_packed(lows), _packed(highs) | SPARE_BITS)


def overlapping_boxes(
    low: Points, high: Points, count: Count | None = None
) -> Iterator[tuple[Ints, Ints]]:
    """Yield blocks of pairs i < j of boxes that overlap, or nearly so; each pair comes once.

    Boxes that touch overlap. Boxes farther apart along any axis than two millionths of the extent
    of all boxes are not a pair.

    Parameters
    ----------
    low, high : (n, 3) float64, mm; lowest and highest corner of each box
    count : counts the boxes whose pairs were yielded

    Notes
    -----
    O(n log n) for boxes in general position.
    """
    order = order_in_space(low, high)
    for i, j in overlapping_neighbors(low[order], high[order], count):
        first, second = order[i], order[j]
        yield np.minimum(first, second), np.maximum(first, second)


def order_in_space(low: Points, high: Points) -> Ints:
    """Return an order of boxes (n, 3) in which neighbors in space are near each other, (n,)."""
    return np.argsort(_sorting_keys(*_on_grid(low, high)), kind="stable")


def overlapping_neighbors(
    low: Points, high: Points, count: Count | None = None
) -> Iterator[tuple[Ints, Ints]]:
    """Do as `overlapping_boxes` for boxes that are in their order in space already.

    Boxes whose pairs are yielded are counted in `count`.

    A block of pairs of one level of the tree gives a block of the next, and the latest goes
    first: only a few blocks a level ever wait.
    """
    tree = _box_tree(low, high)
    root = np.zeros(1, dtype=np.intp)
    waiting = [(0, root, root)]
    while waiting:
        level, i, j = waiting.pop()
        if level == len(tree) - 1:
            proper = (i < j) & (j < len(low))
            if count is not None:
                count.done += int(((i == j) & (j < len(low))).sum())
            yield i[proper], j[proper]
        elif len(i) > PAIRS_AT_ONCE:
            middle = len(i) // 2
            waiting += [(level, i[:middle], j[:middle]), (level, i[middle:], j[middle:])]
        else:
            waiting.append((level + 1, *_meeting_children(tree[level + 1], i, j)))


def _box_tree(low: Points, high: Points) -> list[Spans]:
    """Return the complete binary tree whose first leaves are the given boxes (n, 3).

    The root is first; boxes 2 k and 2 k + 1 of a level lie in box k of that above. The other leaves
    are empty.
    """
    count = len(low)
    depth = max(count - 1, 0).bit_length()
    lows = np.full((3, 2**depth), 2**GRID_BITS - 1, dtype=np.int64)
    highs = np.zeros((3, 2**depth), dtype=np.int64)
    lows[:, :count], highs[:, :count] = _on_grid(low, high)
    tree = [Spans(_packed(lows), _packed(highs) | SPARE_BITS)]
    for _ in range(depth):
        lows = np.minimum(lows[:, 0::2], lows[:, 1::2])
        highs = np.maximum(highs[:, 0::2], highs[:, 1::2])
        tree.append(Spans(_packed(lows), _packed(highs) | SPARE_BITS))
    return tree[::-1]


def _on_grid(low: Points, high: Points) -> tuple[OnGrid, OnGrid]:
    """Return the bounds of boxes (n, 3) rounded down to the grid, shapes (3, n)."""
    origin = low.min(axis=0, initial=np.inf)
    step = (high - origin).max(initial=1e-300) / (2**GRID_BITS - 1)
    lower, upper = (np.floor((bound - origin) / step).astype(np.int64).T for bound in (low, high))
    return lower, upper


def _packed(bounds: OnGrid) -> Packed:
    """Return the columns of `bounds` (3, n) packed, shape (n,)."""
    x, y, z = bounds
    packed: Packed = x | (y << FIELD_BITS) | (z << (2 * FIELD_BITS))
    return packed


def _sorting_keys(low: OnGrid, high: OnGrid) -> NDArray[np.int64]:
    """Return keys that sort boxes (3, n) by size, then along a Morton curve, shape (n,).

    A large box among small ones would enlarge every box above it in the tree.
    """
    _, exponents = np.frexp((high - low).max(axis=0) + 1.0)
    sizes = (exponents // 2).astype(np.int64)  # by factors of 4
    keys: NDArray[np.int64] = sizes << (3 * (GRID_BITS - 1))
    for axis, middle in enumerate((low + high) >> 2):
        keys |= _spread(middle) << axis
    return keys


def _spread(values: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return `values` below 2**21 with two zero bits put between their bits."""
    for shift, mask in (
        (32, 0x001F00000000FFFF),
        (16, 0x001F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        values = (values | (values << shift)) & mask
    return values


def _meeting_children(boxes: Spans, i: Ints, j: Ints) -> tuple[Ints, Ints]:
    """Return the pairs of boxes of a level that overlap, below the pairs i <= j above it."""
    i, j = np.repeat(2 * i, 4), np.repeat(2 * j, 4)
    i[2::4] += 1
    i[3::4] += 1
    j[1::2] += 1
    overlap = boxes.overlap(i, j)
    overlap &= i <= j  # the halves of one box meet each other once
    return i[overlap], j[overlap]
