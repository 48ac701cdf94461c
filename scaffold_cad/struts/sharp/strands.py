"""Strands of a sharp shape: its edges from corner to corner, and which are those of another shape.

A corner is a vertex in which edges of more than one curve meet. What only the seam of the ball
divides is one strand; the seam is in none.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.distance import cdist

from scaffold_cad.base.arrays import Bools, Floats, Frames, Frozen, Ints, Points
from scaffold_cad.base.topology import component_labels
from scaffold_cad.base.vectors import best_turns, length
from scaffold_cad.struts.sharp.outlines import TURN
from scaffold_cad.struts.sharp.shapes import SharpShape

SAMPLES = 8
"""Points of a strand whose mean tells it from others between the same faces."""

NEAR = 1.0
"""Distance by which strands move at most, beyond their lengths, in radii of the ball."""

FAR = 1e6
"""More than all distances between strands, in radii of the ball."""


@dataclass(frozen=True, eq=False)
class Strands(Frozen):
    """The strands of a shape."""

    shape: SharpShape
    curve: Ints
    """Shape (s,)."""
    sides: Ints
    """The two faces that meet in each, the ball as -1, ascending, shape (s, 2)."""
    start: Floats
    """Angle on its curve at which each begins, shape (s,), rad; 0 for those without corners."""
    span: Floats
    """How far it goes, negative against its curve: the first face is to its left; (s,), rad."""
    corners: Ints
    """First and last vertex, -1 for those without corners, shape (s, 2)."""
    of_edge: Ints
    """Strand of each edge of the shape, -1 for seams, shape (e,)."""
    vertices: Points
    """Where the corners are, shape (v, 3)."""

    def placed(self, edge: Ints, angle: Floats) -> tuple[Ints, Floats]:
        """Return where vertices, and points at angles (q,) of edges (q,), are: strands, and shares.

        Vertices of seams alone are on strand -1. Both are (v + q,).
        """
        outlines, ends = self.shape.outlines, self.shape.ends
        own, count = np.flatnonzero(self.of_edge >= 0), len(self.shape.vertices)
        strand = np.concatenate([np.full(count, -1), self.of_edge[edge]])
        strand[ends[own]] = self.of_edge[own, None]
        at = np.concatenate([np.zeros(count), angle])
        at[ends[own]] = np.stack([outlines.start[own], outlines.end[own]], axis=1)
        span = self.span[strand]
        share = np.mod(np.sign(span) * (at - self.start[strand]), TURN) / np.abs(span)
        number, side = np.nonzero(self.corners >= 0)
        corner = self.corners[number, side]
        strand[corner], share[corner] = number, side
        return strand, share

    def corner(self, strand: Ints, share: Floats) -> Ints:
        """Return the vertex at shares (q,) of strands (q,), -1 but for those at corners, (q,)."""
        ends = np.where(share == 0, *self.corners[strand].T)
        return np.where((share == 0) | (share == 1), ends, -1)

    def points(self, strand: Ints, share: Floats) -> Points:
        """Return the points at shares (q,) of strands (q,), (q, 3)."""
        angle = self.start[strand] + share * self.span[strand]
        found = self.shape.curves.points(self.curve[strand], angle)[0]
        corner = self.corner(strand, share)
        found[corner >= 0] = self.vertices[corner[corner >= 0]]
        return found

    def kinds(self) -> Ints:
        """Return the faces of each, and of those without corners the generators' strut, (s, 3)."""
        one = self.shape.curves.one[self.curve]
        return np.column_stack([self.sides, np.where(self.corners[:, 0] < 0, one, -1)])

    def middles(self) -> Points:
        """Return the mean of points of each, (s, 3)."""
        strand = np.repeat(np.arange(len(self.curve)), SAMPLES)
        share = np.tile((np.arange(SAMPLES) + 0.5) / SAMPLES, len(self.curve))
        return np.asarray(self.points(strand, share).reshape(-1, SAMPLES, 3).mean(axis=1))

    def lengths(self) -> Floats:
        """Return how long each is at least, by its ends and its middle, (s,)."""
        every = np.arange(len(self.curve))
        shares = (np.full(len(every), share) for share in (0.0, 0.5, 1.0))
        first, middle, last = (self.points(every, share) for share in shares)
        return length(middle - first) + length(last - middle)

    def contracted(self, rows: Ints) -> Strands:
        """Return the strands, some of them without length: their corners are in their middle."""
        label = component_labels(self.corners[rows], len(self.vertices))
        _, first = np.unique(label, return_index=True)
        vertices, middles = self.vertices.copy(), self.points(rows, np.full(len(rows), 0.5))
        for row, middle in zip(rows.tolist(), middles, strict=True):
            vertices[label == label[self.corners[row, 0]]] = middle
        corners = np.where(self.corners < 0, -1, first[label[self.corners]])
        return replace(self, corners=corners, vertices=vertices)


def strands_of(shape: SharpShape) -> Strands:
    """Return the strands of a shape."""
    own = np.flatnonzero(shape.sides.min(axis=1) < shape.valency)
    is_corner = _corners(shape, own)
    paths = _paths(shape, own, is_corner)
    of_edge = np.full(len(shape.ends), -1)
    for number, path in enumerate(paths):
        of_edge[path] = number
    first, last = np.array([(path[0], path[-1]) for path in paths], dtype=np.intp).T
    begin, end = shape.outlines.start, shape.outlines.end
    span = np.array([float((end - begin)[path].sum()) for path in paths])
    sides, corners = shape.sides[first], np.stack([shape.ends[first, 0], shape.ends[last, 1]], 1)
    sides[sides >= shape.valency] = -1
    back, closed = sides[:, 0] > sides[:, 1], ~is_corner[corners[:, 0]]
    start = np.where(back, begin[first] + span, begin[first])
    corners = np.where(back[:, None], corners[:, ::-1], corners)
    return Strands(
        shape,
        shape.outlines.curve[first],
        np.sort(sides, axis=1),
        np.where(closed, 0.0, start),
        np.where(back, -1.0, 1.0) * np.where(closed, TURN, span),
        np.where(closed[:, None], -1, corners),
        of_edge,
        shape.vertices,
    )


def _paths(shape: SharpShape, own: Ints, is_corner: Bools) -> list[list[int]]:
    """Return the edges of each strand, in the order of their curve; `own` are no seams."""
    curve, ends = shape.outlines.curve.tolist(), shape.ends.tolist()
    begins = {(curve[edge], ends[edge][0]): edge for edge in own.tolist()}
    at_corner = is_corner[shape.ends[own, 0]]
    paths, used = [], set()
    for first in [*own[at_corner].tolist(), *own[~at_corner].tolist()]:
        path, at = [], first
        while at not in used:
            used.add(at)
            path.append(at)
            if not is_corner[ends[at][1]]:
                at = begins[curve[at], ends[at][1]]
        if path:
            paths.append(path)
    return paths


def _corners(shape: SharpShape, own: Ints) -> Bools:
    """Return which vertices are corners, (v,); `own` edges are no seams."""
    ends, count = shape.ends[own], len(shape.vertices)
    low, high = np.full(count, len(shape.curves.node)), np.full(count, -1)
    curve = np.repeat(shape.outlines.curve[own][:, None], 2, axis=1)
    np.minimum.at(low, ends, curve)
    np.maximum.at(high, ends, curve)
    return np.asarray((np.bincount(ends.reshape(-1), minlength=count) > 2) | (low < high))


def whole_turn(before: SharpShape, after: SharpShape) -> Frames:
    """Return how a node turned as a whole, (3, 3)."""
    ways = [shape.curves.stars.directions[0] for shape in (before, after)]
    return np.asarray(best_turns((ways[1].T @ ways[0])[None])[0])


@dataclass(frozen=True, eq=False)
class Matched(Frozen):
    """Which strands of a moved shape those of another one are."""

    strands: Strands
    """Those of the moved shape."""
    number: Ints
    """Which of them each of the others is, -1 for those without length, shape (s,)."""


def matched(before: Strands, after: Strands, used: Ints, short: float) -> Matched | None:
    """Return which strands of a moved shape those of a shape are, or None where edges are others.

    Of strands between the same faces, those that are near each other are the same. They must meet
    in the same corners. A corner may part in the moved shape: the new strand there must be short,
    and is left out.

    Parameters
    ----------
    used : strands of `before` that have points
    short : greatest length of strands that are left out
    """
    from scipy.optimize import linear_sum_assignment  # slow to import, and few struts need it

    turn = whole_turn(before.shape, after.shape)
    other = (before.kinds()[:, None] != after.kinds()).any(axis=2)
    far = cdist(before.middles() @ turn.T, after.middles())
    other |= far > NEAR + before.lengths()[:, None] + after.lengths()
    rows, columns = linear_sum_assignment(np.where(other, FAR, far))
    same = ~other[rows, columns]
    rows, columns = rows[same], columns[same]
    number = np.full(len(before.curve), -1)
    number[rows] = columns
    gone = np.flatnonzero(number < 0)
    new = np.setdiff1d(np.arange(len(after.curve)), columns)
    whole = (before.corners[gone] < 0).any() or (after.corners[new] < 0).any()
    if whole or (number[used] < 0).any() or (after.lengths()[new] > short).any():
        return None
    before, after = before.contracted(gone), after.contracted(new)
    corners = np.stack([before.corners[rows], after.corners[columns]], axis=-1).reshape(-1, 2)
    pairs = np.unique(corners, axis=0)
    if any(len(np.unique(column)) < len(pairs) for column in pairs.T):
        return None
    return Matched(after, number)
