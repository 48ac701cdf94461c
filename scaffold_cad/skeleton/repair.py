"""Repair of raw graphs: arrays in, arrays and a count of every repair out.

Real files hold coincident nodes, zero-length and repeated edges, nodes without coordinates and
radii of zero. `repaired` turns them into what a `Skeleton` needs, or says why it can't.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from itertools import chain

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import as_number
from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Radii, UnitVectors
from scaffold_cad.base.blocks import uneven_blocks
from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.topology import component_labels, incidence
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.errors import SkeletonError

LEAST_RADIUS = 1e-9
"""Least radius, in largest coordinates: a solid is made of differences of these."""

WELD_FRACTION = 1e-7
"""Distance within which nodes are welded, as a fraction of the bounding box diagonal."""

LEAST_LENGTH = 1e-100
"""Distance within which nodes are always welded, mm: the square of a shorter one may be 0."""

LEAST_ANGLE = float(np.radians(0.01))
"""Least angle between two edges at a node, rad; a partition needs it between two directions.

Here the chord of the angle is compared with it, which is a little shorter than the angle."""

CROWD = 64
"""Valency above which a node's directions are compared through a tree, not each with each."""

CONTACT_BYTES = 64
"""What a pair of an edge and a node near it takes, as Python's number."""


@dataclass(frozen=True)
class Repairs:
    """How often each repair was made."""

    nodes_without_position: int = 0
    """Nodes dropped because a coordinate was not a finite number."""
    edges_without_position: int = 0
    """Edges dropped because they reach such a node."""
    radii_replaced: int = 0
    """Radii of nodes that were not finite numbers > 0, or too small beside the coordinates, taken
    from their struts or else from the nearest node along the graph."""
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
    edge_radii: Floats
    """Radius of each edge at both ends, shape (m, 2), mm."""
    repairs: Repairs


def default_weld_distance(nodes: Points) -> float:
    """Return the distance within which nodes (n, 3) count as one, mm."""
    if len(nodes) == 0:
        return 0.0
    return WELD_FRACTION * float(np.linalg.norm(np.ptp(nodes, axis=0)))


def repaired(
    nodes: Points,
    edges: Edges,
    radii: Floats | None,
    edge_radii: Floats | None = None,
    *,
    weld_distance: float | None = None,
    split_contacts: bool = False,
) -> RepairedGraph:
    """Return the graph without the faults that keep it from being scaffolded.

    Parameters
    ----------
    nodes : (n, 3) float64, mm; rows that are not finite are dropped
    edges : (m, 2) intp, all in 0..n-1
    radii : (n,) float64, mm; what is not finite and > 0, or too small to be told from rounding, is
        the largest of the node's struts, or else taken from the nearest node that has a radius, by
        the way along the edges; None for none
    edge_radii : (m, 2) float64, mm; what is not finite and > 0, or is not given, follows the nodes.
        Of edges between the same nodes the largest radii stay
    weld_distance : mm; nodes closer than this become one, with the largest of their radii; by
        default 1e-7 of the diagonal
    split_contacts : whether an edge is split at the nodes that lie on it

    Raises
    ------
    OptionError
        If `weld_distance` is negative or not finite.
    SkeletonError
        If no edge is left, or a component has no radius > 0.
    """
    if weld_distance is not None:
        weld_distance = as_number(weld_distance, "weld distance", or_zero=True)
    located: Bools = np.asarray(np.isfinite(nodes).all(axis=1))
    counts = {"nodes_without_position": int(np.sum(~located))}
    kept = located[edges].all(axis=1)
    placed, sizes = edges[kept], _known_sizes(edge_radii, len(edges))[kept]
    counts["edges_without_position"] = len(edges) - len(placed)
    if weld_distance is None:
        weld_distance = default_weld_distance(nodes[located])

    target = _weld(nodes, located, max(weld_distance, LEAST_LENGTH))
    merged_away = target != np.arange(len(nodes))
    counts["nodes_welded"] = int(np.sum(merged_away))
    edges, sizes, counts["zero_length_edges"], counts["duplicate_edges"] = _distinct(
        target[placed], sizes, len(nodes)
    )
    if len(edges) == 0:
        raise SkeletonError("the skeleton has no edge of length > 0; need at least one")
    if split_contacts:
        edges, sizes, counts["contacts_split"], repeated = _split_at_contacts(
            nodes, edges, sizes, weld_distance
        )
        counts["duplicate_edges"] += repeated
    edges, sizes, counts["overlapping_edges"], repeated = _without_overlaps(nodes, edges, sizes)
    counts["duplicate_edges"] += repeated

    used = np.zeros(len(nodes), dtype=np.bool_)
    used[edges] = True
    counts["isolated_nodes"] = int(np.sum(located & ~used & ~merged_away))
    given = np.zeros(len(nodes)) if radii is None else radii
    sized, counts["radii_replaced"] = _with_radii_filled(
        nodes, edges, sizes, _largest_of_welded(given, target, _least_radius(nodes[used])), used
    )
    if radii is None:  # nothing was there to be replaced
        counts["radii_replaced"] = 0
    struts = np.where(np.isnan(sizes), sized[edges], sizes)
    rank = np.cumsum(used) - 1
    return RepairedGraph(nodes[used], rank[edges], sized[used], struts, Repairs(**counts))


def largest_at_nodes(edges: Edges, edge_radii: Floats, count: int) -> Floats:
    """Return the largest radius of the edges at each node, nan not counted, 0 for none, (n,)."""
    largest = np.zeros(count)
    known = np.nan_to_num(edge_radii, nan=0.0, posinf=0.0, neginf=0.0)
    np.maximum.at(largest, edges.reshape(-1), known.reshape(-1))
    return largest


def _known_sizes(edge_radii: Floats | None, count: int) -> Floats:
    """Return the radii of edges at both ends, (m, 2), nan where they follow the nodes."""
    if edge_radii is None:
        return np.full((count, 2), np.nan)
    return np.where(np.isfinite(edge_radii) & (edge_radii > 0), edge_radii, np.nan)


def _least_radius(nodes: Points) -> float:
    return LEAST_RADIUS * float(np.abs(nodes).max(initial=0.0))


def _largest_of_welded(radii: Floats, target: Ints, least: float) -> Floats:
    """Return for each node the largest radius of those welded into it; 0 where none will do."""
    known = np.where(np.isfinite(radii) & (radii > 0) & (radii >= least), radii, 0.0)
    largest = known.copy()
    np.maximum.at(largest, target, known)
    return largest


def _with_radii_filled(
    nodes: Points, edges: Edges, sizes: Floats, radii: Floats, used: Bools
) -> tuple[Floats, int]:
    """Give nodes of radius 0 that of their struts, or that of the nearest node; count them."""
    lacking = used & (radii == 0)
    if not lacking.any():
        return radii, 0
    radii = np.where(lacking, largest_at_nodes(edges, sizes, len(nodes)), radii)
    missing = np.flatnonzero(used & (radii == 0))
    if len(missing) == 0:
        return radii, int(lacking.sum())
    known = np.flatnonzero(used & (radii > 0))
    lengths = length(nodes[edges[:, 1]] - nodes[edges[:, 0]])
    roads = coo_array((lengths, (edges[:, 0], edges[:, 1])), shape=(len(nodes), len(nodes)))
    _, _, nearest = dijkstra(
        roads.tocsr(), directed=False, indices=known, return_predecessors=True, min_only=True
    )
    lost = missing[nearest[missing] < 0]
    if len(lost):
        raise SkeletonError(
            f"node {lost[0]} and all of its component have no radius; need at least one > 0"
        )
    filled = radii.copy()
    filled[missing] = radii[nearest[missing]]
    return filled, int(lacking.sum())


def _weld(nodes: Points, located: Bools, distance: float) -> Ints:
    """Return the node that each one becomes, the first of its cluster, shape (n,)."""
    target = np.arange(len(nodes))
    index = np.flatnonzero(located)
    if len(index) == 0:
        return target
    # Equal positions first: a heap of them would make the pairs below as many as its square.
    place, first = equal_positions(nodes[index])
    pairs = cKDTree(nodes[index[first]]).query_pairs(distance, output_type="ndarray")
    place = component_labels(pairs, len(first))[place]
    _, first = np.unique(place, return_index=True)
    target[index] = index[first[place]]
    return target


def _distinct(edges: Edges, sizes: Floats, count: int) -> tuple[Edges, Floats, int, int]:
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


def _split_at_contacts(
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
    at_stop = _interpolated(nodes, edges, sizes, owner, stops)
    widths = np.stack([at_stop[:-1], at_stop[1:]], axis=1)[consecutive]
    distinct, widths, _, repeated = _distinct(pieces, widths, len(nodes))
    return distinct, widths, len(node), repeated


def _interpolated(nodes: Points, edges: Edges, sizes: Floats, edge: Ints, node: Ints) -> Floats:
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
    """Return those pairs of `edge` and `node` that touch between the ends, along each edge."""
    start, end = nodes[edges[edge, 0]], nodes[edges[edge, 1]]  # (k, 3)
    span = end - start
    along = dot(nodes[node] - start, span) / dot(span, span)
    foot = start + along[:, None] * span
    inside = (node != edges[edge, 0]) & (node != edges[edge, 1]) & (along > 0) & (along < 1)
    touches = inside & (length(nodes[node] - foot) <= distance)
    edge, node, along = edge[touches], node[touches], along[touches]
    order = np.lexsort([along, edge])
    return edge[order], node[order]


def _without_overlaps(nodes: Points, edges: Edges, sizes: Floats) -> tuple[Edges, Floats, int, int]:
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
        widths.reshape(-1)[longer] = _interpolated(
            nodes, edges, sizes, longer >> 1, tails[shorter ^ 1]
        )
        edges = edges.copy()
        ends = edges.reshape(-1)
        # The longer half-edge leaves the shorter one's head from now on.
        ends[longer] = tails[shorter ^ 1]
        edges, sizes, _, dropped = _distinct(edges, widths, len(nodes))
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
