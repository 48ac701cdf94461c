"""Edges that leave a node in the same direction, made to follow each other."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Edges, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.topology import incidence
from scaffold_cad.base.vectors import length, normalize
from scaffold_cad.skeleton.splitting import distinct_edges, radii_on

LEAST_ANGLE = float(np.radians(0.01))
"""Least angle between two edges at a node, rad; a partition needs it between two directions.

Here the chord of the angle is compared with it, which is a little shorter than the angle."""

CROWD = 64
"""Valency above which a node's directions are compared through a tree, not each with each."""


def without_overlaps(nodes: Points, edges: Edges, sizes: Floats) -> tuple[Edges, Floats, int, int]:
    """Let an edge that leaves a node along a shorter one go on from the shorter one's end.

    Counts how often that was done and the edges that repeated another one then.
    """
    rerouted, repeated = 0, 0
    while True:
        longer, shorter = _next_shorter(nodes, edges)
        if len(longer) == 0:
            return edges, sizes, rerouted, repeated
        # Every change makes an edge shorter, so that this comes to an end.
        rerouted += len(longer)
        tails = edges.reshape(-1)
        widths = sizes.copy()
        widths.reshape(-1)[longer] = radii_on(nodes, edges, sizes, longer >> 1, tails[shorter ^ 1])
        edges = edges.copy()
        ends = edges.reshape(-1)
        # The longer half-edge leaves the shorter one's head from now on.
        ends[longer] = tails[shorter ^ 1]
        edges, sizes, _, dropped = distinct_edges(edges, widths, len(nodes))
        repeated += dropped


def _next_shorter(nodes: Points, edges: Edges) -> tuple[Ints, Ints]:
    """Return the half-edges that overlap a shorter one, and the longest of those shorter ones.

    All may change at once: what one of them no longer covers, the shorter one does, or those
    that it changes for.
    """
    pairs = overlapping_half_edges(nodes, edges)  # (k, 2)
    tails = edges.reshape(-1)
    lengths = length(nodes[tails[pairs ^ 1]] - nodes[tails[pairs]])
    swapped = lengths[:, 0] < lengths[:, 1]
    longer = np.where(swapped, pairs[:, 1], pairs[:, 0])
    shorter = np.where(swapped, pairs[:, 0], pairs[:, 1])
    order = np.lexsort([shorter, -lengths.min(axis=1, initial=np.inf), longer])
    # An edge changes at one end: at both, a bundle would turn round instead of becoming a path.
    _, first = np.unique(longer[order] >> 1, return_index=True)
    return longer[order][first], shorter[order][first]


def overlapping_half_edges(nodes: Points, edges: Edges) -> Edges:
    """Return pairs of half-edges that leave a node within `LEAST_ANGLE` of each other, (k, 2)."""
    leaving = incidence(edges, len(nodes))
    tails = edges.reshape(-1)
    valency = np.diff(leaving.offsets)
    found = [np.zeros((0, 2), dtype=np.intp)]
    for n in np.unique(valency[valency > 1]).tolist():
        half_edges = leaving.at_nodes(np.flatnonzero(valency == n), n)  # (k, n)
        spans = nodes[tails[half_edges ^ 1]] - nodes[tails[half_edges]]  # (k, n, 3)
        by_length = np.argsort(length(spans), axis=1, kind="stable")
        half_edges = np.take_along_axis(half_edges, by_length, axis=1)
        directions = normalize(np.take_along_axis(spans, by_length[:, :, None], axis=1))
        near = _near_in_rows if n <= CROWD else _near_in_trees
        row, first, second = near(directions)
        found.append(np.stack([half_edges[row, first], half_edges[row, second]], axis=1))
    return np.unique(np.sort(np.concatenate(found), axis=1), axis=0)


def _near_in_rows(directions: UnitVectors) -> tuple[Ints, Ints, Ints]:
    """Return row and columns of the close pairs in each row of `directions` (k, n, 3)."""
    n = directions.shape[1]
    rows, firsts, seconds = [], [], []
    for shift in range(1, n // 2 + 1):  # every pair once, or twice at shift n / 2
        gap = length(directions - np.roll(directions, -shift, axis=1))  # (k, n)
        row, first = np.nonzero(gap < LEAST_ANGLE)
        rows.append(row)
        firsts.append(first)
        seconds.append((first + shift) % n)
    return np.concatenate(rows), np.concatenate(firsts), np.concatenate(seconds)


def _near_in_trees(directions: UnitVectors) -> tuple[Ints, Ints, Ints]:
    """Return some close pairs in each row of `directions`, in less time where rows are long.

    Each direction that has a close one is in a pair; of a bundle of n, n - 1 pairs are given,
    of directions that follow each other in the row.
    """
    pairs = [_near_in_bundles(row) for row in directions]
    rows = np.repeat(np.arange(len(directions)), [len(found) for found in pairs])
    first, second = np.concatenate(pairs).T
    return rows, first, second


def _near_in_bundles(directions: UnitVectors) -> Edges:
    """Return the pairs of directions (n, 3) in one cell of a grid; if none, all close pairs."""
    # The diagonal of a cell is 0.87 of the angle; axes are in the middle of cells.
    cells = np.round(directions / (LEAST_ANGLE / 2)).astype(np.int64)
    order = np.lexsort(cells.T)
    same = (cells[order[1:]] == cells[order[:-1]]).all(axis=1)
    if same.any():
        return np.stack([order[:-1][same], order[1:][same]], axis=1)
    return cKDTree(directions).query_pairs(LEAST_ANGLE, output_type="ndarray")
