"""Motif: the nodes and struts that one cell adds to an endless lattice, each of them once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import (
    Bools,
    Edges,
    Floats,
    Frozen,
    Ints,
    Points,
    as_edges,
    as_indices,
    as_points,
)
from scaffold_cad.base.vectors import length
from scaffold_cad.errors import SkeletonError

FACE_TOLERANCE = 1e-9
"""Difference below which two coordinates in the unit cube are the same; no unit."""


@dataclass(frozen=True, eq=False)
class Motif(Frozen):
    """What one cell adds to an endless lattice: sites (nodes) and struts, none shared.

    Any node of the lattice is a site moved by whole cells. A strut joins two sites, each moved
    by 0 or 1 cells along x, y and z (or more, in nets of long struts), with 0 for at least one of
    the two along each axis.
    """

    sites: Points
    """Positions in the unit cube, coordinates in [0, 1), shape (k, 3)."""
    site_of_node: Ints
    """Site of which each node of the unit cell is a copy, shape (n,)."""
    struts: Edges
    """Sites that each strut joins, shape (s, 2)."""
    moves: Ints
    """Cells by which each strut's two sites are moved, 0 or 1, shape (s, 2, 3)."""
    copies: Bools
    """Whether the unit cell lists the strut moved by i, j, k cells, shape (s, 2, 2, 2)."""

    def strut_lengths(self, size: Floats) -> Floats:
        """Return the length of each strut in a cell of `size` (3,), shape (s,), in its unit."""
        ends = self.sites[self.struts] + self.moves  # (s, 2, 3)
        return length((ends[:, 1] - ends[:, 0]) * size)


def motif_of(nodes: Points, edges: Edges) -> Motif:
    """Return the motif of a cell's nodes (n, 3), in the closed unit cube, and edges (m, 2)."""
    on_far_face = nodes == 1.0
    sites, site_of_node = _sites(np.where(on_far_face, 0.0, nodes))
    moves = on_far_face[edges].astype(np.intp)  # (m, 2, 3)
    cell = moves.min(axis=1)  # (m, 3)
    moves -= cell[:, None]
    # One number an end, whatever cell the strut is listed in; the lower one first.
    ends = site_of_node[edges] * 8 + moves @ np.array([4, 2, 1])  # (m, 2)
    ends.sort(axis=1)
    struts, strut_of_edge = np.unique(ends, axis=0, return_inverse=True)
    copies = np.zeros((len(struts), 2, 2, 2), dtype=np.bool_)
    copies[strut_of_edge.reshape(-1), cell[:, 0], cell[:, 1], cell[:, 2]] = True
    moves = struts[:, :, None] >> np.array([2, 1, 0]) & 1
    return Motif(sites, site_of_node, struts >> 3, moves, copies)


def _sites(positions: Points) -> tuple[Points, Ints]:
    """Return the distinct rows of `positions` (n, 3) and which of them each row is."""
    ranks = np.stack([_ranks(column) for column in positions.T], axis=1)
    _, first, site = np.unique(ranks, axis=0, return_index=True, return_inverse=True)
    return positions[first], site.reshape(-1)


def _ranks(values: Floats) -> Ints:
    """Return the ranks of `values` (n,), the same for values that differ by the tolerance."""
    order = np.argsort(values, kind="stable")
    steps = np.diff(values[order], prepend=values[order[:1]]) > FACE_TOLERANCE
    ranks = np.empty(len(values), dtype=np.intp)
    ranks[order] = np.cumsum(steps)
    return ranks


def net_motif(name: str, sites: ArrayLike, edges: ArrayLike, moves: ArrayLike) -> Motif:
    """Return the motif of a periodic net; see `UnitCell.of_net`.

    Raises
    ------
    SkeletonError
        If shapes or indices are wrong, or a strut is listed twice.
    """
    given = as_points(sites, f"sites of net {name!r}")
    pairs = as_edges(edges, f"edges of net {name!r}", count=len(given))
    offsets = as_indices(moves, f"moves of net {name!r}", SkeletonError).reshape(-1, 3)
    if len(offsets) != len(pairs):
        raise SkeletonError(
            f"net {name!r} has {len(offsets)} moves of {len(pairs)} edges; need as many"
        )
    whole = np.floor(given + FACE_TOLERANCE).astype(np.intp)
    places = np.maximum(given - whole, 0.0)
    ends = np.stack([whole[pairs[:, 0]], whole[pairs[:, 1]] + offsets], axis=1)  # (m, 2, 3)
    ends = ends - ends.min(axis=1, keepdims=True)
    rows = np.concatenate([pairs, ends.reshape(-1, 6)], axis=1)
    back = np.concatenate([pairs[:, ::-1], ends[:, ::-1].reshape(-1, 6)], axis=1)
    swap = np.array(
        [tuple(b) < tuple(a) for a, b in zip(rows.tolist(), back.tolist(), strict=True)]
    )
    ordered = np.where(swap[:, None], back, rows)
    struts, first = np.unique(ordered, axis=0, return_index=True)
    if len(first) < len(ordered):
        twice = np.setdiff1d(np.arange(len(ordered)), first)[0]
        raise SkeletonError(
            f"net {name!r}: edge {twice} from site {pairs[twice, 0]} to {pairs[twice, 1]} is "
            "listed twice; need each strut once"
        )
    copies = np.zeros((len(struts), 2, 2, 2), dtype=np.bool_)
    copies[:, 0, 0, 0] = True
    return Motif(
        places, np.arange(len(places)), struts[:, :2], struts[:, 2:].reshape(-1, 2, 3), copies
    )
