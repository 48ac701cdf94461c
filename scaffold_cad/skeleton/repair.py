"""Repair of raw graphs: arrays in, arrays and a count of every repair out.

Real files hold coincident nodes, zero-length and repeated edges, nodes without coordinates and
radii of zero. `repaired` turns them into what a `Skeleton` needs, or says why it can't.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, fields

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from scaffold_cad.base.arguments import as_flag, as_number
from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points, Radii, place_text
from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import SkeletonError
from scaffold_cad.skeleton.overlaps import without_overlaps
from scaffold_cad.skeleton.splitting import distinct_edges, split_at_contacts

LEAST_RADIUS = 1e-9
"""Least radius, in largest coordinates: a solid is made of differences of these."""

WELD_FRACTION = 1e-7
"""Distance within which nodes are welded, as a fraction of the bounding box diagonal."""

LEAST_LENGTH = 1e-100
"""Distance within which nodes are always welded, mm: the square of a shorter one may be 0."""


PLURAL = re.compile(r"radii|(node|edge|contact)s")
"""What there are several of in the name of a repair."""


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
    edge_radii_replaced: int = 0
    """Edges with a radius that was not a finite number > 0, or was not given where nodes have none
    either: taken from their nodes."""
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
        texts = [counted(count, PLURAL.sub(_singular, name), name) for count, name in done if count]
        return ", ".join(texts) or "nothing"


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
    kept: Bools = np.asarray(located[edges].all(axis=1))
    placed, sizes = edges[kept], _known_sizes(edge_radii, len(edges))[kept]
    counts["edges_without_position"] = len(edges) - len(placed)
    counts["edge_radii_replaced"] = _faulty_sizes(edge_radii, kept, radii is None)
    if weld_distance is None:
        weld_distance = default_weld_distance(nodes[located])

    target = _weld(nodes, located, max(weld_distance, LEAST_LENGTH))
    merged_away = target != np.arange(len(nodes))
    counts["nodes_welded"] = int(np.sum(merged_away))
    edges, sizes, counts["zero_length_edges"], counts["duplicate_edges"] = distinct_edges(
        target[placed], sizes, len(nodes)
    )
    if len(edges) == 0:
        raise SkeletonError(
            f"the skeleton has no edge longer than {weld_distance:.3g} mm; need at least one"
        )
    if as_flag(split_contacts, "split_contacts"):
        edges, sizes, counts["contacts_split"], repeated = split_at_contacts(
            nodes, edges, sizes, weld_distance
        )
        counts["duplicate_edges"] += repeated
    edges, sizes, counts["overlapping_edges"], repeated = without_overlaps(nodes, edges, sizes)
    counts["duplicate_edges"] += repeated

    used = np.zeros(len(nodes), dtype=np.bool_)
    used[edges] = True
    counts["isolated_nodes"] = int(np.sum(located & ~used & ~merged_away))
    given = np.zeros(len(nodes)) if radii is None else radii
    sized, counts["radii_replaced"] = _with_radii_filled(
        nodes, edges, sizes, _largest_of_welded(given, target, least_radius(nodes[used])), used
    )
    if radii is None:  # nothing was there to be replaced
        counts["radii_replaced"] = 0
    struts = np.where(np.isnan(sizes), sized[edges], sizes)
    rank = np.cumsum(used) - 1
    return RepairedGraph(nodes[used], rank[edges], sized[used], struts, Repairs(**counts))


def _singular(found: re.Match[str]) -> str:
    return found[1] or "radius"


def largest_at_nodes(edges: Edges, edge_radii: Floats, count: int) -> Floats:
    """Return the largest radius of the edges at each node, nan not counted, 0 for none, (n,)."""
    largest = np.zeros(count)
    known = np.nan_to_num(edge_radii, nan=0.0, posinf=0.0, neginf=0.0)
    np.maximum.at(largest, edges.reshape(-1), known.reshape(-1))
    return largest


def radii_left(radii: Floats, had: tuple[Edges, Floats], have: tuple[Edges, Floats]) -> Floats:
    """Return the radii of nodes (n,) once edges are gone: balls stay, others shrink to those left.

    Parameters
    ----------
    had, have : edges (m, 2) and their radii (m, 2) that there were and are
    """
    before, left = (largest_at_nodes(*struts, len(radii)) for struts in (had, have))
    is_ball = (radii > before) | (left == 0)
    return np.where(is_ball, radii, np.minimum(radii, left))


def _known_sizes(edge_radii: Floats | None, count: int) -> Floats:
    """Return the radii of edges at both ends, (m, 2), nan where they follow the nodes."""
    if edge_radii is None:
        return np.full((count, 2), np.nan)
    return np.where(np.isfinite(edge_radii) & (edge_radii > 0), edge_radii, np.nan)


def _faulty_sizes(edge_radii: Floats | None, kept: Bools, alone: bool) -> int:
    """Return how many of the kept edges lack a radius, or have one that is not above 0.

    Edges without a radius follow their nodes, but where radii of edges are `alone`: these lack one.
    """
    if edge_radii is None:
        return 0
    given = edge_radii[kept]
    sound = (np.isfinite(given) & (given > 0)) | (np.isnan(given) & (not alone))
    return int((~sound).any(axis=1).sum())


def least_radius(nodes: Points) -> float:
    """Return the radius below which rounding hides struts between nodes, (n, 3), mm."""
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
            f"node {lost[0]} at {place_text(nodes[lost[0]])} and all that is joined to it have no "
            f"radius above {least_radius(nodes[used]):.3g} mm, the least for these coordinates; "
            "need one at least, or radius= for all"
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
