"""Repair of raw graphs: arrays in, arrays and a count of every repair out.

Real files hold coincident nodes, zero-length and repeated edges, nodes without coordinates and
radii of zero. `repaired` turns them into what a `Skeleton` needs, or says why it can't.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from scaffold_cad.arrays import Bools, Edges, Floats, Ints, Points, Radii
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.topology import incidence, valencies
from scaffold_cad.vectors import dot, length, normalize

WELD_FRACTION = 1e-7
"""Distance within which nodes are welded, as a fraction of the bounding box diagonal."""

LEAST_ANGLE = 1.7e-4
"""Least angle between two edges at a node, rad: a little under 0.01°."""


@dataclass(frozen=True)
class Repairs:
    """How often each repair was made."""

    nodes_without_position: int = 0
    """Nodes dropped because a coordinate was not a finite number."""
    radii_replaced: int = 0
    """Radii that were not finite numbers > 0, taken from the nearest nodes along the graph."""
    nodes_welded: int = 0
    """Nodes merged into another one at the same place."""
    zero_length_edges: int = 0
    """Edges dropped because their ends are one node, as read or after welding."""
    duplicate_edges: int = 0
    """Edges dropped because another one joins the same nodes."""
    contacts_split: int = 0
    """Nodes in the middle of an edge, at which the edge was split."""
    overlapping_edges: int = 0
    """Edges that left a node along a shorter one and now go on from its end."""
    isolated_nodes: int = 0
    """Nodes dropped because no edge reaches them."""

    @property
    def total(self) -> int:
        """Number of repairs of all kinds."""
        return sum(getattr(self, field.name) for field in fields(self))

    def __str__(self) -> str:
        done = [(getattr(self, f.name), f.name.replace("_", " ")) for f in fields(self)]
        return ", ".join(f"{count} {name}" for count, name in done if count) or "nothing"


@dataclass(frozen=True, eq=False)
class RepairedGraph:
    """A graph that needs no further repair, and what was done to it."""

    nodes: Points
    edges: Edges
    radii: Radii
    repairs: Repairs


def default_weld_distance(nodes: Points) -> float:
    """Return the distance within which nodes (n, 3) count as one, mm."""
    if len(nodes) == 0:
        return 0.0
    return WELD_FRACTION * float(np.linalg.norm(np.ptp(nodes, axis=0)))


def repaired(
    nodes: Points,
    edges: Edges,
    radii: Floats,
    *,
    weld_distance: float | None = None,
    split_contacts: bool = False,
) -> RepairedGraph:
    """Return the graph without the faults that keep it from being scaffolded.

    Parameters
    ----------
    nodes : (n, 3) float64, mm; rows that are not finite are dropped
    edges : (m, 2) intp, all in 0..n-1
    radii : (n,) float64, mm; what is not finite and > 0 is taken from the neighbours
    weld_distance : mm; nodes closer than this become one; by default 1e-7 of the diagonal
    split_contacts : whether an edge is split at the nodes that lie on it

    Raises
    ------
    OptionError
        If `weld_distance` is negative or not finite.
    SkeletonError
        If no edge is left, or a component has no radius > 0.
    """
    if weld_distance is not None and not 0 <= weld_distance < np.inf:
        raise OptionError(f"weld distance is {weld_distance:g} mm; need >= 0")
    located: Bools = np.asarray(np.isfinite(nodes).all(axis=1))
    counts = {"nodes_without_position": int(np.sum(~located))}
    edges = edges[located[edges].all(axis=1)]
    if weld_distance is None:
        weld_distance = default_weld_distance(nodes[located])

    radii, counts["radii_replaced"] = _with_radii_filled(edges, radii, located)
    target, radii = _weld(nodes, radii, located, weld_distance)
    counts["nodes_welded"] = int(np.sum(target[located] != np.flatnonzero(located)))
    edges = target[edges]
    edges, counts["zero_length_edges"], counts["duplicate_edges"] = _distinct(edges)
    if split_contacts:
        edges, counts["contacts_split"] = _split_at_contacts(nodes, edges, weld_distance)
    edges, counts["overlapping_edges"] = _without_overlaps(nodes, edges)
    if len(edges) == 0:
        raise SkeletonError("the skeleton has no edge of length > 0; need at least one")

    used = np.zeros(len(nodes), dtype=np.bool_)
    used[edges] = True
    merged_away = located & (target != np.arange(len(nodes)))
    counts["isolated_nodes"] = int(np.sum(located & ~used & ~merged_away))
    rank = np.cumsum(used) - 1
    bad = np.flatnonzero(used & ~(np.isfinite(radii) & (radii > 0)))
    if len(bad):
        raise SkeletonError(
            f"node {bad[0]} and all of its component have radius {radii[bad[0]]:g} mm; need > 0"
        )
    return RepairedGraph(nodes[used], rank[edges], radii[used], Repairs(**counts))


def _with_radii_filled(edges: Edges, radii: Floats, located: Bools) -> tuple[Floats, int]:
    """Give nodes without a radius the mean of their neighbours', spreading along the graph."""
    filled = np.where(np.isfinite(radii) & (radii > 0), radii, 0.0)
    missing = (filled == 0) & located & (valencies(edges, len(radii)) > 0)
    count = int(np.sum(missing))
    while missing.any():
        known = filled[edges] > 0
        total = np.zeros_like(filled)
        number = np.zeros_like(filled)
        for near, far in ((0, 1), (1, 0)):
            rows = known[:, far]
            np.add.at(total, edges[rows, near], filled[edges[rows, far]])
            np.add.at(number, edges[rows, near], 1.0)
        reached = missing & (number > 0)
        if not reached.any():
            break
        filled[reached] = total[reached] / number[reached]
        missing &= ~reached
    return filled, count


def _weld(nodes: Points, radii: Floats, located: Bools, distance: float) -> tuple[Ints, Floats]:
    """Return the node that each one becomes, the first of its cluster, and the largest radius."""
    target = np.arange(len(nodes))
    index = np.flatnonzero(located)
    if len(index) == 0:
        return target, radii
    if distance == 0:
        _, cluster = np.unique(nodes[index] + 0.0, axis=0, return_inverse=True)
        cluster = cluster.reshape(-1)  # some numpy versions keep the rows' shape
    else:
        pairs = cKDTree(nodes[index]).query_pairs(distance, output_type="ndarray")
        links = coo_array(
            (np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])),
            shape=(len(index), len(index)),
        )
        cluster = connected_components(links, directed=False)[1].astype(np.intp)
    _, first = np.unique(cluster, return_index=True)
    target[index] = index[first[cluster]]
    welded = radii.copy()
    np.maximum.at(welded, target, radii)
    return target, welded


def _distinct(edges: Edges) -> tuple[Edges, int, int]:
    """Return the edges without self-loops and repeats, in order, and how many of each went."""
    proper = edges[edges[:, 0] != edges[:, 1]]
    _, first = np.unique(np.sort(proper, axis=1), axis=0, return_index=True)
    kept = proper[np.sort(first)]
    return kept, len(edges) - len(proper), len(proper) - len(kept)


def _split_at_contacts(nodes: Points, edges: Edges, distance: float) -> tuple[Edges, int]:
    """Split each edge at the nodes within `distance` of its inside."""
    used = np.unique(edges)
    tree = cKDTree(nodes[used])
    start, end = nodes[edges[:, 0]], nodes[edges[:, 1]]
    near = tree.query_ball_point((start + end) / 2, length(end - start) / 2 + distance)
    edge = np.repeat(np.arange(len(edges)), [len(row) for row in near])  # (k,)
    node = used[np.concatenate([np.asarray(row, dtype=np.intp) for row in near])]  # (k,)

    span = end[edge] - start[edge]
    along = dot(nodes[node] - start[edge], span) / dot(span, span)
    foot = start[edge] + along[:, None] * span
    inside = (node != edges[edge, 0]) & (node != edges[edge, 1]) & (along > 0) & (along < 1)
    touches = inside & (length(nodes[node] - foot) <= distance)
    edge, node, along = edge[touches], node[touches], along[touches]

    order = np.lexsort([along, edge])
    edge, node = edge[order], node[order]
    # The stops of each edge in order: its start, the nodes on it, its end.
    stops = np.concatenate([edges[:, 0], node, edges[:, 1]])
    owner = np.concatenate([np.arange(len(edges)), edge, np.arange(len(edges))])
    sequence = np.argsort(owner, kind="stable")
    stops, owner = stops[sequence], owner[sequence]
    consecutive = owner[:-1] == owner[1:]
    pieces = np.stack([stops[:-1], stops[1:]], axis=1)[consecutive]
    return _distinct(pieces)[0], len(node)


def _without_overlaps(nodes: Points, edges: Edges) -> tuple[Edges, int]:
    """Let an edge that leaves a node along a shorter one go on from the shorter one's end."""
    rerouted = 0
    for _ in range(len(edges)):
        longer, shorter = _first_overlaps(nodes, edges)
        if len(longer) == 0:
            break
        rerouted += len(longer)
        edges = edges.copy()
        ends = edges.reshape(-1)
        # The longer half-edge leaves the shorter one's head from now on.
        ends[longer] = ends[shorter ^ 1]
        edges, _, _ = _distinct(edges)
    return edges, rerouted


def _first_overlaps(nodes: Points, edges: Edges) -> tuple[Ints, Ints]:
    """Return half-edges that overlap a shorter one, at most one of each edge, and the shorter."""
    pairs = overlapping_half_edges(nodes, edges)  # (k, 2)
    if len(pairs) == 0:
        return pairs[:, 0], pairs[:, 1]
    tails = edges.reshape(-1)
    lengths = length(nodes[tails[pairs ^ 1]] - nodes[tails[pairs]])
    pairs = np.where((lengths[:, :1] >= lengths[:, 1:]), pairs, pairs[:, ::-1])
    # One change an edge and a pass: neither edge of a pair may change under the other.
    taken: set[int] = set()
    chosen = []
    for longer, shorter in pairs.tolist():
        if longer >> 1 not in taken and shorter >> 1 not in taken:
            taken |= {longer >> 1, shorter >> 1}
            chosen.append((longer, shorter))
    picked = np.asarray(chosen, dtype=np.intp)
    return picked[:, 0], picked[:, 1]


def overlapping_half_edges(nodes: Points, edges: Edges) -> Edges:
    """Return pairs of half-edges that leave a node within `LEAST_ANGLE` of each other, (k, 2)."""
    leaving = incidence(edges, len(nodes))
    tails = edges.reshape(-1)
    valency = np.diff(leaving.offsets)
    found = [np.zeros((0, 2), dtype=np.intp)]
    for n in np.unique(valency[valency > 1]).tolist():
        half_edges = leaving.at_nodes(np.flatnonzero(valency == n), n)  # (k, n)
        heads = nodes[tails[half_edges ^ 1]]  # (k, n, 3)
        directions = normalize(heads - nodes[tails[half_edges]])
        for shift in range(1, n // 2 + 1):  # every pair once, or twice at shift n / 2
            gap = length(directions - np.roll(directions, -shift, axis=1))  # (k, n)
            row, column = np.nonzero(gap < LEAST_ANGLE)
            pair = np.stack(
                [half_edges[row, column], half_edges[row, (column + shift) % n]], axis=1
            )
            found.append(np.sort(pair, axis=1))
    return np.unique(np.concatenate(found), axis=0)
