"""Triangles between two rings of a strut, and the rings' size that makes their volume the strut's.

A ring is n points at equal angles around a strut's axis. The rings at the two ends of a strut may
have another phase: a cylinder has no corners, and a band between two rings needs none. It is turned
by less than half a side.

Radius compensation: a polygon inscribed in a circle has less area than the circle, so rings are
larger than their circles by the factor that gives the band the strut's volume (`enlargement`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, Triangles, UnitVectors
from scaffold_cad.base.vectors import dot


@dataclass(frozen=True, eq=False)
class Matching(Frozen):
    """Which points of the rings at both ends of bands are joined."""

    shift: Ints
    """Point k of the first ring is joined to point shift − k of the second, shape (b,)."""
    twist: Floats
    """Angle from the one to the other about the axis, at most π / n as made, rad, shape (b,)."""


def matching(x: UnitVectors, y: UnitVectors, far_x: UnitVectors, sides: int) -> Matching:
    """Return the matching of least twist of the rings at the two ends of bands.

    Parameters
    ----------
    x, y : (b, 3); point k of the first ring is at the angle 2πk/n from x toward y, seen with the
        band's axis x × y pointing at the viewer
    far_x : (b, 3), at right angles to the axis; where the second ring begins, which runs the
        other way round
    sides : points of a ring, n
    """
    phase = np.arctan2(dot(far_x, y), dot(far_x, x))  # (b,)
    step = 2 * np.pi / sides
    shift = np.round(phase / step).astype(np.intp)
    return Matching(shift, phase - step * shift)


def twist_of(x: UnitVectors, y: UnitVectors, far_x: UnitVectors, sides: int, shift: Ints) -> Floats:
    """Return the twist in (−π, π] of bands whose matching is given, rad, shape (b,)."""
    phase = np.arctan2(dot(far_x, y), dot(far_x, x)) - 2 * np.pi / sides * shift
    twist: Floats = np.pi - np.mod(np.pi - phase, 2 * np.pi)
    return twist


def band_triangles(near: Ints, far: Ints, shift: Ints, twist: Floats) -> Triangles:
    """Return the triangles of bands between rings of vertices, shape (2 n b, 3).

    Parameters
    ----------
    near, far : (b, n) vertices of the rings, each counter-clockwise seen from the other end
    shift, twist : of a `Matching`; the diagonals go with the twist
    """
    count, sides = near.shape
    k = np.arange(sides)
    opposite = far[np.arange(count)[:, None], (shift[:, None] - k) % sides]  # (b, n)
    # The shorter diagonals: from k to what stands over k where the far ring is turned back.
    return between(near, opposite, ~np.broadcast_to((twist > 0)[:, None], near.shape))


def between(near: Ints, far: Ints, ahead: Bools) -> Triangles:
    """Return the triangles between rings whose points stand over each other, (2 n b, 3).

    Parameters
    ----------
    near, far : (b, n) vertices of the rings, counter-clockwise seen from the far one
    ahead : (b, n) whether the diagonal from each point goes to the one after that over it, or that
        from the next point to the one over this
    """
    a, b = near, np.roll(near, -1, axis=1)
    d, c = far, np.roll(far, -1, axis=1)
    triangles = np.empty((*near.shape, 2, 3), dtype=np.intp)
    triangles[:, :, 0, 0], triangles[:, :, 0, 1] = a, b
    triangles[:, :, 0, 2] = np.where(ahead, c, d)
    triangles[:, :, 1, 0] = np.where(ahead, a, b)
    triangles[:, :, 1, 1], triangles[:, :, 1, 2] = c, d
    return triangles.reshape(-1, 3)


def ring_triangles(points: Points, low: Ints, high: Ints) -> Triangles:
    """Return the triangles between rings that follow each other, with the shorter diagonals."""
    near, far = points[low], points[high]  # (r, s, 3)
    ahead = _square(near - np.roll(far, -1, axis=1)) <= _square(np.roll(near, -1, axis=1) - far)
    return between(low, high, ahead)


def _square(vectors: Floats) -> Floats:
    squares: Floats = np.einsum("...i,...i->...", vectors, vectors)
    return squares


def enlargement(twist: Floats, sides: int) -> Floats:
    """Return how much larger than its circles a band's polygons are, for the same volume, (b,).

    Sections of a band have an area that is quadratic in the height: Simpson's rule is exact. The
    middle one has 2 n corners, at the middles of the band's sides and diagonals.
    """
    step, turn = 2 * np.pi / sides, np.abs(twist)
    end = 0.5 * sides * np.sin(step)
    side, diagonal = np.cos(0.5 * turn), np.cos(0.5 * (step - turn))  # distances from the axis
    # Corners at angles turn / 2 and (turn - step) / 2: half a step apart.
    middle = sides * side * diagonal * np.sin(0.5 * step)
    mean = (2.0 * end + 4.0 * middle) / 6.0
    ratio: Floats = np.sqrt(np.pi / mean)
    return ratio


def polygon_wall(sides: int) -> float:
    """Return how thick walls are between polygons of `sides` sides that begin alike.

    It is a part of the distance of their circles.

    Examples
    --------
    >>> round(polygon_wall(16), 4)
    0.9935
    """
    return float(np.cos(np.pi / sides) * enlargement(np.zeros(1), sides)[0])


def polygon_slack(sides: int) -> float:
    """Return how far polygons of `sides` sides reach beyond their circles at most, in radii."""
    step = 2 * np.pi / sides
    twisted, straight = enlargement(np.array([step / 2, 0.0]), sides)
    return float(max(twisted, straight + step**2 / 8)) - 1.0
