"""Curves as triangles: rings that follow each other along them, closer where they turn more.

A ring stands in a plane. What lies between two rings is seen from its middle, and is on one side
of the planes of both: so neighbors touch in their ring only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.base.vectors import dot, length, normalize, triple
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.bands import enlargement
from scaffold_cad.struts.curved import ALONG, Curves

LEAST_SINE = 1e-9
"""Least sine of the angle at which triangles are seen from the middle between their rings."""


@dataclass(frozen=True, eq=False)
class CurveRings(Frozen):
    """The rings of curves, and how they follow each other."""

    points: Points
    """Points of the rings that are not those of straight struts, shape (v, 3), mm."""
    low: Ints
    """Vertices of the ring before each interval, shape (l, sides)."""
    high: Ints
    """Vertices of the ring after it, shape (l, sides)."""
    piece: Ints
    """Piece of the curves that each interval is in, shape (l,)."""


def largest_growth(sides: int) -> float:
    """Return how much larger than their circles the rings of curves are at most, in radii."""
    step = 2 * np.pi / sides
    return float(enlargement(np.zeros(1), sides)[0]) - 1.0 + step**2 / 12


def curve_rings(curves: Curves, turns: Floats, rings: Ints, count: int, sides: int) -> CurveRings:
    """Return the rings of curves; they are so much larger that volumes are those of the curves.

    Parameters
    ----------
    turns : (p,) how far pieces turn, for the number of their intervals, rad
    rings : (2 k, sides) vertices of the rings of straight struts
    count : vertices so far
    sides : points of a ring
    """
    step = 2 * np.pi / sides
    levels = np.maximum(np.ceil(turns / step - 1e-9), 1).astype(np.intp)  # (p,)
    piece = np.repeat(np.arange(len(levels)), levels)
    place = np.arange(len(piece)) - np.repeat(np.cumsum(levels) - levels, levels) + 1
    curve = curves.curve_of_piece[piece]
    first = np.searchsorted(curve, np.arange(len(curves.half_runs)))
    last = np.searchsorted(curve, np.arange(len(curves.half_runs)), side="right") - 1
    is_own = np.ones(len(piece), dtype=np.bool_)
    is_own[last[~curves.closed]] = False
    high = count + sides * (np.cumsum(is_own) - 1)[:, None] + np.arange(sides)
    start, end = curves.half_runs[~curves.closed].T
    high[last[~curves.closed]] = rings[end]
    low = np.roll(high, 1, axis=0)
    # Seen the way the curve runs, the ring of the strut before it runs the other way round.
    low[first[~curves.closed]] = rings[start][:, -np.arange(sides) % sides]
    low[first[curves.closed]] = high[last[curves.closed]]
    turned = (turns / levels)[piece] ** 2
    following = np.roll(turned, -1)
    following[last[curves.closed]] = turned[first[curves.closed]]
    growth = enlargement(np.zeros(1), sides)[0] + (turned + following) / 24
    points = _points(curves.frames[piece], place / levels[piece], growth, sides)
    return CurveRings(points[is_own].reshape(-1, 3), low, high, piece)


def _points(frames: Floats, at: Floats, growth: Floats, sides: int) -> Points:
    """Return rings at parameters (l,) of pieces with control `frames`, (l, sides, 3), mm."""
    placed = np.einsum("lj,ljkx->lkx", bernstein(ALONG, at), frames)
    angle = 2 * np.pi / sides * np.arange(sides)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    spokes = np.einsum("sk,lkx->lsx", around, placed[:, 1:])
    points: Points = placed[:, :1] + growth[:, None, None] * spokes
    return points


def rings_hold(vertices: Points, rings: CurveRings, triangles: Triangles) -> Bools:
    """Return whether what lies between each two rings is sound, shape (l,).

    Parameters
    ----------
    vertices : (v, 3) of the mesh, as they are written
    triangles : (2 l sides, 3) between the rings
    """
    low, high = vertices[rings.low], vertices[rings.high]  # (l, s, 3)
    count = len(low)
    centers = low.mean(axis=1), high.mean(axis=1)
    beyond = dot(high - centers[0][:, None], _normals(low)[:, None]) > 0
    before = dot(low - centers[1][:, None], _normals(high)[:, None]) < 0
    middle = (centers[0] + centers[1])[:, None] / 2
    corners = vertices[triangles].reshape(count, 2 * rings.low.shape[1], 3, 3)
    a, b, c = np.moveaxis(corners - middle[:, None], 2, 0)
    seen = triple(a, b, c) > LEAST_SINE * length(a) * length(b) * length(c)
    return np.asarray((beyond & before).all(axis=1) & seen.all(axis=1))


def _normals(rings: Points) -> Floats:
    """Return the normals of polygons (l, s, 3), (l, 3)."""
    spokes = rings - rings.mean(axis=1, keepdims=True)
    return normalize(np.cross(spokes, np.roll(spokes, -1, axis=1)).sum(axis=1))
