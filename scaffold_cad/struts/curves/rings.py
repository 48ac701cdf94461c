"""Curves as triangles: rings that follow each other along them, closer where they turn more.

Their chords are no farther from the curve than the patches of nodes are from theirs.

A ring stands in a plane. What lies between two rings is seen from its middle, and is on one side
of the planes of both: so neighbors touch in their ring only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.vectors import dot, length, normalize, triple
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.curves.curve import ALONG, Curves
from scaffold_cad.struts.meshes.bands import enlargement, polygon_slack
from scaffold_cad.struts.meshes.fineness import AHEAD
from scaffold_cad.struts.meshes.volumes import triangle_volumes

T = TypeVar("T", bound=np.generic)

OF_WALL = 0.02
"""How far chords along hollow curves are from these at most, over the wall."""

ROUNDS = 3
"""Times that the volume of curves is looked at."""

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


def curve_rings(curves: Curves, levels: Ints, rings: Ints, ends: Points, count: int) -> CurveRings:
    """Return the rings of curves; they are so much larger that volumes are those of the curves.

    Parameters
    ----------
    levels : (p,) see `intervals_of`
    rings : (2 k, sides) vertices of the rings of straight struts
    ends : (c', 2, sides, 3) points of those on which the curves that are not closed begin and end
    count : vertices so far
    """
    sides = rings.shape[1]
    found = intervals(curves, levels)
    order, is_own = found.order, found.order.is_own
    high = count + sides * (np.cumsum(is_own) - 1)[:, None] + np.arange(sides)
    start, end = curves.half_runs[~curves.closed].T
    high[order.last] = rings[end]
    # Seen the way the curve runs, the ring of the strut before it runs the other way round.
    backward = -np.arange(sides) % sides
    low = order.before(high, rings[start][:, backward])
    frames, piece = found.frames, found.piece
    turned = (curves.turns / levels)[piece] ** 2
    growth = enlargement(np.zeros(1), sides)[0] + (turned + order.after(turned)) / 24
    wanted = _sums(piece_volumes(curves), curves.curve_of_piece, len(curves.closed))
    ends = np.stack([ends[:, 0, backward], ends[:, 1]], axis=1)
    points = _grown(frames, order, growth, ends, wanted)
    return CurveRings(points[is_own].reshape(-1, 3), low, high, piece)


@dataclass(frozen=True, eq=False)
class Intervals(Frozen):
    """What lies between neighboring rings of curves."""

    piece: Ints
    """Piece that each interval is in, shape (l,)."""
    order: Order
    """How they follow each other."""
    frames: Floats
    """Center and half-diameters of the circle after each interval, shape (l, 3, 3), mm."""


def intervals_of(curves: Curves, sides: int, wall: float | None) -> Ints:
    """Return how many intervals each piece has, (p,), between rings of `sides` points.

    They turn by 2π / sides at most, and chords along them are from the curve at most `AHEAD` times
    as far as the sides of these polygons are from their circles, and `OF_WALL` of a wall.

    Parameters
    ----------
    wall : of hollow curves, mm
    """
    step, first = 2 * np.pi / sides, curves.pieces
    span = length(curves.centers[first + 1] - curves.centers[first])
    radius = np.minimum(curves.outline[first], curves.outline[first + 1])
    rise = span * curves.turns / 8  # of an arc over its chord, mm
    most = np.minimum(AHEAD * (1 - np.cos(step / 2)) * radius, OF_WALL * (wall or np.inf))
    least = np.sqrt(rise / most)
    levels: Ints = np.ceil(np.maximum(curves.turns / step, least) - 1e-9).astype(np.intp)
    return np.maximum(levels, 1)


def intervals(curves: Curves, levels: Ints) -> Intervals:
    """Return the intervals of curves, for the number of those of each piece, (p,)."""
    piece = np.repeat(np.arange(len(levels)), levels)
    place = steps(levels) + 1
    frames = np.einsum(
        "lj,ljkx->lkx", bernstein(ALONG, place / levels[piece]), curves.frames[piece]
    )
    return Intervals(piece, Order(curves.curve_of_piece[piece], curves.closed), frames)


@dataclass(frozen=True, eq=False)
class Order(Frozen):
    """How the intervals of curves follow each other; each is known by the ring after it."""

    curve: Ints
    """Curve of each, ascending, shape (l,)."""
    closed: Bools
    """Whether each curve is closed, shape (c,)."""

    @cached_property
    def last(self) -> Ints:
        """The last ones of curves that are not closed, shape (c',)."""
        return np.searchsorted(self.curve, np.flatnonzero(~self.closed), side="right") - 1

    @cached_property
    def is_own(self) -> Bools:
        """Whether the ring after each is one of curves, not of a straight strut, shape (l,)."""
        found = np.ones(len(self.curve), dtype=np.bool_)
        found[self.last] = False
        return found

    def before(self, values: NDArray[T], starts: NDArray[T]) -> NDArray[T]:
        """Return what the rings before intervals have, (l, ...).

        Parameters
        ----------
        values : (l, ...) of the rings after them
        starts : (c', ...) of the rings on which curves that are not closed begin
        """
        found = np.roll(values, 1, axis=0)
        first, last = self._closed
        found[first] = values[last]
        found[np.searchsorted(self.curve, np.flatnonzero(~self.closed))] = starts
        return found

    def after(self, values: Floats) -> Floats:
        """Return the values (l,) of the intervals after the rings that are of curves, (l,)."""
        found = np.roll(values, -1)
        first, last = self._closed
        found[last] = values[first]
        return found

    @cached_property
    def _closed(self) -> tuple[Ints, Ints]:
        """The first and the last ones of closed curves."""
        curves = np.flatnonzero(self.closed)
        ends = [np.searchsorted(self.curve, curves, side=side) for side in ("left", "right")]
        return ends[0], ends[1] - 1


def _grown(frames: Floats, order: Order, growth: Floats, ends: Points, wanted: Floats) -> Points:
    """Return rings (l, sides, 3) that make up for the volumes (c,) of curves, mm.

    Parameters
    ----------
    frames : (l, 3, 3) center and half-diameters of each ring's circle, mm
    growth : (l,) how much larger than these the rings are at first
    ends : (c', 2, sides, 3) rings on which the curves begin and end that are not closed
    """
    sides = ends.shape[2]
    angle = 2 * np.pi / sides * np.arange(sides)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    spokes = np.einsum("sk,lkx->lsx", around, frames[:, 1:])
    centers, area = frames[:, 0], np.pi * length(np.cross(frames[:, 1], frames[:, 2]))
    way = length(centers - order.before(centers, ends[:, 0].mean(axis=1)))
    slope = np.where(order.is_own, area * (way + order.after(way)), 0.0)
    slopes = np.maximum(_sums(slope, order.curve, len(wanted)), 1e-300)
    most = 1.0 + polygon_slack(sides)
    for _ in range(ROUNDS):
        points: Points = centers[:, None] + growth[:, None, None] * spokes
        points[order.last] = ends[:, 1]
        found = _volumes(order.before(points, ends[:, 0]), points)
        missing = wanted - _sums(found, order.curve, len(wanted))
        growth = np.minimum(growth + (missing / slopes)[order.curve], most)
    return points


def piece_volumes(curves: Curves) -> Floats:
    """Return the volume of each piece between its two circles, (p,), mm³.

    That of the image of (x, y, v) ↦ A(v) + B(v) (x, y): over the unit disc only det(A', B) counts.
    """
    nodes, weights = np.polynomial.legendre.leggauss(5)
    at = np.asarray((nodes + 1) / 2, dtype=np.float64)
    placed = np.einsum("gj,pjkx->gpkx", bernstein(ALONG, at), curves.frames)
    ahead = np.einsum("gj,pjx->gpx", bernstein(ALONG, at, 1), curves.frames[:, :, 0])
    volumes: Floats = (
        np.pi / 2 * np.asarray(weights) @ triple(ahead, placed[:, :, 1], placed[:, :, 2])
    )
    return volumes


def _sums(values: Floats, rows: Ints, count: int) -> Floats:
    """Return the sum of the values of each row, (count,)."""
    return np.asarray(np.bincount(rows, values, count), dtype=np.float64)


def _volumes(low: Points, high: Points) -> Floats:
    """Return the volume between rings (l, sides, 3) and the next, (l,), mm³."""
    centers = low.mean(axis=1), high.mean(axis=1)
    middle = (centers[0] + centers[1]) / 2
    between = np.stack([low, high], axis=1) - middle[:, None, None]
    discs = [
        dot(np.cross(ring, np.roll(ring, -1, axis=1)).sum(axis=1), center - middle) / 6
        for ring, center in zip(
            (low - centers[0][:, None], high - centers[1][:, None]), centers, strict=True
        )
    ]
    return triangle_volumes(between[:, None]) + discs[1] - discs[0]


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
