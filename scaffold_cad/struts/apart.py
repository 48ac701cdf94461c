"""Which parts of round struts keep apart from all that they do not join: a proof by distances.

Every run is cut into capsules: slices of the patches between its nodes and its collars, as wide as
their control points are off its axis, and the strut between. Capsules that share no node must keep
apart; those that share one are apart because the node's body is star-shaped around it, see `proof`,
and those of one run are one behind the other.

Distances of cones are bounded by their larger radius.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import length
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.model import BlendedNodes
from scaffold_cad.struts.quarter import DEGREE
from scaffold_cad.struts.runs import Runs
from scaffold_cad.struts.splines import Spline

PIECES = 4
"""Capsules that the strut of a cone is cut into, so that its larger radius bounds little."""

SLICES = 4
"""Slices that patches are cut into from their arcs to their collars."""


@dataclass(frozen=True, eq=False)
class Capsules(Frozen):
    """Segments with a radius each, and the nodes whose bodies they belong to."""

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

    def thickened(self, factor: float) -> Capsules:
        """Return the same segments with other radii."""
        return Capsules(self.start, self.end, factor * self.radius, self.nodes, self.run)


def meeting_runs(capsules: Capsules) -> Edges:
    """Return the pairs of runs whose capsules meet, each once, shape (p, 2).

    Capsules that share a node, or are of one run, are not compared.
    """
    reach = capsules.radius[:, None]
    low = np.minimum(capsules.start, capsules.end) - reach
    high = np.maximum(capsules.start, capsules.end) + reach
    found = []
    for i, j in overlapping_boxes(low, high):
        i, j = _without_neighbors(capsules, i, j)
        a, b = nearest_on_segments(
            capsules.start[i], capsules.end[i], capsules.start[j], capsules.end[j]
        )
        near = length(a - b) < capsules.radius[i] + capsules.radius[j]
        found.append(np.stack([capsules.run[i[near]], capsules.run[j[near]]], axis=1))
    pairs = np.concatenate(found) if found else np.empty((0, 2), dtype=np.intp)
    pairs = np.sort(pairs, axis=1)
    return np.unique(pairs, axis=0)


def _without_neighbors(capsules: Capsules, i: Ints, j: Ints) -> tuple[Ints, Ints]:
    """Return the pairs that share neither a node nor a run."""
    a, b = capsules.nodes[i], capsules.nodes[j]  # (p, 2)
    shared: Bools = (a[:, :, None] == b[:, None, :]).any(axis=(1, 2))
    shared |= capsules.run[i] == capsules.run[j]  # its collars are one behind the other
    return i[~shared], j[~shared]


def crossing_runs(
    runs: Runs, blended: tuple[BlendedNodes, ...], collar: Floats, slack: float = 0.0
) -> Edges:
    """Return the pairs of runs that are not known to keep apart, each once, shape (p, 2).

    Parameters
    ----------
    collar : (2 k,) distance of each half-run's collar from its node, mm
    slack : how much thicker all are taken to be, in radii: polygons reach beyond their circles
    """
    capsules = [_struts(runs, collar), *(_node_parts(runs, group) for group in blended)]
    every = Capsules(
        *(
            np.concatenate([getattr(part, name) for part in capsules])
            for name in ("start", "end", "radius", "nodes", "run")
        )
    )
    return meeting_runs(every.thickened(1.0 + slack))


def _struts(runs: Runs, collar: Floats) -> Capsules:
    """Return the struts between their collars, cones in pieces."""
    cone = runs.slopes[0::2] != 0
    pieces = np.where(cone, PIECES, 1)
    run = np.repeat(np.arange(len(pieces)), pieces)
    piece = np.arange(len(run)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    first, last = collar[0::2][run], (runs.lengths - collar[1::2])[run]
    bounds = [first + (last - first) * (piece + side) / pieces[run] for side in (0, 1)]
    ahead, tail = runs.directions[0::2][run], runs.nodes[runs.edges[run, 0]]
    start, end = (tail + bound[:, None] * ahead for bound in bounds)
    radius = np.maximum(*(runs.radii_at(2 * run, bound) for bound in bounds))
    return Capsules(start, end, radius, runs.edges[run], run)


def _node_parts(runs: Runs, group: BlendedNodes) -> Capsules:
    """Return what lies between nodes and collars: the hulls of slices of the patches."""
    made, axes = group.shapes, group.axes
    count, valency = axes.shape[:2]
    control = made.control.reshape(count, valency, 4, *made.control.shape[2:])
    slices = np.einsum("sjl,unkilx->unskijx", slicing(SLICES, made.layout.v), control)
    points = slices.reshape(count, valency, SLICES, -1, 3)
    along = np.einsum("unspx,unx->unsp", points, axes)
    low = np.maximum(along.min(axis=3), 0.0)  # (U, N, SLICES)
    high = np.maximum(along.max(axis=3), low)
    foot = np.clip(along, low[..., None], high[..., None])
    wide = length(points - foot[..., None] * axes[:, :, None, None]).max(axis=3)
    half_runs = np.repeat(group.half_runs.reshape(-1), SLICES)
    first, last, radius = (each[group.shape_of].reshape(-1) for each in (low, high, wide))
    node, ahead = runs.nodes[runs.tails[half_runs]], runs.directions[half_runs]
    return Capsules(
        node + first[:, None] * ahead,
        node + last[:, None] * ahead,
        radius,
        np.repeat(runs.tails[half_runs][:, None], 2, axis=1),
        half_runs >> 1,
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
