"""Edges split at nodes on them, and without repeats."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Edges, Floats, Ints, Points
from scaffold_cad.base.blocks import uneven_blocks
from scaffold_cad.base.vectors import dot, length

CONTACT_BYTES = 64
"""What a pair of an edge and a node near it takes, as Python's number."""


def distinct_edges(edges: Edges, sizes: Floats, count: int) -> tuple[Edges, Floats, int, int]:
    """Return the edges without self-loops and repeats, in order, and how many of each went.

    Of repeated edges the largest radii at either end stay, (m, 2).
    """
    proper = edges[:, 0] != edges[:, 1]
    loops = len(edges) - int(proper.sum())
    edges, sizes = edges[proper], sizes[proper]
    keys = edges.min(axis=1) * count + edges.max(axis=1)
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    same_way = edges[:, 0] == edges[first[which], 0]
    merged = np.full((len(first), 2), np.nan)
    np.fmax.at(merged, which, np.where(same_way[:, None], sizes, sizes[:, ::-1]))
    order = np.argsort(first)
    return edges[first[order]], merged[order], loops, len(edges) - len(first)


def split_at_contacts(
    nodes: Points, edges: Edges, sizes: Floats, distance: float
) -> tuple[Edges, Floats, int, int]:
    """Split each edge at the nodes within `distance` of its inside; count those and repeats."""
    contacts = [
        _contacts(nodes, edges, edge, node, distance)
        for edge, node in _nodes_near_edges(nodes, edges, distance)
    ]
    edge, node = (np.concatenate(parts) for parts in zip(*contacts, strict=True))
    return split_at(nodes, edges, sizes, edge, node)


def split_at(
    nodes: Points, edges: Edges, sizes: Floats, edge: Ints, node: Ints
) -> tuple[Edges, Floats, int, int]:
    """Split each of some edges, (k,), at a node on it, (k,); count those and repeats.

    An edge may have several nodes, in any order. Radii of edges change evenly along them.
    """
    # The stops of each edge in order: its start, the nodes on it, its end.
    stops = np.concatenate([edges[:, 0], node, edges[:, 1]])
    owner = np.concatenate([np.arange(len(edges)), edge, np.arange(len(edges))])
    start = nodes[edges[edge, 0]]
    along = length(nodes[node] - start) / length(nodes[edges[edge, 1]] - start)
    place = np.concatenate([np.full(len(edges), -np.inf), along, np.full(len(edges), np.inf)])
    sequence = np.lexsort([place, owner])
    stops, owner = stops[sequence], owner[sequence]
    consecutive = owner[:-1] == owner[1:]
    pieces = np.stack([stops[:-1], stops[1:]], axis=1)[consecutive]
    at_stop = radii_on(nodes, edges, sizes, owner, stops)
    widths = np.stack([at_stop[:-1], at_stop[1:]], axis=1)[consecutive]
    distinct, widths, _, repeated = distinct_edges(pieces, widths, len(nodes))
    return distinct, widths, len(node), repeated


def radii_on(nodes: Points, edges: Edges, sizes: Floats, edge: Ints, node: Ints) -> Floats:
    """Return the radius of each of some edges beside a node on it, shape (k,)."""
    start, end = nodes[edges[edge, 0]], nodes[edges[edge, 1]]
    along = length(nodes[node] - start) / length(end - start)
    radii: Floats = sizes[edge, 0] + along * (sizes[edge, 1] - sizes[edge, 0])
    return radii


def _nodes_near_edges(nodes: Points, edges: Edges, distance: float) -> Iterator[tuple[Ints, Ints]]:
    """Yield blocks of edges and nodes no farther from an edge's middle than its ends are."""
    used = np.unique(edges)
    tree = cKDTree(nodes[used])
    start, end = nodes[edges[:, 0]], nodes[edges[:, 1]]
    middle, reach = (start + end) / 2, length(end - start) / 2 + distance
    number = np.asarray(tree.query_ball_point(middle, reach, return_length=True))  # (m,)
    for block in uneven_blocks(number, CONTACT_BYTES):
        rows = np.arange(block.start, block.stop)
        near = chain.from_iterable(tree.query_ball_point(middle[rows], reach[rows]))
        total = int(number[rows].sum())
        yield np.repeat(rows, number[rows]), used[np.fromiter(near, dtype=np.intp, count=total)]


def _contacts(
    nodes: Points, edges: Edges, edge: Ints, node: Ints, distance: float
) -> tuple[Ints, Ints]:
    """Return those pairs of `edge` and `node` that touch between the ends."""
    start, end = nodes[edges[edge, 0]], nodes[edges[edge, 1]]  # (k, 3)
    span = end - start
    along = dot(nodes[node] - start, span) / dot(span, span)
    foot = start + along[:, None] * span
    inside = (node != edges[edge, 0]) & (node != edges[edge, 1]) & (along > 0) & (along < 1)
    touches = inside & (length(nodes[node] - foot) <= distance)
    return edge[touches], node[touches]
