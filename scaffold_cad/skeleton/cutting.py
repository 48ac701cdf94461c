"""Graphs of straight edges cut at the surface of a region."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.regions import Region
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import length, sums_by_row


@dataclass(frozen=True, eq=False)
class Pieces:
    """Edges cut into pieces; the new nodes come after the old ones."""

    nodes: Points
    """Shape (n + k, 3), mm."""
    edges: Edges
    """Shape (p, 2)."""
    source: Ints
    """Edge that each piece is of, shape (p,)."""
    along: Floats
    """Where each piece begins and ends on it, from 0 to 1, shape (p, 2)."""

    def kept(self, keep: Bools) -> Pieces:
        """Return the pieces marked in `keep` (p,); all nodes stay."""
        return Pieces(self.nodes, self.edges[keep], self.source[keep], self.along[keep])

    @property
    def lengths(self) -> Floats:
        """Length of each piece, shape (p,), mm."""
        return length(self.nodes[self.edges[:, 1]] - self.nodes[self.edges[:, 0]])

    @property
    def middles(self) -> Points:
        """Middle of each piece, shape (p, 3), mm."""
        return (self.nodes[self.edges[:, 0]] + self.nodes[self.edges[:, 1]]) / 2


def cut_at(nodes: Points, edges: Edges, edge: Ints, along: Floats) -> Pieces:
    """Return the edges cut at the places given, which are in order of edge and `along`.

    Cut k is made between pieces `edge[k] + k` and `edge[k] + k + 1`.

    Parameters
    ----------
    nodes, edges : (n, 3) float64, mm, and (m, 2) intp
    edge : (k,) intp
    along : (k,) float64, in (0, 1)
    """
    start, end = nodes[edges[edge, 0]], nodes[edges[edge, 1]]
    new = len(nodes) + np.arange(len(edge))
    cuts = np.bincount(edge, minlength=len(edges))
    source = np.repeat(np.arange(len(edges)), cuts + 1)
    pieces = edges[source]
    places = np.tile([0.0, 1.0], (len(pieces), 1))
    before = edge + np.arange(len(edge))
    pieces[before, 1] = pieces[before + 1, 0] = new
    places[before, 1] = places[before + 1, 0] = along
    return Pieces(
        np.concatenate([nodes, start + along[:, None] * (end - start)]), pieces, source, places
    )


def inside(
    nodes: Points,
    edges: Edges,
    region: Region,
    at: Callable[[Ints, Floats], Points] | None = None,
) -> Pieces:
    """Return the pieces of edges that lie in a region.

    Only where the pieces on both sides of a crossing differ is an edge cut: one along a face or
    through an edge of the surface stays whole.

    Parameters
    ----------
    at : of edges (k,) and places along them (k,), from 0 to 1, where what they stand for is,
        (k, 3), mm; by default on the edges
    """
    spans = length(nodes[edges[:, 1]] - nodes[edges[:, 0]])
    edge, along = _ordered(*region.crossings(nodes, edges), spans, region.tolerance)
    pieces = cut_at(nodes, edges, edge, along)
    middle = pieces.middles if at is None else at(pieces.source, pieces.along.mean(axis=1))
    is_inside = region.contains(middle)
    before = edge + np.arange(len(edge))
    real = is_inside[before] != is_inside[before + 1]
    starts_piece = np.ones(len(is_inside), dtype=np.bool_)
    starts_piece[before + 1] = real
    return cut_at(nodes, edges, edge[real], along[real]).kept(is_inside[starts_piece])


def drawn_together(nodes: Points, edges: Edges, short: Bools, fixed: Bools) -> tuple[Points, Ints]:
    """Return positions and the number of each node when edges are shrunk to nothing.

    The nodes that they join become one, in the middle of those that are `fixed` if any is.

    Parameters
    ----------
    short : (m,) edges that go
    fixed : (n,) nodes that keep their places

    Returns
    -------
    (c, 3) float64, mm; (n,) intp
    """
    label = component_labels(edges[short], len(nodes))
    has_fixed = np.bincount(label, weights=fixed) > 0
    weight = np.where(has_fixed[label], fixed, True).astype(np.float64)
    total = np.bincount(label, weights=weight)
    return sums_by_row(weight[:, None] * nodes, label, len(total)) / total[:, None], label


def _ordered(edge: Ints, along: Floats, spans: Floats, tolerance: float) -> tuple[Ints, Floats]:
    """Return the crossings in order of edge and place, without repeats and those at ends."""
    apart: Bools = np.minimum(along, 1 - along) * spans[edge] > tolerance
    edge, along = edge[apart], along[apart]
    order = np.lexsort([along, edge])
    edge, along = edge[order], along[order]
    repeat = np.zeros(len(edge), dtype=np.bool_)
    repeat[1:] = (edge[1:] == edge[:-1]) & (np.diff(along) * spans[edge[1:]] <= tolerance)
    return edge[~repeat], along[~repeat]
