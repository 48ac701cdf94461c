"""Contours: closed lines around where a function of the plane is negative, on squares of a grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.layers.loops import Loops, cycles

BITS = 22
"""Bits of each place along a side of the grid: 4 million squares."""

OUTSIDE = 1.0
"""Value at grid points where it is not known."""

TINY = 1e-300
"""Least difference between values outside and inside."""

ROUNDS = 3
"""Times that a place between grid points is corrected where values are not linear."""

Between: TypeAlias = Callable[[Ints, Floats], Floats]
"""Gives values at places (q, 2) beside grid points of some keys (q,)."""

CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
"""Corners of a square, counter-clockwise, in its sides, shape (4, 2)."""


def keys_of(levels: Ints, places: Ints) -> Ints:
    """Return one number for each grid point (p, 2), its places > 0, at a level (p,)."""
    return (levels << (2 * BITS)) | (places[:, 0] << BITS) | places[:, 1]


def unpacked(keys: Ints) -> tuple[Ints, Ints]:
    """Return the levels (p,) and the places (p, 2) of the keys of grid points."""
    mask = (1 << BITS) - 1
    return keys >> (2 * BITS), np.stack([keys >> BITS & mask, keys & mask], axis=1)


def widened(keys: Ints, marks: Bools) -> Bools:
    """Return which of some grid points are marked, or beside one that is, (p,).

    Parameters
    ----------
    keys : of the grid points, ascending, shape (p,)
    """
    found = marks
    for step in (1, 1 << BITS):  # along one side, then the other: corners too
        marks = found
        for beside in (keys - step, keys + step):
            at = np.minimum(np.searchsorted(keys, beside), len(keys) - 1)
            found = found | ((keys[at] == beside) & marks[at])
    return found


@dataclass(frozen=True, eq=False)
class _Crossings(Frozen):
    """Where the contour enters and leaves squares, the inside to its left."""

    square: Ints
    """Key of each square that is crossed, shape (q,)."""
    enters: Ints
    """The side through which, k from corner k to the next, shape (q,)."""
    leaves: Ints
    """Shape (q,)."""


def contours(
    keys: Ints, values: Floats, cell: float, first: Ints, between: Between | None = None
) -> Loops:
    """Return the polygons around where values are negative, counter-clockwise around that.

    Parameters
    ----------
    keys : of grid points, ascending, shape (p,), see `keys_of`
    values : at these points, shape (p,); all others are outside
    cell : side of the squares, mm
    first : what places of 0 stand for, shape (2,), in squares
    between : gives values at places (q, 2) between grid points, the inner one of which has the
        key (q,); by default they are linear
    """
    squares = np.unique(_around(keys[values < 0]))
    corners = _values_at(keys, values, _corners(squares))  # (s, 4)
    found = _crossings(squares, corners)
    sides = _sides(found.square, found.leaves)
    order = np.argsort(sides)
    after = order[np.searchsorted(sides[order], _sides(found.square, found.enters))]
    # The crossing after each is that of the square which is entered where it leaves.
    follower = np.empty_like(after)
    follower[after] = np.arange(len(after))
    label, rank = cycles(follower)
    level = found.square >> (2 * BITS)
    order = np.lexsort((rank, label, level))
    begins = np.flatnonzero(rank[order] == 0)
    points = _points(keys, values, found, between)[order]
    at = np.append(begins, len(order))
    return Loops((points + first) * cell, at, level[order[begins]])


def _around(keys: Ints) -> Ints:
    """Return the squares that have each grid point (p,) as a corner, shape (4 p,)."""
    steps = (CORNERS[:, 0] << BITS) | CORNERS[:, 1]
    squares: Ints = keys[:, None] - steps
    return squares.reshape(-1)


def _corners(squares: Ints) -> Ints:
    """Return the keys of the corners of squares (s,), shape (s, 4)."""
    steps = (CORNERS[:, 0] << BITS) | CORNERS[:, 1]
    return np.asarray(squares[:, None] + steps)


def _values_at(keys: Ints, values: Floats, wanted: Ints) -> Floats:
    """Return the values at grid points, of the same shape; `OUTSIDE` where none is known."""
    if len(keys) == 0:
        return np.full(wanted.shape, OUTSIDE)
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[at] == wanted, values[at], OUTSIDE)


def _crossings(squares: Ints, corners: Floats) -> _Crossings:
    """Return where the contour crosses squares whose corners have values (s, 4)."""
    inside: Bools = corners < 0
    after = np.roll(inside, -1, axis=1)
    # Going around counter-clockwise the contour enters where the inside begins to be left of it:
    # through sides from inside to outside, and leaves through those from outside to inside.
    enters, leaves = inside & ~after, ~inside & after
    rows, sides = np.nonzero(enters)
    twice = enters.sum(axis=1) == 2
    joined = twice & (corners.sum(axis=1) < 0)  # where the middle is inside both parts are one
    # From the side that is entered to the next one that is left: backwards around an inside
    # corner, or forwards where both inside corners are joined.
    step = np.where(joined[rows], 1, -1)
    out = sides
    for _ in range(3):
        open_ones = ~leaves[rows, out]
        out = np.where(open_ones, (out + step) % 4, out)
    return _Crossings(squares[rows], sides, out)


def _sides(squares: Ints, sides: Ints) -> Ints:
    """Return one number for each side (q,) of squares, the same from both of its squares."""
    along_y = sides % 2
    corner = np.where((sides == 0) | (sides == 3), 0, np.where(sides == 1, 1, 3))
    start = squares + ((CORNERS[corner, 0] << BITS) | CORNERS[corner, 1])
    return np.asarray((start << 1) | along_y)


def _points(keys: Ints, values: Floats, found: _Crossings, between: Between | None) -> Floats:
    """Return where the contour leaves squares, in places of the grid, shape (q, 2)."""
    ends = [CORNERS[found.leaves], CORNERS[(found.leaves + 1) % 4]]  # outside, inside
    outer, inner = (found.square + ((end[:, 0] << BITS) | end[:, 1]) for end in ends)
    above, below = (_values_at(keys, values, each) for each in (outer, inner))
    start, step = unpacked(outer)[1], ends[1] - ends[0]
    low, high = np.zeros(len(start)), np.ones(len(start))  # shares of the way inside
    for _ in range(ROUNDS):
        if between is None:
            break
        share = low + (high - low) * above / np.maximum(above - below, TINY)
        value = between(inner, start + share[:, None] * step)
        is_outside = value > 0
        # The end that stays counts half, so that both ends move.
        low, above = np.where(is_outside, share, low), np.where(is_outside, value, above / 2)
        high, below = np.where(is_outside, high, share), np.where(is_outside, below / 2, value)
    share = low + (high - low) * above / np.maximum(above - below, TINY)
    points: Floats = start + share[:, None] * step
    return points
