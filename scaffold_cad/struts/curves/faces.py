"""Faces of curves: four splines per curve, from the circle of one straight strut to the next one's.

A closed curve is two parts, joined in circles of its own. Knots are where the joints are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points
from scaffold_cad.base.ranges import steps
from scaffold_cad.brep.analytic import Axes, Knots, SplineCurves, SplinePatches
from scaffold_cad.struts.blending.quarter import ARC, DEGREE
from scaffold_cad.struts.curves.curve import ALONG, Curves

QUARTER = np.pi / 2


@dataclass(frozen=True, eq=False)
class CurveParts(Frozen):
    """Parts of curves that four faces go around: open curves, and halves of closed ones."""

    curves: Curves
    first: Ints
    """First piece of each part, shape (q,)."""
    last: Ints
    """Piece after the last one of each part, shape (q,)."""
    half_runs: Ints
    """Half-runs whose circles bound each part, -1 for circles of its own, shape (q, 2)."""
    rings: Ints
    """Circles of curves that bound each part, as numbers of `own`, -1 for others, shape (q, 2)."""
    own: Ints
    """Circles in which halves of closed curves meet, shape (r,)."""

    @staticmethod
    def of(curves: Curves) -> CurveParts:
        """Return the parts of curves."""
        counts = np.diff(curves.offsets) - 1
        begin = np.cumsum(counts) - counts  # first piece of each curve
        halves = np.where(curves.closed, 2, 1)
        curve = np.repeat(np.arange(len(counts)), halves)
        half = steps(halves)
        closed = curves.closed[curve]
        middle = np.where(closed, counts[curve] // 2, counts[curve])
        first = begin[curve] + np.where(half == 1, middle, 0)
        last = begin[curve] + np.where(half == 1, counts[curve], middle)
        number = 2 * (np.cumsum(curves.closed) - 1)[curve]
        rings = np.stack([number + half, number + 1 - half], axis=1)
        start = curves.offsets[:-1][curves.closed]
        own = np.stack([start, start + counts[curves.closed] // 2], axis=1).reshape(-1)
        return CurveParts(
            curves, first, last, curves.half_runs[curve], np.where(closed[:, None], rings, -1), own
        )

    @cached_property
    def curve(self) -> Ints:
        """Curve of each part, shape (q,)."""
        return self.curves.curve_of_piece[self.first]

    @property
    def ring_points(self) -> Points:
        """Corners of the circles of their own, four each, shape (4 r, 3), mm."""
        made, own = self.curves, self.own
        spokes = np.stack([made.x[own], made.y[own], -made.x[own], -made.y[own]], axis=1)
        points: Points = made.centers[own, None] + made.radii[own, None, None] * spokes
        return points.reshape(-1, 3)

    @property
    def ring_axes(self) -> Axes:
        """Placements of their quarters, (4 r)."""
        own = np.repeat(self.own, 4)
        return Axes(self.curves.centers[own], self.curves.tangents[own], self.curves.x[own])

    @property
    def ring_radii(self) -> Floats:
        """Radius of each quarter, shape (4 r,), mm."""
        return np.repeat(self.curves.radii[self.own], 4)

    @property
    def ring_angles(self) -> Floats:
        """First and last angle of each quarter, shape (4 r, 2), rad."""
        return np.tile(QUARTER * np.array([[0, 1], [1, 2], [2, 3], [3, 4]]), (len(self.own), 1))

    @cached_property
    def patches(self) -> tuple[SplinePatches, ...]:
        """Four patches a part."""
        return tuple(self._patches(part) for part in range(len(self.first)))

    @property
    def spokes(self) -> tuple[SplineCurves, ...]:
        """The curves where these patches begin, four a part."""
        return tuple(SplineCurves(table.control[:, 0], table.v) for table in self.patches)

    def _patches(self, part: int) -> SplinePatches:
        pieces = np.arange(self.first[part], self.last[part])
        frames = self.curves.frames[pieces]  # (p, 4, 3, 3)
        # Between two pieces the control point on the circle follows from its neighbors.
        rows = np.concatenate([frames[:1, 0], frames[:, 1:3].reshape(-1, 3, 3), frames[-1:, 3]])
        lengths = np.cumsum(self.curves.speeds[pieces])
        values = np.concatenate([[0.0], lengths / lengths[-1]])
        counts = np.full(len(values), ALONG - 1)
        counts[[0, -1]] = ALONG + 1
        turned = np.stack([ARC, ARC @ _TURN, -ARC, -ARC @ _TURN])  # (4, D + 1, 2)
        control = rows[:, 0] + np.einsum("qik,jkx->qijx", turned, rows[:, 1:])
        return SplinePatches(control, _ACROSS, Knots(values, counts))


_TURN = np.array([[0.0, 1.0], [-1.0, 0.0]])
_ACROSS = Knots(np.array([0.0, 1.0]), np.full(2, DEGREE + 1, dtype=np.intp))
