"""Connectivity of a graph given as an edge array: half-edges, incidence, chains.

Half-edge `2 e` leaves node `edges[e, 0]` and half-edge `2 e + 1` leaves `edges[e, 1]`, so that
`edges.reshape(-1)` holds the tails, `h ^ 1` is the twin of `h`, and `h >> 1` is its edge.
No positions here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Edges, Frozen, Ints


@dataclass(frozen=True, eq=False)
class Incidence(Frozen):
    """The half-edges that leave each node."""

    half_edges: Ints
    """Half-edges sorted by tail, ascending within a node, shape (2 m,)."""
    offsets: Ints
    """Those of node v are `half_edges[offsets[v]:offsets[v + 1]]`, shape (n + 1,)."""

    def at_nodes(self, nodes: Ints, valency: int) -> Ints:
        """Return the half-edges leaving `nodes`, which all have `valency`, shape (k, valency)."""
        rows: Ints = self.half_edges[self.offsets[nodes][:, None] + np.arange(valency)]
        return rows


@dataclass(frozen=True, eq=False)
class Chains(Frozen):
    """The graph's edges cut at every node that is not a joint: one chain a branch."""

    half_edges: Ints
    """Half-edges in walking order, chain after chain, shape (m,)."""
    offsets: Ints
    """Chain b is `half_edges[offsets[b]:offsets[b + 1]]`, shape (b + 1,)."""
    closed: Bools
    """Whether the chain is a ring of joints, which has no end, shape (b,)."""


def sides_of(faces: Ints) -> Edges:
    """Return the sides of faces (f, k), each from a corner to the next one, shape (f k, 2).

    >>> sides_of(np.array([[4, 7, 5]])).tolist()
    [[4, 7], [7, 5], [5, 4]]
    """
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)


def neighbors(triangles: Ints, count: int) -> Ints:
    """Return the triangle beyond each side of a closed mesh, (t, 3).

    Parameters
    ----------
    triangles : (t, 3) vertices; side k goes from corner k to the next
    count : of vertices
    """
    start, end = sides_of(triangles).T
    key = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    across = np.empty_like(order)
    across[order[0::2]], across[order[1::2]] = order[1::2] // 3, order[0::2] // 3
    return across.reshape(-1, 3)


def edges_of_sides(sides: Edges) -> tuple[Edges, Ints]:
    """Return the edges that sides (s, 2) run along, lower end first (e, 2), and that of each, (s,).

    >>> edges, edge_of_side = edges_of_sides(np.array([[4, 7], [7, 5], [7, 4]]))
    >>> edges.tolist(), edge_of_side.tolist()
    ([[4, 7], [5, 7]], [0, 1, 0])
    """
    low, high = sides.min(axis=1), sides.max(axis=1)
    count = int(high.max(initial=0)) + 1
    keys, edge_of_side = np.unique(low * count + high, return_inverse=True)
    return np.stack(np.divmod(keys, count), axis=1), edge_of_side.reshape(-1)


def valencies(edges: Edges, count: int) -> Ints:
    """Return the number of edges at each of `count` nodes; a self-loop counts twice."""
    return np.bincount(edges.reshape(-1), minlength=count)


def incidence(edges: Edges, count: int) -> Incidence:
    """Return the half-edges that leave each of `count` nodes."""
    tails = edges.reshape(-1)
    offsets = np.concatenate([[0], np.cumsum(np.bincount(tails, minlength=count))])
    return Incidence(np.argsort(tails, kind="stable"), offsets.astype(np.intp))


def component_labels(edges: Edges, count: int) -> Ints:
    """Return the component of each of `count` nodes, numbered by their first node, shape (n,)."""
    links = coo_array(
        (np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(count, count)
    )
    _, labels = connected_components(links, directed=False)
    _, first = np.unique(labels, return_index=True)
    rank = np.empty(len(first), dtype=np.intp)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[labels]


def chains(edges: Edges, count: int) -> Chains:
    """Return the chains of the graph, found by pointer jumping in O(m log m) array work.

    A chain starts at a branch point if it has one, else at the end whose half-edge comes first;
    a ring starts with its first half-edge. Chains are in order of their first half-edge.

    Parameters
    ----------
    edges : (m, 2) intp, without self-loops
    count : number of nodes
    """
    tails = edges.reshape(-1)
    valency = valencies(edges, count)
    before = _previous(tails, valency)
    root, steps = _jump_to_roots(before)

    is_root = before == np.arange(len(before))
    on_ring = ~is_root[root]
    if on_ring.any():
        first = _cut_rings(before, on_ring)
        before[first] = first
        root, steps = _jump_to_roots(before)

    keep = _one_direction(tails, valency, root, on_ring)
    kept = np.flatnonzero(keep[root])
    starts, chain = np.unique(root[kept], return_inverse=True)
    offsets = np.concatenate([[0], np.cumsum(np.bincount(chain, minlength=len(starts)))])
    half_edges = np.empty(len(kept), dtype=np.intp)
    half_edges[offsets[chain] + steps[kept]] = kept
    return Chains(half_edges, offsets.astype(np.intp), on_ring[starts])


def _previous(tails: Ints, valency: Ints) -> Ints:
    """Return the half-edge walked before each one through a joint; itself at other nodes."""
    before = np.arange(len(tails))
    at_joint = np.flatnonzero(valency[tails] == 2)
    pairs = at_joint[np.argsort(tails[at_joint], kind="stable")].reshape(-1, 2)
    before[pairs[:, 0]] = pairs[:, 1] ^ 1
    before[pairs[:, 1]] = pairs[:, 0] ^ 1
    return before


def _jump_to_roots(before: Ints) -> tuple[Ints, Ints]:
    """Return for each half-edge the root that `before` leads to, and in how many steps.

    What lies on a ring without a root ends anywhere on it.
    """
    root = before.copy()
    steps = (before != np.arange(len(before))).astype(np.intp)
    moving = np.flatnonzero(steps)
    for _ in range(max(len(moving), 1).bit_length()):
        # Each pass doubles the distance looked ahead; arrived half-edges add 0.
        moving = moving[before[root[moving]] != root[moving]]
        if len(moving) == 0:
            break
        steps[moving], root[moving] = (
            steps[moving] + steps[root[moving]],
            root[root[moving]],
        )
    return root, steps


def _cut_rings(before: Ints, on_ring: Bools) -> Ints:
    """Return the lowest half-edge of each directed ring."""
    lowest = np.arange(len(before))
    pointer = before.copy()
    members = np.flatnonzero(on_ring)
    for _ in range(len(members).bit_length()):
        lowest[members] = np.minimum(lowest[members], lowest[pointer[members]])
        pointer[members] = pointer[pointer[members]]
    lowest_ones: Ints = members[lowest[members] == members]
    return lowest_ones


def _one_direction(tails: Ints, valency: Ints, root: Ints, on_ring: Bools) -> Bools:
    """Return whether a root's walk is the one to keep of the two directions of its chain."""
    half_edges = np.arange(len(tails))
    keep = np.zeros(len(tails), dtype=np.bool_)
    ring_roots = np.flatnonzero((root == half_edges) & on_ring)
    keep[ring_roots] = ring_roots < root[ring_roots ^ 1]

    last = np.flatnonzero((valency[tails[half_edges ^ 1]] != 2) & ~on_ring)
    start, other = root[last], last ^ 1
    # A branch point first, then the lower half-edge.
    rank = (valency[tails] < 3) * len(tails) + half_edges
    keep[start] = rank[start] < rank[other]
    return keep
