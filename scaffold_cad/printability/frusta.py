"""How far struts whose radius goes evenly from one end to the other are from each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.skeleton import Skeleton

STEPS = 1000
"""Most steps to the places where two frusta are nearest to each other."""
SETTLED = 1e-8
"""Part of the size of frusta by which places that are nearest move in a step at most."""
TOUCHING = 1e-5
"""Part of the size of frusta below which what is between them is nothing."""


@dataclass(frozen=True, eq=False)
class Frusta:
    """Struts whose radius goes evenly from one end to the other."""

    start: Points
    """First end of the axis, shape (k, 3), mm."""
    axis: UnitVectors
    """From there to the other, shape (k, 3)."""
    lengths: Floats
    """Shape (k,), mm."""
    radii: Floats
    """At the first end, shape (k,), mm."""
    slope: Floats
    """What the radius grows by along the axis, shape (k,)."""

    @classmethod
    def of(cls, skeleton: Skeleton, edges: Ints) -> Frusta:
        """Return some struts of a skeleton, (k,)."""
        start, end = np.moveaxis(skeleton.nodes[skeleton.edges[edges]], 1, 0)
        lengths = length(end - start)
        near, far = skeleton.edge_radii[edges].T
        slope = np.divide(far - near, lengths, out=np.zeros_like(near), where=lengths > 0)
        return cls(start, normalize(end - start), lengths, near, slope)

    def __getitem__(self, rows: Ints | Bools) -> Frusta:
        """Return some of them."""
        start, axis = self.start[rows], self.axis[rows]
        return Frusta(start, axis, self.lengths[rows], self.radii[rows], self.slope[rows])

    def at(self, along: Floats) -> tuple[Points, Floats]:
        """Return places on the axes and the radii there, of distances from the start (k,)."""
        return self.start + along[:, None] * self.axis, self.radii + along * self.slope

    def along(self, points: Points) -> Floats:
        """Return where on the axis the ball is whose surface is nearest to points (k, 3), (k,)."""
        foot = dot(points - self.start, self.axis)
        beside = length(points - self.start - foot[:, None] * self.axis)
        steep = np.abs(self.slope) >= 1.0
        tilt = self.slope / np.sqrt(np.where(steep, 1.0, 1.0 - self.slope**2))
        along = np.where(steep, np.copysign(np.inf, self.slope), foot + beside * tilt)
        return np.clip(along, 0.0, self.lengths)

    def nearest(self, points: Points) -> Points:
        """Return the place between flat ends that is nearest to each point (k, 3), (k, 3).

        In the half-plane of the axis and the point a frustum is a trapezoid.
        """
        off = points - self.start
        x = dot(off, self.axis)
        off = off - x[:, None] * self.axis
        y = length(off)
        far = self.radii + self.slope * self.lengths
        rim = (x + self.slope * (y - self.radii)) / (1.0 + self.slope**2)
        rim = np.clip(rim, 0.0, self.lengths)
        zero = np.zeros_like(x)
        places = (
            (zero, np.minimum(y, self.radii)),
            (self.lengths, np.minimum(y, far)),
            (rim, self.radii + self.slope * rim),
        )
        inside = (x >= 0) & (x <= self.lengths) & (y <= self.radii + self.slope * x)
        at_x, at_y, least = x, y, np.where(inside, 0.0, np.inf)
        for there_x, there_y in places:
            gap = np.hypot(there_x - x, there_y - y)
            nearer = gap < least
            at_x, at_y = np.where(nearer, there_x, at_x), np.where(nearer, there_y, at_y)
            least = np.where(nearer, gap, least)
        outward = off / np.maximum(y, np.finfo(np.float64).tiny)[:, None]
        found: Points = self.start + at_x[:, None] * self.axis + at_y[:, None] * outward
        return found

    def ball(self, end: int) -> tuple[Points, Floats]:
        """Return the nodes at an end, 0 or 1, (k, 3), and the radii there, (k,), mm."""
        return self.at(end * self.lengths)


def between_balls(a: Frusta, b: Frusta) -> tuple[Floats, Points]:
    """Return the room between pairs whose ends are balls, (k,), mm, and where it is, (k, 3).

    The distance of two places on the axes less the radii there is a convex function: it is least
    where both its slopes are 0, or else at an end of one of the two.
    """
    zero = np.zeros(len(a.lengths))
    tried = [
        _level(a, b),
        *((end, b.along(a.at(end)[0])) for end in (zero, a.lengths)),
        *((a.along(b.at(end)[0]), end) for end in (zero, b.lengths)),
    ]
    widths, places = np.full(len(zero), np.inf), np.zeros((len(zero), 3))
    for along_a, along_b in tried:
        (on_a, radii_a), (on_b, radii_b) = a.at(along_a), b.at(along_b)
        room = length(on_a - on_b) - radii_a - radii_b
        nearer = room < widths
        widths[nearer], places[nearer] = room[nearer], ((on_a + on_b) / 2)[nearer]
    return widths, places


def between_flat_ends(
    a: Frusta, b: Frusta, flat_a: Bools, flat_b: Bools, near: Points
) -> tuple[Floats, Points]:
    """Return the room between pairs of which some ends are flat, (k,), mm, and where, (k, 3).

    Parameters
    ----------
    flat_a, flat_b : (k, 2) which ends are flat; the others have a ball
    near : (k, 3) where the room would be if all had
    """
    on_a, on_b = _nearest_places(a, b, near)
    widths, places = length(on_a - on_b), (on_a + on_b) / 2
    widths[widths < TOUCHING * (a.lengths + b.lengths)] = 0.0

    def take(room: Floats, on_a: Points, on_b: Points, there: Bools) -> None:
        nearer = there & (room < widths)
        widths[nearer], places[nearer] = room[nearer], ((on_a + on_b) / 2)[nearer]

    for end in (0, 1):
        (ball_a, radii_a), (ball_b, radii_b) = a.ball(end), b.ball(end)
        on_a, on_b = a.nearest(ball_b), b.nearest(ball_a)
        take(length(ball_a - on_b) - radii_a, ball_a, on_b, ~flat_a[:, end])
        take(length(ball_b - on_a) - radii_b, on_a, ball_b, ~flat_b[:, end])
        for other in (0, 1):
            ball_b, radii_b = b.ball(other)
            room = length(ball_a - ball_b) - radii_a - radii_b
            take(room, ball_a, ball_b, ~flat_a[:, end] & ~flat_b[:, other])
    return widths, places


def _nearest_places(a: Frusta, b: Frusta, near: Points) -> tuple[Points, Points]:
    """Return the places of pairs of frusta that are nearest to each other, (k, 3) both.

    From a place `near` them both go to what is nearest to the middle between them, ahead by how
    far they came in the last step, which is how such steps settle soonest (Beck and Teboulle, A
    Fast Iterative Shrinkage-Thresholding Algorithm, 2009; begun again where they turn back:
    O'Donoghue and Candès, 2015).
    """
    now = np.stack([a.nearest(near), b.nearest(near)])  # (2, k, 3): on a, on b
    found, rows = now.copy(), np.arange(len(a.lengths))
    ahead, speed = now, np.ones(len(rows))
    settled = SETTLED * (a.lengths + b.lengths + a.radii + b.radii)
    for _ in range(STEPS):
        middle = ahead.mean(axis=0)
        new = np.stack([a.nearest(middle), b.nearest(middle)])
        back = ((ahead - new) * (new - now)).sum(axis=(0, 2)) > 0
        speed[back] = 1.0
        faster = (1.0 + np.sqrt(1.0 + 4.0 * speed**2)) / 2.0
        ahead = new + ((speed - 1.0) / faster)[:, None] * (new - now)
        moves = length(new - now).max(axis=0) > settled[rows]
        now, speed = new, faster
        found[:, rows] = now
        if not moves.all():
            a, b, rows = a[moves], b[moves], rows[moves]
            ahead, now, speed = ahead[:, moves], now[:, moves], speed[moves]
        if len(rows) == 0:
            break
    return found[0], found[1]


def _level(a: Frusta, b: Frusta) -> tuple[Floats, Floats]:
    """Return where on the axes of pairs the distance of surfaces has no slope, (k,) each.

    There the line from one place to the other is at the angles to the axes that the surfaces ask
    for. Ends are returned where the axes are parallel, or no line is at these angles.
    """
    cosine = dot(a.axis, b.axis)
    normal = np.cross(a.axis, b.axis)
    squared = dot(normal, normal)  # of the sine
    between = a.start - b.start
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # The line is x a + y b + z normal, 1 long.
        x = (a.slope + cosine * b.slope) / squared
        y = -(b.slope + cosine * a.slope) / squared
        z = np.sqrt((1.0 - x * a.slope + y * b.slope) / squared)
        apart = np.abs(dot(between, normal)) / (z * squared)
        z = np.copysign(z, dot(between, normal))
        line = x[:, None] * a.axis + y[:, None] * b.axis + z[:, None] * normal
        rest = apart[:, None] * line - between
        along, across = dot(rest, a.axis), dot(rest, b.axis)
        on_a, on_b = (along - cosine * across) / squared, (cosine * along - across) / squared
    found = np.isfinite(on_a) & np.isfinite(on_b)
    return (
        np.clip(np.where(found, on_a, 0.0), 0.0, a.lengths),
        np.clip(np.where(found, on_b, 0.0), 0.0, b.lengths),
    )
