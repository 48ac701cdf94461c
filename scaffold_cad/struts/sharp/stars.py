"""Stars: nodes from which cylinders and cones leave, whose union is to be made.

A strut's body is the hull of all balls on its axis that touch it: its own ball at the node, and a
cone on from the circle on which it touches that. The union is that of these convex bodies, which
all hold the node, and of the node's ball if that is larger: it is star-shaped around the node.
Lengths are in radii of the largest of the balls, which is 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors

SAME = 1e-9
"""Part of the ball's radius to which radii that agree are equal."""


@dataclass(frozen=True, eq=False)
class SharpStars(Frozen):
    """Nodes of one valency, with struts of any radius and taper."""

    directions: UnitVectors
    """Shape (M, N, 3)."""
    x: UnitVectors
    """Where angles around each strut begin, shape (M, N, 3)."""
    radii: Floats
    """Radius of each strut at the node, shape (M, N)."""
    slopes: Floats
    """Growth of the radius outward, shape (M, N)."""
    mitred: Bools
    """Whether the struts that touch the ball end in the planes between them, and cover it, (M,)."""

    def __len__(self) -> int:
        return len(self.directions)

    def __getitem__(self, rows: Ints | slice) -> SharpStars:
        return SharpStars(
            self.directions[rows],
            self.x[rows],
            self.radii[rows],
            self.slopes[rows],
            self.mitred[rows],
        )

    @cached_property
    def y(self) -> UnitVectors:
        """A quarter turn on from `x`, shape (M, N, 3)."""
        return np.cross(self.directions, self.x)

    @cached_property
    def own_balls(self) -> Floats:
        """Radius of the ball at the node that each strut touches, (M, N)."""
        return self.radii / np.hypot(1.0, self.slopes)

    @cached_property
    def low(self) -> Floats:
        """Where on its axis each strut touches that, and its cone begins, (M, N)."""
        return -self.radii * self.slopes / (1.0 + self.slopes**2)

    @cached_property
    def tangent(self) -> Bools:
        """Whether that is the ball of the node, (M, N)."""
        return self.own_balls >= 1.0 - SAME

    @cached_property
    def leave(self) -> Floats:
        """Where on its axis each strut leaves the ball of the node, (M, N)."""
        r, s = self.radii, self.slopes
        root = np.sqrt(np.maximum(1.0 + s**2 - r**2, 0.0))
        return np.where(self.tangent, self.low, (root - r * s) / (1.0 + s**2))

    def along(self, node: Ints, points: Points) -> Floats:
        """Return how far along each axis points (q, 3) at nodes (q,) are, (q, N)."""
        found: Floats = np.einsum("qnx,qx->qn", self.directions[node], points)
        return found

    @cached_property
    def cornered(self) -> Bools:
        """Which struts end in planes, (M, N)."""
        return self.tangent & self.mitred[:, None]

    def beyond(self, node: Ints, points: Points, along: Floats) -> Floats:
        """Return how far out of each strut points are, negative inside, (q, N)."""
        square = np.einsum("qx,qx->q", points, points)[:, None]
        across = np.sqrt(np.maximum(square - along**2, 0.0))
        radius = self.radii[node] + self.slopes[node] * along
        gap = (across - radius) / np.hypot(1.0, self.slopes[node])
        found: Floats = np.maximum(gap, self.low[node] - along)
        cornered = self.cornered[node]
        ahead = np.where(cornered, along, -np.inf)
        is_first = ahead == ahead.max(axis=1, keepdims=True)
        return np.where(cornered, np.where(is_first, gap, np.inf), found)

    def angles(self, node: Ints, strut: Ints, points: Points) -> Floats:
        """Return the angles around struts (q,) of points (q, 3), in (−π, π], rad, (q,)."""
        x = np.einsum("qx,qx->q", self.x[node, strut], points)
        y = np.einsum("qx,qx->q", self.y[node, strut], points)
        found: Floats = np.arctan2(y, x)
        return found

    def normals(self, node: Ints, strut: Ints, points: Points) -> UnitVectors:
        """Return the normals of struts (q,) at points (q, 3) of them, (q, 3)."""
        axis = self.directions[node, strut]
        across = points - np.einsum("qx,qx->q", axis, points)[:, None] * axis
        across = across / np.linalg.norm(across, axis=1, keepdims=True)
        slope = self.slopes[node, strut][:, None]
        return np.asarray((across - slope * axis) / np.hypot(1.0, slope))
