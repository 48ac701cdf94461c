"""Distances from the struts of a node, and the filleted union of the struts.

A strut is the region swept by a ball that moves out from the node along a half line while its
radius changes evenly: a cone (or a cylinder) with a spherical end at the node. In the half plane
with t along the axis and q across it, the cone with radius r + s t and tan α = s has the distance
q cos α − t sin α − r cos α where τ = t cos α + q sin α is positive; elsewhere the ball of radius
r cos α about the node is nearest. Both agree at τ = 0 with their gradients.

The filleted union is what a ball of radius ρ cannot reach from outside, with the surfaces near
each point taken as planes: at distances d_j with normals n_j the ball's center is moved by the
shortest y with n_j · y ≥ ρ − d_j for all j, and f = ρ − |y|. Where only one strut is near, f is its
distance; between two whose normals enclose an angle up to π/2 it is the rolling ball's fillet of
radius ρ; and where surfaces go the same way, as at the back of a T or at a mild bend, there is no
fillet and no bulge. Larger angles count as π/2, and f is ρ − |max(ρ − d_j, 0)| there: in acute
corners a ball of radius ρ would stay far out. y is a sum of normals, λ_j ≥ 0 of each.

Coordinates come first and nodes second in all arrays here: (3, M, S) for S points at each of
M nodes, all relative to their node.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen

NEAR_AXIS = 1e-9
"""Part of the radius that points are taken to be away from an axis, where it has no normal."""
SWEEPS = 6
"""Steps in which the shares of normals in the way to the ball's center are found."""
LEAST_SLOPE = 0.1
"""Least length of the gradient that a step divides by: between struts it can vanish."""


@dataclass(frozen=True, eq=False)
class Union(Frozen):
    """Filleted unions of N struts, and of a ball, at M nodes."""

    directions: Floats
    """Unit vectors, shape (3, M, N)."""
    radii: Floats
    """Radius of each strut in the plane across it through the node, mm, shape (M, N)."""
    slopes: Floats
    """Growth of the radius along the strut, mm a mm, shape (M, N)."""
    balls: Floats
    """Radius of the ball, mm, 0 where there is none, shape (M,)."""
    blends: Floats
    """ρ, mm, shape (M,)."""

    def __getitem__(self, item: slice) -> Union:
        return Union(
            self.directions[:, item],
            self.radii[item],
            self.slopes[item],
            self.balls[item],
            self.blends[item],
        )

    @property
    def cosines(self) -> Floats:
        """Cos α of each strut, shape (M, N)."""
        cosines: Floats = 1 / np.sqrt(1 + self.slopes**2)
        return cosines

    def nearest(self, points: Floats) -> Floats:
        """Return the distance of `points` (3, M, S) to the union without fillets, (M, S)."""
        square = _square(points)
        nearest = np.full(square.shape, np.inf)
        for distance, _, _ in self._parts(points, square):
            np.minimum(nearest, distance, out=nearest)
        return nearest

    def deepest(self, points: Floats) -> Floats:
        """Return how deep `points` (3, M, S) are in a strut or ball, over its radius, (M, S)."""
        square = _square(points)
        deepest = np.zeros(square.shape)
        sizes = [self.radii[:, strut, None] for strut in range(self.radii.shape[1])]
        sizes.append(self.balls[:, None])
        for (distance, _, _), size in zip(self._parts(points, square), sizes, strict=False):
            np.maximum(deepest, -distance / np.where(size > 0, size, 1.0), out=deepest)
        return deepest

    def value_and_slope(self, points: Floats) -> tuple[Floats, Floats]:
        """Return f at `points` (3, M, S), shape (M, S), and its gradient of length 1, (3, M, S)."""
        square = _square(points)
        parts = self._parts(points, square)
        distances = np.stack([distance for distance, *_ in parts])  # (N, M, S)
        blends = self.blends[:, None]
        # Far from all struts f is the distance to the nearest one.
        reach = np.maximum(blends, distances.min(axis=0) + 1e-6 * blends)
        needs = np.maximum(
            reach - distances, 0.0
        )  # a node without a ball is infinitely far from it
        by_point = np.stack([part[1] for part in parts])
        by_axis = np.stack(
            [np.zeros_like(square) if part[2] is None else part[2] for part in parts]
        )
        shares, norm = self._shares(points, square, needs, by_point, by_axis)
        step = (shares * by_point).sum(axis=0) * points
        for strut in range(self.radii.shape[1]):
            along = shares[strut] * by_axis[strut]
            for k in range(3):
                step[k] += along * self.directions[k, :, strut, None]
        return reach - norm, step / norm

    def _shares(
        self, points: Floats, square: Floats, needs: Floats, by_point: Floats, by_axis: Floats
    ) -> tuple[Floats, Floats]:
        """Return λ, by which each normal goes into y, (N, M, S), and |y|, (M, S).

        λ ≥ 0 makes e · λ / |y| greatest, e what each distance lacks; found by Gauss and Seidel's
        steps, of which few are enough: |y| is wrong by the square of what λ is.
        """
        count = len(needs)
        along = np.zeros_like(needs)  # of points along axes
        for strut in range(self.radii.shape[1]):
            along[strut] = _along(points, self.directions[:, :, strut])
        axes = np.zeros((3, len(self.blends), count))
        axes[:, :, : self.radii.shape[1]] = self.directions
        cosines = np.zeros((count, *needs.shape))  # 0 on the diagonal
        for i in range(count):
            for j in range(i):
                between = (axes[:, :, i] * axes[:, :, j]).sum(axis=0)[:, None]
                found = by_point[i] * (by_point[j] * square + by_axis[j] * along[j])
                found += by_axis[i] * (by_point[j] * along[i] + by_axis[j] * between)
                cosines[i, j] = cosines[j, i] = np.clip(found, 0.0, 1.0)
        shares = np.where(needs == needs.max(axis=0), needs, 0.0)
        for _ in range(SWEEPS):
            for i in range(count):
                shares[i] = np.maximum(needs[i] - (cosines[i] * shares).sum(axis=0), 0.0)
        moved = shares.copy()
        for i in range(count):
            moved[i] += (cosines[i] * shares).sum(axis=0)
        length = np.sqrt(np.maximum((shares * moved).sum(axis=0), 1e-300))
        return shares, (needs * shares).sum(axis=0) / length

    def projected(self, points: Floats, steps: int, urge: float = 0.0) -> Floats:
        """Return `points` (3, M, S) moved towards f = 0 by Newton steps along the gradient.

        Points inside go further than Newton's step, by the part `urge` of it.
        """
        for _ in range(steps):
            value, gradient = self.value_and_slope(points)
            square = np.maximum(_square(gradient), LEAST_SLOPE)
            if urge:
                value = np.where(value < 0, (1 + urge) * value, value)
            points = points - value / square * gradient
        return points

    def reached(self, directions: Floats, steps: int = 8) -> Floats:
        """Return how far f = 0 is from the node along unit `directions` (3, M, S), mm, (M, S).

        Along a ray all distances grow in proportion and normals stay, so that |y| is convex and
        falls: Newton steps from the surface of the union go up to the root and not past it.
        """
        cosines = self.cosines
        growth, start = [], []
        for strut in range(self.radii.shape[1]):
            cosine = cosines[:, strut, None]
            sine = cosine * self.slopes[:, strut, None]
            t = _along(directions, self.directions[:, :, strut])
            q = np.sqrt(np.maximum(1 - t * t, 0))
            cone = q * cosine - t * sine
            growth.append(np.where(t * cosine + q * sine > 0, np.maximum(cone, 1e-3), 1.0))
            start.append(self.radii[:, strut, None] * cosine)
        growth.append(np.ones_like(growth[0]))
        start.append(np.where(self.balls > 0, self.balls, -np.inf)[:, None])
        far = start[0] / growth[0]
        for rate, radius in zip(growth, start, strict=True):
            far = np.maximum(far, radius / rate)
        for _ in range(steps):
            value, gradient = self.value_and_slope(far * directions)
            rate = (gradient * directions).sum(axis=0)
            far = far - value / np.maximum(rate, LEAST_SLOPE)
        return far

    def _parts(self, points: Floats, square: Floats) -> list[tuple[Floats, Floats, Floats | None]]:
        """Return each strut's and the ball's distance and gradient, all (M, S).

        The gradient is given by its part along the point and its part along the axis.
        """
        cosines = self.cosines
        size = np.sqrt(np.maximum(square, 1e-300))
        inverse = 1 / size
        parts: list[tuple[Floats, Floats, Floats | None]] = []
        straight = (self.slopes == 0).all(axis=0)
        for strut in range(self.radii.shape[1]):
            radius = self.radii[:, strut, None]
            t = _along(points, self.directions[:, :, strut])
            least = (NEAR_AXIS * radius) ** 2
            q = np.sqrt(np.maximum(square - t * t, least))
            if straight[strut]:
                is_beside = t > 0
                distance = np.where(is_beside, q, size) - radius
                by_point = np.where(is_beside, 1 / q, inverse)
                by_axis = np.where(is_beside, -t * by_point, 0.0)
            else:
                cosine = cosines[:, strut, None]
                sine = cosine * self.slopes[:, strut, None]
                is_beside = t * cosine + q * sine > 0
                cone = q * cosine - t * sine
                distance = np.where(is_beside, cone, size) - radius * cosine
                by_point = np.where(is_beside, cosine / q, inverse)
                by_axis = np.where(is_beside, -t * by_point - sine, 0.0)
            parts.append((distance, by_point, by_axis))
        if (self.balls > 0).any():
            ball = np.where(self.balls > 0, self.balls, -np.inf)[:, None]
            parts.append((size - ball, inverse, None))
        return parts


def _square(points: Floats) -> Floats:
    square: Floats = points[0] * points[0]
    square += points[1] * points[1]
    square += points[2] * points[2]
    return square


def _along(points: Floats, axes: Floats) -> Floats:
    """Return the parts of `points` (3, M, S) along `axes` (3, M), shape (M, S)."""
    along: Floats = points[0] * axes[0][:, None]
    along += points[1] * axes[1][:, None]
    along += points[2] * axes[2][:, None]
    return along
