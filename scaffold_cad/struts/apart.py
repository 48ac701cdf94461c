"""Which parts of round struts keep apart from all that they do not join: a proof by distances.

Pieces, see `pieces`, that share no node must keep apart; those that share one are apart because
the node's body is star-shaped around it, see `proof`, and those of one run are one behind the
other. Pieces are first looked at as capsules, and where these meet as what they are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points
from scaffold_cad.base.blocks import CACHE, blocks, uneven_blocks
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.counts import counting
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import dot, length, normalize, triple
from scaffold_cad.mesh.nearest import nearest_on_triangles
from scaffold_cad.struts.curves.curve import Curves
from scaffold_cad.struts.model import BlendedNodes
from scaffold_cad.struts.options import Ends
from scaffold_cad.struts.pieces import (
    Pieces,
    ball_pieces,
    curve_pieces,
    joined,
    node_pieces,
    sharp_pieces,
    strut_pieces,
    with_domes,
)
from scaffold_cad.struts.runs import Runs
from scaffold_cad.struts.sharp.nodes import SharpNodes

ROUNDS = 40
"""Steps in which a direction is looked for that parts two pieces."""

PAIR_BYTES = 512
"""What a pair of pieces takes where it is looked at."""

LEAST_GAP = 1e-9
"""Gap between pieces that is more than rounding, in their radii."""


@dataclass(frozen=True, eq=False)
class Slack(Frozen):
    """How much thicker pieces are taken to be than they are."""

    ratio: float
    """All of them, in radii."""
    nodes: Floats = field(default_factory=lambda: np.zeros(0))
    """Those at each node at least, mm, shape (n,); none at all by default."""

    def of(self, pieces: Pieces) -> Floats:
        """Return the slack of pieces, in their radii, (c,)."""
        found = np.full(len(pieces.radius), self.ratio)
        body = np.flatnonzero(pieces.hull >= 0)
        if len(self.nodes):
            more = self.nodes[pieces.nodes[body, 0]] / pieces.radius[body]
            found[body] = np.maximum(found[body], more)
        return found


EXACT = Slack(0.0)
"""Pieces as they are."""


@dataclass(frozen=True, eq=False)
class Crossings(Frozen):
    """What of round struts is not known to keep apart."""

    runs: Edges
    """Pairs of runs, each once, shape (p, 2)."""
    nodes: Bools
    """Whether the surface at a node, or of a curve beside it, is near something, shape (n,)."""
    struts: Bools
    """Whether a run is so between its collars, shape (k,)."""


def crossings(
    runs: Runs,
    blended: tuple[BlendedNodes, ...],
    curves: Curves,
    collar: Floats,
    ends: Ends,
    crowded: Bools,
    slack: Slack = EXACT,
    *,
    sharp: tuple[SharpNodes, ...] = (),
) -> Crossings:
    """Return what is not known to keep apart.

    Parameters
    ----------
    collar : (2 k,) distance of each half-run's collar from its node, mm
    ends : round ones reach beyond their nodes
    crowded : (n,) nodes without a surface of their own: there struts go on to the node
    slack : how much thicker all are taken to be: polygons reach beyond their circles
    """
    reach = np.where(crowded[runs.tails], 0.0, collar)
    reach = with_domes(runs, reach, ends, len(runs.nodes), slack.ratio)
    curved = curves.curved & ~crowded[runs.edges].any(axis=1)
    bodies = joined(
        [
            node_pieces(runs, blended),
            curve_pieces(curves),
            sharp_pieces(runs, sharp, collar),
            ball_pieces(runs, collar),
        ]
    )
    own: Bools = ~np.asarray(crowded[bodies.nodes].any(axis=1))
    bodies = bodies.chosen(own)
    straights = strut_pieces(runs, curved, reach)
    struts_count = len(straights.run)
    pieces = joined([straights, bodies])
    pairs = meeting(pieces, slack.of(pieces))
    found = pairs.reshape(-1)
    is_strut = found < struts_count
    nodes, struts = np.zeros(len(runs.nodes), np.bool_), np.zeros(len(runs.edges), np.bool_)
    nodes[pieces.nodes[found[~is_strut]]] = True
    struts[pieces.run[found[is_strut]]] = True
    return Crossings(np.unique(np.sort(pieces.run[pairs], axis=1), axis=0), nodes, struts)


def meeting(pieces: Pieces, slack: Floats) -> Edges:
    """Return the pairs i < j of pieces that are not known to keep apart, shape (p, 2).

    Parameters
    ----------
    slack : (c,) how much thicker each is taken to be, in its radius
    """
    pieces = pieces.thickened(1.0 + slack)
    found = [np.empty((0, 2), dtype=np.intp)]
    for i, j in _near_boxes(pieces):
        apart = _are_neighbors(pieces, i, j)
        i, j = i[~apart], j[~apart]
        a, b = nearest_on_segments(pieces.start[i], pieces.end[i], pieces.start[j], pieces.end[j])
        near = length(a - b) < pieces.radius[i] + pieces.radius[j]
        i, j = i[near], j[near]
        for block in blocks(len(i), PAIR_BYTES, CACHE):
            one, other = i[block], j[block]
            meets = ~_apart(pieces, one, other, slack)
            found.append(np.stack([one[meets], other[meets]], axis=1))
    return np.concatenate(found)


def _near_boxes(pieces: Pieces) -> Iterator[tuple[Ints, Ints]]:
    """Yield blocks of pairs i < j of pieces whose boxes overlap, but for those at one node.

    The pieces at a node all overlap each other: they are first taken together, then run by run.
    """
    reach = pieces.radius[:, None]
    node, alone = pieces.nodes[:, 0], pieces.hull < 0
    body = np.where(alone, node.max(initial=0) + 1 + np.arange(len(node)), node)
    order = np.lexsort((pieces.run, body))
    low = (np.minimum(pieces.start, pieces.end) - reach)[order]
    high = (np.maximum(pieces.start, pieces.end) + reach)[order]
    new_body = np.diff(body[order], prepend=-1) != 0
    new_run = new_body | (np.diff(pieces.run[order], prepend=-1) != 0)
    by_run = np.flatnonzero(new_run)
    by_body = np.flatnonzero(new_body)
    if len(order) == 0:
        return
    bounds = np.append(by_run, len(order)), np.append(np.cumsum(new_run)[by_body] - 1, len(by_run))
    lows, highs = np.minimum.reduceat(low, by_run), np.maximum.reduceat(high, by_run)
    ends = pieces.nodes[order[by_body]]  # (b, 2)
    boxes = np.minimum.reduceat(low, by_body), np.maximum.reduceat(high, by_body)
    with counting("struts and nodes tested for overlaps", len(by_body)) as count:
        for one, other in overlapping_boxes(*boxes, count):
            apart = _share_nodes(ends[one], ends[other])
            for i, j in _parts(one[~apart], other[~apart], bounds[1], lows, highs):
                for k, m in _parts(i, j, bounds[0], low, high):
                    yield np.minimum(order[k], order[m]), np.maximum(order[k], order[m])


def _parts(
    one: Ints, other: Ints, bounds: Ints, low: Points, high: Points
) -> Iterator[tuple[Ints, Ints]]:
    """Yield blocks of the pairs of parts of pairs (p,) whose boxes overlap.

    Parameters
    ----------
    bounds : (n + 1,) the first part of each, in ascending order, and how many there are
    low, high : (parts, 3) corners of their boxes
    """
    tall, wide = bounds[one + 1] - bounds[one], bounds[other + 1] - bounds[other]
    for some in uneven_blocks(tall * wide, PAIR_BYTES):
        sizes = tall[some] * wide[some]
        pair = np.repeat(np.arange(some.start, some.stop), sizes)
        place = steps(sizes)
        i, j = bounds[one[pair]] + place // wide[pair], bounds[other[pair]] + place % wide[pair]
        overlap = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
        yield i[overlap], j[overlap]


def _are_neighbors(pieces: Pieces, i: Ints, j: Ints) -> Bools:
    """Return whether pieces share a node or a run: its collars are one behind the other, (p,)."""
    of_one_run: Bools = pieces.run[i] == pieces.run[j]
    return _share_nodes(pieces.nodes[i], pieces.nodes[j]) | of_one_run


def _share_nodes(a: Edges, b: Edges) -> Bools:
    """Return whether pairs of nodes (p, 2) have one in common, (p,)."""
    shared: Bools = (a[:, 0] == b[:, 0]) | (a[:, 1] == b[:, 1])
    shared |= (a[:, 0] == b[:, 1]) | (a[:, 1] == b[:, 0])
    return shared


def _apart(pieces: Pieces, i: Ints, j: Ints, slack: Floats) -> Bools:
    """Return whether a plane was found between the pieces of each pair, shape (p,).

    Steps toward the point of their difference that is nearest to 0 (Gilbert, Johnson, Keerthi, A
    fast procedure for computing the distance between complex objects in three-dimensional space,
    1988): where the difference lies beyond a plane across the way to it, the pieces are apart, and
    where 0 is within a tetrahedron of it, they meet.
    """
    around = [slack[k] / (1 + slack[k]) * pieces.radius[k] for k in (i, j)]
    middles = [(pieces.start[k] + pieces.end[k]) / 2 for k in (i, j)]
    nearest = middles[0] - middles[1]  # (p, 3), a point of the difference
    corners = np.repeat(nearest[:, None], 3, axis=1)  # (p, 3, 3), of a triangle that it is on
    scale = pieces.radius[i] + pieces.radius[j]
    rows = np.arange(len(i))  # pairs that no plane parts yet
    apart = np.zeros(len(i), dtype=np.bool_)
    for _ in range(ROUNDS):
        far = pieces.furthest(i[rows], -nearest, around[0][rows])
        corner = far - pieces.furthest(j[rows], nearest, around[1][rows])
        parted = dot(corner, normalize(nearest)) > LEAST_GAP * scale[rows]
        apart[rows[parted]] = True
        open_ = ~parted & ~_around_zero(corners, corner)
        rows, corner, corners = rows[open_], corner[open_], corners[open_]
        if len(rows) == 0:
            break
        nearest, corners = _nearest_to_zero(corners, corner)
    return apart


def _around_zero(corners: Floats, last: Points) -> Bools:
    """Return whether 0 is within tetrahedra of triangles (p, 3, 3) and a last corner (p, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    volumes = np.stack([triple(b, c, last), triple(c, a, last), triple(a, b, last)])
    volume = triple(a - last, b - last, c - last)
    within: Bools = (volumes * -np.sign(volume) > 0).all(axis=0) & (triple(a, b, c) * volume > 0)
    return within


def _nearest_to_zero(corners: Floats, last: Points) -> tuple[Points, Floats]:
    """Return the point nearest to 0 on triangles (p, 3, 3) with a corner replaced by the last one.

    And those of these three triangles that it is on, (p, 3, 3).
    """
    triangles = np.repeat(corners[:, None], 3, axis=1)  # (p, 3, 3, 3)
    triangles[:, np.arange(3), np.arange(3)] = last[:, None]
    flat = triangles.reshape(-1, 3, 3)
    feet = nearest_on_triangles(np.zeros((len(flat), 3)), flat).reshape(-1, 3, 3)
    row, best = np.arange(len(feet)), (feet**2).sum(axis=2).argmin(axis=1)
    return feet[row, best], triangles[row, best]
