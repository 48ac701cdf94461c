"""Skeleton: a graph in space with radii of its nodes and edges, and its checks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arguments import as_number, checks_keywords
from scaffold_cad.base.arrays import (
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    Radii,
    UnitVectors,
    as_chosen,
    as_edge_radii,
    as_edges,
    as_points,
    as_radii,
    check_believable,
)
from scaffold_cad.base.backends import need
from scaffold_cad.base.notebook import Shown
from scaffold_cad.base.placements import placement_of
from scaffold_cad.base.radii import Radius, radii_at
from scaffold_cad.base.summaries import counted, radii_text, size_text
from scaffold_cad.base.topology import (
    Chains,
    Incidence,
    chains,
    component_labels,
    incidence,
    valencies,
)
from scaffold_cad.base.vectors import both_directions, length
from scaffold_cad.errors import SkeletonError
from scaffold_cad.skeleton.editing import Editing
from scaffold_cad.skeleton.joining import joined_graph
from scaffold_cad.skeleton.repair import (
    Repairs,
    largest_at_nodes,
    radii_left,
    repaired,
)
from scaffold_cad.skeleton.thinning import thinned_edges

if TYPE_CHECKING:
    from build123d import Curve, Location, Plane

    from scaffold_cad.brep.wires import Curves


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Skeleton(Frozen, Shown, Editing):
    """A skeleton (G, p, r): nodes joined by straight edges, with radii of nodes and of struts.

    The constructor refuses what no graph may hold: wrong shapes, numbers that are not finite or
    beyond 1e12 mm, radii ≤ 0, indices out of range. `check_skeleton` refuses what cannot be
    scaffolded, and `cleaned` repairs it.

    Half-edge `2 e` leaves node `edges[e, 0]`, half-edge `2 e + 1` leaves `edges[e, 1]`.

    Examples
    --------
    >>> from scaffold_cad import Skeleton
    >>> tips = [[9, 0, 0], [0, 9, 0], [0, 0, 9]]
    >>> tripod = Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2], [0, 3]], 1.0)
    >>> tripod.branch_points, tripod.extremities
    (array([0]), array([1, 2, 3]))
    >>> print(tripod)
    Skeleton: 4 nodes, 3 edges, 9 x 9 x 9 mm, radius 1 mm
    """

    nodes: Points
    """Node positions, shape (n, 3), mm: numbers, or build123d's Vectors, Vertices or Locations."""
    edges: Edges
    """Node pairs, shape (m, 2), each edge once."""
    radii: Radii
    """Sphere radius of each node, shape (n,), mm, all > 0; one number stands for all. By default
    the largest of the struts' radii there."""
    edge_radii: Floats
    """Radius of each strut at its first and its second node, shape (m, 2), mm, all > 0; in between
    it changes evenly. By default those of the nodes."""

    def __init__(
        self,
        nodes: ArrayLike,
        edges: ArrayLike,
        radii: ArrayLike | Radius | None = None,
        edge_radii: ArrayLike | None = None,
    ) -> None:
        points = as_points(nodes, "nodes")
        pairs = as_edges(edges, "edges", count=len(points))
        if callable(radii):
            radii = radii_at(points, radii)
        if edge_radii is None:
            if radii is None:
                raise SkeletonError("radii and edge_radii are both None; need one of them, mm")
            sizes = as_radii(radii, "radii", len(points), points)
            struts = sizes[pairs]
        else:
            middles = points[pairs].mean(axis=1)
            struts = as_edge_radii(edge_radii, "edge_radii", len(pairs), middles)
            given = largest_at_nodes(pairs, struts, len(points)) if radii is None else radii
            sizes = as_radii(given, "radii", len(points), points)
        check_believable(points, "is at")
        check_believable(sizes, "has radius")
        check_believable(struts, "of edge has radii")
        self._keep(nodes=points, edges=pairs, radii=sizes, edge_radii=struts)

    def __setstate__(self, state: dict[str, Any]) -> None:
        if "edge_radii" not in state:  # of an earlier version
            state = {**state, "edge_radii": state["radii"][state["edges"]]}
        super().__setstate__(state)

    def __str__(self) -> str:
        counts = f"{counted(len(self.nodes), 'node')}, {counted(len(self.edges), 'edge')}"
        radii = radii_text(self.edge_radii if len(self.edges) else self.radii)
        return f"Skeleton: {counts}, {size_text(self.nodes)}, {radii}"

    def _like(
        self, nodes: ArrayLike, edges: ArrayLike, radii: ArrayLike, edge_radii: ArrayLike
    ) -> Skeleton:
        return Skeleton(nodes, edges, radii, edge_radii)

    @classmethod
    def from_edges(
        cls,
        curves: Curves,
        radius: Radius | Sequence[float] | Floats,
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
        radius : mm; one number; one for each shape, or for each of their edges in the order of
            `shape.edges()`; or a function of positions (n, 3) that returns radii (n,). Struts that
            cover each other have the largest
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
    def has_member_radii(self) -> bool:
        """Whether the radius of a strut differs from that of its node."""
        return bool((self.edge_radii != self.radii[self.edges]).any())

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
        return both_directions(self.nodes, self.edges)

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

    def moved(self, nodes: ArrayLike | Plane | Location) -> Skeleton:
        """Return the same graph and radii at other positions, shape (n, 3), mm.

        A Location of build123d moves all nodes, as it moves shapes.
        """
        if placement_of(nodes) is not None:
            return self.moved_by(nodes)
        return Skeleton(nodes, self.edges, self.radii, self.edge_radii)

    def with_radii(self, radii: ArrayLike | Radius) -> Skeleton:
        """Return the same graph with other radii of nodes, mm.

        Struts get those of their nodes: see `with_edge_radii` for radii of their own.

        Parameters
        ----------
        radii : (n,), one number, or a function of positions (n, 3) that returns (n,)

        Examples
        --------
        >>> path = Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0)
        >>> path.with_radii(lambda places: 1 + places[:, 0] / 9).radii.tolist()
        [1.0, 2.0]
        """
        return Skeleton(self.nodes, self.edges, radii)

    def with_edge_radii(self, edge_radii: ArrayLike, radii: ArrayLike | None = None) -> Skeleton:
        """Return the same graph with other radii of struts.

        Parameters
        ----------
        edge_radii : (m, 2) at both ends of each edge, (m,) one per edge, or one number, mm
        radii : (n,) or one number, of the nodes, mm; by default the largest of their struts'

        Examples
        --------
        >>> path = Skeleton([[0, 0, 0], [9, 0, 0], [9, 9, 0]], [[0, 1], [1, 2]], 1.0)
        >>> path.with_edge_radii([1.0, 0.5]).radii.tolist()
        [1.0, 1.0, 0.5]
        """
        return Skeleton(self.nodes, self.edges, radii, edge_radii)

    def with_edges(self, edges: ArrayLike) -> Skeleton:
        """Return some of the edges, by number or by mark, and their nodes, renumbered.

        Nodes are no thicker than the edges left, unless they were balls before.
        """
        chosen = as_chosen(edges, "edges", len(self.edges))
        nodes, ends = np.unique(self.edges[chosen], return_inverse=True)
        struts = self.edge_radii[chosen]
        had, have = (self.edges, self.edge_radii), (self.edges[chosen], struts)
        radii = radii_left(self.radii, had, have)
        return Skeleton(self.nodes[nodes], ends.reshape(-1, 2), radii[nodes], struts)

    def scaled(self, factor: float) -> Skeleton:
        """Return the skeleton with positions and radii multiplied by `factor` > 0."""
        factor = as_number(factor, "scale factor", unit="")
        nodes, radii = self.nodes * factor, self.radii * factor
        return Skeleton(nodes, self.edges, radii, self.edge_radii * factor)

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
            self.edge_radii,
            weld_distance=weld_distance,
            split_contacts=split_contacts,
        )
        return Cleaning(
            Skeleton(graph.nodes, graph.edges, graph.radii, graph.edge_radii), graph.repairs
        )

    def joined(self, tolerance: float) -> Skeleton:
        """Return the skeleton with nodes where struts cross, or end on others.

        Nodes closer than `tolerance` become one, and what else `cleaned` repairs is repaired.

        Parameters
        ----------
        tolerance : mm, > 0; struts no farther apart than this meet

        Raises
        ------
        SkeletonError
            If no edge is left.

        Examples
        --------
        >>> from scaffold_cad import Skeleton
        >>> cross = Skeleton([[-5, 0, 0], [5, 0, 0], [0, -5, 0], [0, 5, 0]], [[0, 1], [2, 3]], 1.0)
        >>> cross.joined(0.01).edges.tolist()
        [[0, 4], [4, 1], [2, 4], [4, 3]]
        """
        tolerance = as_number(tolerance, "tolerance")
        graph = joined_graph(self.nodes, self.edges, self.radii, self.edge_radii, tolerance)
        return Skeleton(graph.nodes, graph.edges, graph.radii, graph.edge_radii)

    def simplified(self, tolerance: float) -> Skeleton:
        """Return the skeleton without the joints that its shape does not need.

        A joint goes where the branch without it stays within `tolerance` of the old one in
        (x, y, z, r), or where it stands closer to its neighbor than its radius and the radius
        changes by no more than a tenth. Branch points, extremities, and three joints of each ring
        stay.

        Parameters
        ----------
        tolerance : mm, ≥ 0
        """
        tolerance = as_number(tolerance, "simplification tolerance", or_zero=True)
        edges, sizes = thinned_edges(
            self.nodes, self.edges, self.edge_radii, self.chains, tolerance
        )
        used = np.unique(edges)
        thin = Skeleton(
            self.nodes[used],
            np.searchsorted(used, edges),
            self.radii[used],
            sizes,
        )
        return thin.cleaned(weld_distance=0.0).skeleton


@checks_keywords()
@dataclass(frozen=True, eq=False)
class Cleaning:
    """A repaired skeleton and what was repaired."""

    skeleton: Skeleton
    repairs: Repairs

    def __str__(self) -> str:
        """Return one line: the skeleton, and what was repaired."""
        return f"{self.skeleton}; repaired: {self.repairs}"
