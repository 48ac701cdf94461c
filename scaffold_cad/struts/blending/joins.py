"""Which sides of a node's patches meet, and which nodes are of the same combinatorial type.

Side 4 i + k is arc k of quad i. A node's type is its table of twin sides, numbered in the order
in which a walk finds them: from a first side around its quad, then across the sides in turn. Of
all first sides the one is taken whose table is least.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Frozen, Ints
from scaffold_cad.partition.arcs import side_twins


@dataclass(frozen=True, eq=False)
class Types(Frozen):
    """M nodes of valency N by their combinatorial types."""

    twins: Ints
    """Twin of each side, numbered as in the type, shape (T, 4 N)."""
    type_of: Ints
    """Type of each node, shape (M,)."""
    sides: Ints
    """Each node's own number of each side of its type, shape (M, 4 N)."""

    def parts(self, rows: Ints) -> tuple[tuple[slice, Ints], ...]:
        """Return where each type's nodes are among `rows`, by type, and its twins."""
        found, first = np.unique(self.type_of[rows], return_index=True)
        ends = [*first[1:].tolist(), len(rows)]
        return tuple(
            (slice(start, end), self.twins[kind])
            for start, end, kind in zip(first.tolist(), ends, found.tolist(), strict=True)
        )


def types_of(quads: Ints) -> Types:
    """Return the types of M closed partitions `quads` (M, N, 4)."""
    distinct, which = np.unique(quads.reshape(len(quads), -1), axis=0, return_inverse=True)
    codes, sides = _least_codes(side_twins(distinct.reshape(-1, *quads.shape[1:])))
    twins, type_of = np.unique(codes, axis=0, return_inverse=True)
    which = which.reshape(-1)
    return Types(twins, type_of.reshape(-1)[which], sides[which])


def _least_codes(twins: Ints) -> tuple[Ints, Ints]:
    """Return the least table of twins (U, 4 N) of each node, and its order of sides."""
    nodes, count = twins.shape
    table = np.repeat(twins, count, axis=0)  # one row for each first side
    row = np.arange(len(table))
    number = np.full(table.shape, -1, dtype=np.intp)
    order = np.zeros(table.shape, dtype=np.intp)
    found = np.zeros(len(table), dtype=np.intp)
    code = np.empty_like(table)

    def add(rows: Ints, first: Ints) -> None:
        for k in range(4):
            side = (first & ~3) | ((first + k) & 3)
            number[rows, side] = found[rows] + k
            order[rows, found[rows] + k] = side
        found[rows] += 4

    add(row, np.tile(np.arange(count), nodes))
    for place in range(count):
        twin = table[row, order[:, place]]
        new = np.flatnonzero(number[row, twin] < 0)
        add(new, twin[new])
        code[:, place] = number[row, twin]
    _, rank = np.unique(code, axis=0, return_inverse=True)
    best = rank.reshape(nodes, count).argmin(axis=1) + count * np.arange(nodes)
    return code[best], order[best]


def shared_numbers(twins: Ints, across: int, along: int) -> tuple[Ints, int]:
    """Return the numbers of grid points of the patches of a type, and how many there are.

    Points on an arc or a spoke have the same number in both of its patches.

    Parameters
    ----------
    twins : (4 N,) intp, the twin of each side
    across, along : points of each patch in the direction of u and of v

    Returns
    -------
    (4 N, across, along) intp, and their count, which depends on N, `across` and `along` only
    """
    sides = np.arange(len(twins))
    place = np.arange(len(twins) * across * along).reshape(-1, across, along)
    following = (sides & ~3) | ((sides + 1) & 3)
    one = np.concatenate([place[:, -1, :].reshape(-1), place[:, :, 0].reshape(-1)])
    two = np.concatenate([place[following, 0, :].reshape(-1), place[twins, ::-1, 0].reshape(-1)])
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(place.size, place.size))
    count, number = connected_components(graph, directed=False)
    return number.reshape(place.shape).astype(np.intp), int(count)


def valences(twins: Ints) -> Ints:
    """Return how many patches meet at the vertex that each side leaves, shape (4 N,).

    Parameters
    ----------
    twins : (4 N,) intp, the twin of each side
    """
    sides = np.arange(len(twins))
    before = (sides & ~3) | ((sides + 3) & 3)
    # Around a vertex: the side before, across it, and so on.
    turn = twins[before]
    count = np.ones(len(twins), dtype=np.intp)
    current = turn.copy()
    while (current != sides).any():
        count += current != sides
        current = np.where(current != sides, turn[current], current)
    return 2 * count
