"""Skeleton: a graph in space with a radius at each node, and its checks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, check_kind
from scaffold_cad.base.arrays import (
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    Radii,
    UnitVectors,
    as_chosen,
    as_edges,
    as_points,
    as_radii,
    check_believable,
)
from scaffold_cad.base.backends import need
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.topology import (
    Chains,
    Incidence,
    chains,
    component_labels,
    incidence,
    valencies,
)
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import SkeletonError
from scaffold_cad.skeleton.repair import LEAST_LENGTH, Repairs, overlapping_half_edges, repaired
from scaffold_cad.skeleton.thinning import farthest_sample, kept_samples

if TYPE_CHECKING:
    from build123d import Curve

    from scaffold_cad.base.radii import Radius
    from scaffold_cad.brep.wires import Curves

LEAST_RADIUS = 1e-9
"""Least radius of a node, in largest coordinates: a solid is made of differences of these."""


@dataclass(frozen=True, eq=False)
class Skeleton(Frozen, Shown):
    """A skeleton (G, p, r): nodes joined by straight edges, with a radius at each node.

    The constructor refuses what no graph may hold: wrong shapes, numbers that are not finite or
    beyond 1e12 mm, radii ≤ 0, indices out of range. `check_skeleton` refuses what cannot be
    scaffolded, and `cleaned` repairs it.

    Half-edge `2 e` leaves node `edges[e, 0]`, half-edge `2 e + 1` leaves `edges[e, 1]`.
    """

    nodes: Points
    """Node positions, shape (n, 3), mm."""
    edges: Edges
    """Node pairs, shape (m, 2), each edge once."""
    radii: Radii
    """Sphere radius of each node, shape (n,), mm, all > 0; one number stands for all."""

    def __init__(self, nodes: ArrayLike, edges: ArrayLike, radii: ArrayLike) -> None:
        points = as_points(nodes, "nodes")
        pairs = as_edges(edges, "edges", count=len(points))
        sizes = as_radii(radii, "radii", count=len(points))
        check_believable(points, "is at")
        check_believable(sizes, "has radius")
        self._keep(nodes=points, edges=pairs, radii=sizes)

    @classmethod
    def from_edges(
        cls,
        curves: Curves,
        radius: Radius,
        *,
        tolerance: float = 0.1,
        contact: float = 1e-4,
    ) -> Skeleton:
        """Return the edges of build123d shapes as a skeleton.

        Curves become chains of straight edges. Where edges touch, cross or cover each other, they
        are split and share a node, and so is one that crosses itself.

        Parameters
        ----------
        curves : edges, wires, sketches, builders or any other shapes of build123d, one or several:
            all edges of a face and of a solid count
        radius : mm; one number, or a function of positions (n, 3) that returns radii (n,)
        tolerance : largest distance of the skeleton from the curves, mm; a curve turns by 30° at
            most from one joint to the next
        contact : edges no farther apart than this touch, mm

        Raises
        ------
        OptionError
            If an argument is out of its range or no shape of build123d.
        SkeletonError
            If the shapes have no edge of length > 0.
        MissingBackendError
            If build123d is not installed.
        """
        need("build123d", "a skeleton of its edges")
        from scaffold_cad.brep import wires

        return wires.skeleton_from_edges(curves, radius, tolerance=tolerance, contact=contact)

    def to_wire_compound(self) -> Curve:
        """Return each edge, in order, as a straight build123d Edge; all of them as one Curve.

        Raises
        ------
        SkeletonError
            If an edge is too short to be one in a CAD system.
        MissingBackendError
            If build123d is not installed.
        """
        need("build123d", "a compound of its edges")
        from scaffold_cad.brep import wires

        return wires.wire_compound(self)

    @cached_property
    def valency(self) -> Ints:
        """Number of edges at each node, shape (n,)."""
        return valencies(self.edges, len(self.nodes))

    @property
    def extremities(self) -> Ints:
        """Nodes of valency 1."""
        return np.flatnonzero(self.valency == 1)

    @property
    def leaving_extremities(self) -> Ints:
        """Half-edge that leaves each extremity, in their order."""
        return self.incidence.at_nodes(self.extremities, 1)[:, 0]

    @property
    def joints(self) -> Ints:
        """Nodes of valency 2."""
        return np.flatnonzero(self.valency == 2)

    @property
    def branch_points(self) -> Ints:
        """Nodes of valency 3 or more."""
        return np.flatnonzero(self.valency >= 3)

    @cached_property
    def lengths(self) -> Floats:
        """Length of each edge, shape (m,), mm."""
        return length(self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]])

    @cached_property
    def directions(self) -> UnitVectors:
        """Unit direction in which each half-edge leaves its node, shape (2 m, 3)."""
        spans = self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]]
        ahead = spans / self.lengths[:, None]
        return np.stack([ahead, -ahead], axis=1).reshape(-1, 3)

    @cached_property
    def incidence(self) -> Incidence:
        """The half-edges that leave each node."""
        return incidence(self.edges, len(self.nodes))

    @cached_property
    def chains(self) -> Chains:
        """The branches as chains of half-edges."""
        return chains(self.edges, len(self.nodes))

    @cached_property
    def component_of_node(self) -> Ints:
        """Component of each node, numbered from 0, shape (n,)."""
        return component_labels(self.edges, len(self.nodes))

    @property
    def component_count(self) -> int:
        """Number of connected components."""
        return int(self.component_of_node.max(initial=-1)) + 1

    @property
    def loop_count(self) -> int:
        """Number of independent loops: edges − nodes + components."""
        return len(self.edges) - len(self.nodes) + self.component_count

    def moved(self, nodes: ArrayLike) -> Skeleton:
        """Return the same graph and radii at other positions, shape (n, 3), mm."""
        return Skeleton(nodes, self.edges, self.radii)

    def with_radii(self, radii: ArrayLike) -> Skeleton:
        """Return the same graph with other radii, shape (n,) or one number, mm."""
        return Skeleton(self.nodes, self.edges, radii)

    def with_edges(self, edges: ArrayLike) -> Skeleton:
        """Return some of the edges, by number or by mark, and their nodes, numbered anew."""
        chosen = as_chosen(edges, "edges", len(self.edges))
        nodes, ends = np.unique(self.edges[chosen], return_inverse=True)
        return Skeleton(self.nodes[nodes], ends.reshape(-1, 2), self.radii[nodes])

    def scaled(self, factor: float) -> Skeleton:
        """Return the skeleton with positions and radii multiplied by `factor` > 0."""
        factor = as_number(factor, "scale factor", unit="")
        with np.errstate(over="ignore"):  # what overflows is refused by name
            nodes, radii = self.nodes * factor, self.radii * factor
        return Skeleton(nodes, self.edges, radii)

    def cleaned(
        self, *, weld_distance: float | None = None, split_contacts: bool = False
    ) -> Cleaning:
        """Return the skeleton repaired so that it can be scaffolded, and what was repaired.

        Coincident nodes are welded, zero-length and repeated edges and isolated nodes dropped,
        and edges that leave a node in the same direction made to follow each other.

        Parameters
        ----------
        weld_distance : mm; nodes closer than this become one; by default 1e-7 of the diagonal
        split_contacts : whether an edge is split at the nodes that lie on it

        Raises
        ------
        SkeletonError
            If no edge is left.
        """
        graph = repaired(
            self.nodes,
            self.edges,
            self.radii,
            weld_distance=weld_distance,
            split_contacts=split_contacts,
        )
        return Cleaning(Skeleton(graph.nodes, graph.edges, graph.radii), graph.repairs)

    def simplified(self, tolerance: float) -> Skeleton:
        """Return the skeleton without the joints that its shape does not need.

        A joint goes where the branch without it stays within `tolerance` of the old one in
        (x, y, z, r), or where it stands closer to its neighbour than its radius. Branch points,
        extremities, and three joints of each ring stay.

        Parameters
        ----------
        tolerance : mm, ≥ 0
        """
        tolerance = as_number(tolerance, "simplification tolerance", or_zero=True)
        lone, walks = self._walks()
        kept = [self._kept(stops, tolerance) for stops in walks]
        ends = np.asarray([(row[0], row[-1]) for row in kept], dtype=np.intp).reshape(-1, 2)
        _, pair, uses = np.unique(
            np.sort(np.concatenate([ends, lone]), axis=1),
            axis=0,
            return_inverse=True,
            return_counts=True,
        )
        # Branches between the same two nodes must not become the same edge.
        for branch in np.flatnonzero(uses[pair.reshape(-1)[: len(kept)]] > 1).tolist():
            if len(kept[branch]) == 2:
                stops = walks[branch]
                kept[branch] = stops[[0, farthest_sample(self.nodes[stops]), -1]]
        links = [np.stack([row[:-1], row[1:]], axis=1) for row in kept]
        edges = np.concatenate([lone, *links])
        used = np.unique(edges)
        thin = Skeleton(self.nodes[used], np.searchsorted(used, edges), self.radii[used])
        return thin.cleaned(weld_distance=0.0).skeleton

    def _walks(self) -> tuple[Edges, list[Ints]]:
        """Return the edges that are a branch of their own, and the nodes that each other passes.

        A ring has its first node at both ends.
        """
        half_edges, offsets = self.chains.half_edges, self.chains.offsets
        tails = self.edges.reshape(-1)
        counts = np.diff(offsets)
        lone = self.edges[half_edges[offsets[:-1][counts == 1]] >> 1]
        walks = []
        for branch in np.flatnonzero(counts > 1).tolist():
            row = half_edges[offsets[branch] : offsets[branch + 1]]
            walks.append(np.append(tails[row], tails[row[-1] ^ 1]))
        return lone, walks

    def _kept(self, stops: Ints, tolerance: float) -> Ints:
        """Return the nodes of a walk to keep; a walk that ends where it began keeps two inside."""
        last = len(stops) - 1
        third = (last + 1) // 3
        cuts = [0, last] if stops[0] != stops[-1] else [0, third, 2 * third, last]
        keep = np.zeros(len(stops), dtype=np.bool_)
        for start, stop in pairwise(cuts):
            part = slice(start, stop + 1)
            keep[part] |= kept_samples(self.nodes[stops[part]], self.radii[stops[part]], tolerance)
        return stops[keep]


@dataclass(frozen=True, eq=False)
class Cleaning:
    """A repaired skeleton and what was repaired."""

    skeleton: Skeleton
    repairs: Repairs


def check_skeleton(skeleton: Skeleton) -> None:
    """Raise unless `skeleton` can be scaffolded.

    Raises
    ------
    OptionError
        If it is no skeleton.
    SkeletonError
        For the first of: no edge, a self-loop, an isolated node, coincident nodes, an edge too
        short for its direction to be computed, a repeated edge, a radius too small for the
        rounding of coordinates, two edges that leave a node within 0.01° of each other.
    """
    check_kind(skeleton, Skeleton)
    nodes, edges = skeleton.nodes, skeleton.edges
    hint = "use Skeleton.cleaned() to repair it"
    if len(edges) == 0:
        raise SkeletonError("the skeleton has no edges; need at least one")
    loops = np.flatnonzero(edges[:, 0] == edges[:, 1])
    if len(loops):
        edge, node = loops[0], edges[loops[0], 0]
        raise SkeletonError(f"edge {edge} joins node {node} to itself; need two nodes ({hint})")
    isolated = np.flatnonzero(skeleton.valency == 0)
    if len(isolated):
        raise SkeletonError(f"node {isolated[0]} has no edge; need at least one ({hint})")
    for first, second in _equal_rows(nodes):
        place = nodes[second].tolist()
        raise SkeletonError(
            f"nodes {first} and {second} are both at {place} mm; need distinct places ({hint})"
        )
    short = np.flatnonzero(skeleton.lengths < LEAST_LENGTH)
    if len(short):
        found = skeleton.lengths[short[0]]
        raise SkeletonError(
            f"edge {short[0]} is {found:g} mm long; need at least {LEAST_LENGTH:g} ({hint})"
        )
    for first, second in _equal_rows(np.sort(edges, axis=1)):
        pair = edges[second].tolist()
        raise SkeletonError(
            f"edges {first} and {second} both join nodes {pair}; need each edge once ({hint})"
        )
    least = LEAST_RADIUS * float(np.abs(nodes).max())
    thin = np.flatnonzero(skeleton.radii < least)
    if len(thin):
        raise SkeletonError(
            f"node {thin[0]} has radius {skeleton.radii[thin[0]]:g} mm; need {least:g} mm or more "
            "this far from the origin, for rounding"
        )
    overlaps = overlapping_half_edges(nodes, edges)
    if len(overlaps):
        node = edges.reshape(-1)[overlaps[0, 0]]
        first, second = (overlaps[0] >> 1).tolist()
        raise SkeletonError(
            f"edges {first} and {second} leave node {node} in the same direction; "
            f"need more than 0.01 degrees between them ({hint})"
        )


def _equal_rows(rows: np.ndarray) -> list[tuple[int, int]]:
    """Return the first two equal rows of `rows`, if any, as a list of at most one pair."""
    order = np.lexsort(rows.T[::-1])
    same = (rows[order[1:]] == rows[order[:-1]]).all(axis=1)
    if not same.any():
        return []
    at = int(np.argmax(same))
    first, second = sorted((int(order[at]), int(order[at + 1])))
    return [(first, second)]
