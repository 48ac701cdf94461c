"""Convex pieces of round struts: what is looked at to tell which keep apart, see `apart`.

Every run is cut into the hulls of slices of the patches between its nodes and its collars, and the
strut between. Cones are bounded by their larger radius, piece by piece.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.blending.quarter import DEGREE
from scaffold_cad.struts.blending.splines import Spline
from scaffold_cad.struts.curves.curve import ALONG, Curves
from scaffold_cad.struts.model import BlendedNodes
from scaffold_cad.struts.options import Ends
from scaffold_cad.struts.runs import Runs, at_balls
from scaffold_cad.struts.sharp.nodes import CORNER, SLIVER, SharpNodes

PIECES = 4
"""Pieces that the strut of a cone is cut into, so that its larger radius bounds little."""

SLICES = 4
"""Slices that patches are cut into from their arcs to their collars."""

_NO_DISCS = np.empty((0, ALONG + 1, 3, 3))


@dataclass(frozen=True, eq=False)
class Pieces(Frozen):
    """Convex pieces, each within a capsule: a segment with a radius."""

    start: Points
    """Shape (c, 3), mm."""
    end: Points
    """Shape (c, 3), mm."""
    radius: Floats
    """Shape (c,), mm."""
    nodes: Edges
    """The one or two nodes that each touches, shape (c, 2); twice the same for one."""
    run: Ints
    """Run that each is of, shape (c,)."""
    hull: Ints
    """Row of `points`, table after table, whose hull it is, or -1 for the cylinder around its
    segment, the ball where that has no length, shape (c,)."""
    points: tuple[Floats, ...]
    """Tables of the points of hulls relative to their node, each of shape (h, k, 3), mm."""
    offset: Points
    """Node of each piece with a hull, shape (c, 3), mm."""
    curve: Ints
    """Row of `discs` whose hull it is, or -1, shape (c,)."""
    discs: Floats
    """Centers and half-diameters of ellipses, shape (d, 4, 3, 3), mm."""

    def thickened(self, factor: Floats) -> Pieces:
        """Return the pieces with radii multiplied by factors (c,) ≥ 1, and as much around hulls."""
        return replace(self, radius=factor * self.radius)

    def chosen(self, keep: Bools) -> Pieces:
        """Return some of the pieces."""
        return Pieces(
            self.start[keep],
            self.end[keep],
            self.radius[keep],
            self.nodes[keep],
            self.run[keep],
            self.hull[keep],
            self.points,
            self.offset[keep],
            self.curve[keep],
            self.discs,
        )

    def furthest(self, piece: Ints, directions: Floats, around: Floats) -> Points:
        """Return the point of each of some pieces that is furthest in a direction, (p, 3).

        Parameters
        ----------
        around : (p,) how far beyond its hull a piece reaches, mm
        """
        start, end = self.start[piece], self.end[piece]
        axis = normalize(end - start)
        across = normalize(directions - dot(directions, axis)[:, None] * axis)
        ahead = dot(directions, end - start) > 0
        found = np.where(ahead[:, None], end, start) + self.radius[piece, None] * across
        hull, first = self.hull[piece], 0
        for table in self.points:
            hulls = np.flatnonzero((hull >= first) & (hull < first + len(table)))
            points = table[hull[hulls] - first]  # (q, k, 3)
            first += len(table)
            # (q, k, 1); einsum takes four times as long.
            along = points @ directions[hulls, :, None]
            best = along[..., 0].argmax(axis=1)
            corner = points[np.arange(len(hulls)), best] + self.offset[piece[hulls]]
            found[hulls] = corner + around[hulls, None] * normalize(directions[hulls])
        curves = np.flatnonzero(self.curve[piece] >= 0)
        corner = _furthest_of_discs(self.discs[self.curve[piece[curves]]], directions[curves])
        found[curves] = corner + around[curves, None] * normalize(directions[curves])
        return found


def _furthest_of_discs(discs: Floats, directions: Floats) -> Points:
    """Return the furthest points of the hulls of ellipses (q, 4, 3, 3) in directions (q, 3)."""
    along = np.einsum("qjkx,qx->qjk", discs, directions)  # of centers and half-diameters
    width = np.hypot(along[..., 1], along[..., 2])  # (q, 4)
    row = np.arange(len(discs))
    best = (along[..., 0] + width).argmax(axis=1)
    place = along[row, best, 1:] / np.maximum(width[row, best], 1e-300)[:, None]  # (q, 2)
    chosen = discs[row, best]
    points: Points = chosen[:, 0] + np.einsum("qk,qkx->qx", place, chosen[:, 1:])
    return points


def with_domes(runs: Runs, collar: Floats, ends: Ends, count: int, slack: float) -> Floats:
    """Return `collar` (2 k,), at round ends as far beyond the node as the strut is thick, < 0.

    Balls are pieces of their own.

    Parameters
    ----------
    count : nodes that are those of a skeleton, the first ones
    slack : how much further they reach, in radii
    """
    at_end = (runs.valency[runs.tails] == 1) & (collar == 0)
    domed = at_end & (runs.tails < count) & (ends == "round")
    return np.where(domed, -(1.0 + slack) * runs.radii.reshape(-1), collar)


def capsules(start: Points, end: Points, radius: Floats, nodes: Edges, run: Ints) -> Pieces:
    """Return pieces that are the cylinders around their segments."""
    none = np.full(len(radius), -1, dtype=np.intp)
    return Pieces(start, end, radius, nodes, run, none, (), np.zeros_like(start), none, _NO_DISCS)


def strut_pieces(runs: Runs, curved: Bools, collar: Floats) -> Pieces:
    """Return the struts between their collars, cones in pieces, but for curved ones."""
    cone = runs.slopes[0::2] != 0
    pieces = np.where(curved, 0, np.where(cone, PIECES, 1))
    run = np.repeat(np.arange(len(pieces)), pieces)
    piece = steps(pieces)
    first, last = collar[0::2][run], (runs.lengths - collar[1::2])[run]
    bounds = [first + (last - first) * (piece + side) / pieces[run] for side in (0, 1)]
    ahead, tail = runs.directions[0::2][run], runs.nodes[runs.edges[run, 0]]
    start, end = (tail + bound[:, None] * ahead for bound in bounds)
    radius = np.maximum(*(runs.radii_at(2 * run, bound) for bound in bounds))
    return capsules(start, end, radius, runs.edges[run], run)


def curve_pieces(curves: Curves) -> Pieces:
    """Return the pieces of curves: the hulls of the discs that control them."""
    first = curves.pieces
    start, end, discs = curves.centers[first], curves.centers[first + 1], curves.frames
    chord = end - start
    along = np.einsum("pjx,px->pj", discs[:, :, 0] - start[:, None], chord)
    share = np.clip(along / dot(chord, chord)[:, None], 0.0, 1.0)
    foot = start[:, None] + share[..., None] * chord[:, None]
    half = discs[:, :, 1:]  # (p, 4, 2, 3)
    wide = np.linalg.norm(half, ord=2, axis=(2, 3))  # half the greatest diameter
    nodes = np.stack([curves.nodes[first], curves.nodes[first + 1]], axis=1)
    none = np.full(len(first), -1, dtype=np.intp)
    return Pieces(
        start,
        end,
        (length(discs[:, :, 0] - foot) + wide).max(axis=1, initial=0.0),
        np.where(nodes < 0, nodes[:, ::-1], nodes),
        curves.run[first],
        none,
        (),
        np.zeros_like(start),
        np.arange(len(first)),
        discs,
    )


def node_pieces(runs: Runs, blended: tuple[BlendedNodes, ...]) -> Pieces:
    """Return what lies between nodes and collars."""
    empty, none = np.empty((0, 3)), np.empty(0, dtype=np.intp)
    nothing = capsules(empty, empty, empty[:, 0], none.reshape(0, 2), none)
    return joined([nothing, *(_node_parts(runs, group) for group in blended)])


def _node_parts(runs: Runs, group: BlendedNodes) -> Pieces:
    """Return what lies between nodes and collars: the hulls of slices of the patches."""
    made, axes = group.shapes, group.axes
    count, valency = axes.shape[:2]
    control = made.control.reshape(count, valency, 4, *made.control.shape[2:])
    cutter = slicing(SLICES, made.layout.v)
    size = 4 * control.shape[3] * cutter.shape[1]
    points = np.empty((count, valency, SLICES, size, 3))
    low, high, wide = np.empty((3, count, valency, SLICES))
    for some in blocks(count, points[:1].nbytes, CACHE):
        slices = np.einsum("sjl,unkilx->unskijx", cutter, control[some])
        points[some] = slices.reshape(-1, valency, SLICES, size, 3)
        along = np.einsum("unspx,unx->unsp", points[some], axes[some])
        low[some] = np.maximum(along.min(axis=3), 0.0)
        high[some] = np.maximum(along.max(axis=3), low[some])
        foot = np.clip(along, low[some, ..., None], high[some, ..., None])
        off = points[some] - foot[..., None] * axes[some, :, None, None]
        wide[some] = length(off).max(axis=3)
    half_runs = np.repeat(group.half_runs.reshape(-1), SLICES)
    first, last, radius = (each[group.shape_of].reshape(-1) for each in (low, high, wide))
    node, ahead = runs.nodes[runs.tails[half_runs]], runs.directions[half_runs]
    return Pieces(
        node + first[:, None] * ahead,
        node + last[:, None] * ahead,
        radius,
        np.repeat(runs.tails[half_runs][:, None], 2, axis=1),
        half_runs >> 1,
        np.arange(low.size).reshape(low.shape)[group.shape_of].reshape(-1),
        (points.reshape(low.size, -1, 3),),
        node,
        np.full(len(node), -1, dtype=np.intp),
        _NO_DISCS,
    )


def sharp_pieces(runs: Runs, sharp: tuple[SharpNodes, ...], collar: Floats) -> Pieces:
    """Return what lies between sharp nodes and collars: cylinders around the struts and the ball.

    The first thickest strut's reaches beyond the node, and is as wide as the ball there; struts
    that end in planes reach as far as the corner in which they meet.

    Parameters
    ----------
    collar : (2 k,) distance of each half-run's collar from its node, mm
    """
    parts = [node_pieces(runs, ())]
    for group in sharp:
        half_runs = group.half_runs.reshape(-1)
        radii = runs.radii.reshape(-1)[group.half_runs]
        wide = np.maximum(radii, radii + runs.slopes[group.half_runs] * collar[group.half_runs])
        row, main = np.arange(len(radii)), radii.argmax(axis=1)
        wide[row, main] = np.maximum(wide[row, main], group.size)
        back = np.zeros_like(radii)
        back[row, main] = -group.size
        mitred = np.array([shape.curves.stars.mitred[0] for shape in group.shapes])
        rows = np.flatnonzero(mitred[group.shape_of])
        reach = CORNER if radii.shape[1] == 2 else SLIVER
        back[rows] = np.minimum(back[rows], -reach * radii[rows])
        node, ahead = runs.nodes[runs.tails[half_runs]], runs.directions[half_runs]
        parts.append(
            capsules(
                node + back.reshape(-1)[:, None] * ahead,
                node + collar[half_runs, None] * ahead,
                wide.reshape(-1),
                np.repeat(runs.tails[half_runs][:, None], 2, axis=1),
                half_runs >> 1,
            )
        )
    return joined(parts)


def ball_pieces(runs: Runs, collar: Floats) -> Pieces:
    """Return the balls at extremities: cylinders around segments of no length.

    Parameters
    ----------
    collar : (2 k,) distance of each half-run's collar from its node, mm
    """
    ends = np.flatnonzero(at_balls(runs, collar))
    node = runs.nodes[runs.tails[ends]]
    size = np.hypot(collar[ends], runs.radii_at(ends, collar[ends]))
    return capsules(node, node, size, np.repeat(runs.tails[ends][:, None], 2, axis=1), ends >> 1)


def joined(parts: list[Pieces]) -> Pieces:
    """Return all pieces."""
    hulls, count = [], 0
    curves, discs = [], 0
    for part in parts:
        hulls.append(np.where(part.hull >= 0, part.hull + count, -1))
        count += sum(len(table) for table in part.points)
        curves.append(np.where(part.curve >= 0, part.curve + discs, -1))
        discs += len(part.discs)
    return Pieces(
        np.concatenate([part.start for part in parts]),
        np.concatenate([part.end for part in parts]),
        np.concatenate([part.radius for part in parts]),
        np.concatenate([part.nodes for part in parts]),
        np.concatenate([part.run for part in parts]),
        np.concatenate(hulls),
        tuple(table for part in parts for table in part.points),
        np.concatenate([part.offset for part in parts]),
        np.concatenate(curves),
        np.concatenate([part.discs for part in parts]),
    )


def slicing(count: int, spline: Spline) -> Floats:
    """Return what takes control points to the Bézier points of equal slices, (count, d + 1, n).

    Parameters
    ----------
    count : of slices, a multiple of the spline's pieces
    """
    at = np.arange(DEGREE + 1) / DEGREE
    places = (np.arange(count)[:, None] + 0.5 * at + 0.25) / count  # inside of a piece
    values = spline.values_at(places.reshape(-1)).reshape(count, DEGREE + 1, spline.count)
    return np.asarray(np.linalg.solve(bernstein(DEGREE, 0.5 * at + 0.25)[None], values), np.float64)
