"""How unit cells are made: nets of sites at one distance, cells merged, cells in their box."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Edges, Ints, Points
from scaffold_cad.base.vectors import length
from scaffold_cad.lattice.unitcell import UnitCell

CORNER = [[0, 0, 0]]
CENTER = [[0.5, 0.5, 0.5]]
FACE_CENTERS = [[0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]]
EDGE_CENTERS = [[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]]
QUARTERS = list(product([0.25, 0.75], repeat=3))


def copies_of(sites: ArrayLike) -> Points:
    """Return all copies of `sites` (k, 3) in the closed unit cube."""
    steps = np.array(list(product([0, 1], repeat=3)))
    moved = (np.asarray(sites, dtype=np.float64)[:, None] + steps).reshape(-1, 3)
    copies: Points = moved[(moved <= 1 + 1e-12).all(axis=1)]
    return copies


def pairs_apart(a: Points, b: Points, distance: float) -> Edges:
    """Return pairs of a row of `a` and a row of `b` that are `distance` apart, (m, 2)."""
    gaps = length(a[:, None] - b)
    return np.argwhere(np.abs(gaps - distance) < 1e-9)


def net(name: str, sites: ArrayLike, distance: float, description: str) -> UnitCell:
    """Return the cell with struts between all copies of `sites` that are `distance` apart."""
    nodes = copies_of(sites)
    edges = pairs_apart(nodes, nodes, distance)
    return cell_of(name, nodes, edges[edges[:, 0] < edges[:, 1]], description)


def spaced_net(
    name: str,
    sites: ArrayLike,
    distances: Sequence[float],
    description: str,
) -> UnitCell:
    """Return the net with struts between all sites of an endless cubic lattice at some distances.

    Struts may go through the faces of the cube, see `UnitCell.of_net`.
    """
    places = np.asarray(sites, dtype=np.float64)
    steps = np.array(list(product([-1, 0, 1], repeat=3)))
    others = (places[:, None] + steps).reshape(-1, 3)
    pairs = np.concatenate([pairs_apart(places, others, distance) for distance in distances])
    other, step = np.divmod(pairs[:, 1], len(steps))
    moves = steps[step]
    # Each strut is found from both of its ends.
    first = [
        a < b or (a == b and tuple(move) > (0, 0, 0))
        for a, b, move in zip(pairs[:, 0].tolist(), other.tolist(), moves.tolist(), strict=True)
    ]
    keep = np.flatnonzero(first)
    edges = np.stack([pairs[keep, 0], other[keep]], axis=1)
    return UnitCell.of_net(name, places, edges, moves[keep], description)


def two_nets(
    name: str, sites: ArrayLike, others: ArrayLike, distance: float, description: str
) -> UnitCell:
    """Return the cell with struts between `sites` and `others` that are `distance` apart."""
    a, b = copies_of(sites), copies_of(others)
    edges = pairs_apart(a, b, distance) + np.array([0, len(a)])
    return cell_of(name, np.concatenate([a, b]), edges, description)


def cell_of(
    name: str,
    nodes: ArrayLike,
    edges: Ints,
    description: str,
    proportions: ArrayLike = (1.0, 1.0, 1.0),
) -> UnitCell:
    """Return the cell without the nodes that no strut reaches."""
    used = np.unique(edges)
    kept = np.asarray(nodes, dtype=np.float64)[used]
    return UnitCell(
        name, kept, np.searchsorted(used, edges), description, np.asarray(proportions, dtype=float)
    )


def merged(name: str, *parts: UnitCell, description: str) -> UnitCell:
    """Return the cell with the struts of all `parts`."""
    nodes, edges = parts[0].nodes, parts[0].edges
    for part in parts[1:]:
        gaps = length(part.nodes[:, None] - nodes)
        known = gaps.min(axis=1) < 1e-9
        rank = np.where(known, gaps.argmin(axis=1), len(nodes) + np.cumsum(~known) - 1)
        nodes = np.concatenate([nodes, part.nodes[~known]])
        edges = np.concatenate([edges, rank[part.edges]])
    return cell_of(name, nodes, edges, description)
