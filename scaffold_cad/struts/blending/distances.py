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
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.vectors import leading_dot
from scaffold_cad.struts.blending.needs import most_needed, nearby, of_many, of_two

NEAR_AXIS = 1e-9
"""Part of the radius that points are taken to be away from an axis, where it has no normal."""
LEAST_SLOPE = 0.1
"""Least length of the gradient that a step divides by: between struts it can vanish."""


@dataclass(frozen=True, eq=False)
class Planes(Frozen):
    """The filleted union near some points: f and its gradient there."""

    points: Floats
    """Shape (3, M, S), mm."""
    values: Floats
    """f, shape (M, S), mm."""
    slopes: Floats
    """Its gradient, shape (3, M, S)."""

    def reached(self, points: Floats, urge: float = 0.0, lift: Floats | None = None) -> Floats:
        """Return points (3, M, S), near those of the planes, moved to f = 0 along the gradient.

        Parameters
        ----------
        points : (3, M, S) float64
        urge : part of Newton's step by which points inside go further
        lift : (M, S) float64, how far each one goes beyond f = 0, mm; not at all if None
        """
        values = self.values
        if points is not self.points:
            values = values + leading_dot(points - self.points, self.slopes)
        if urge:
            values = np.where(values < 0, (1 + urge) * values, values)
        if lift is not None:
            values = values - lift
        found: Floats = points - values / self._squares * self.slopes
        return found

    @cached_property
    def _squares(self) -> Floats:
        return np.asarray(np.maximum(_square(self.slopes), LEAST_SLOPE))


@dataclass(frozen=True, eq=False)
class Union(Frozen):
    """Filleted unions of N struts, and of a ball, at M nodes."""

    directions: Floats
    """Unit vectors, shape (3, M, N)."""
    radii: Floats
    """Radius of each strut in the plane across it through the node, mm, shape (M, N)."""
    slopes: Floats
    """Growth of the radius along the strut, mm per mm, shape (M, N)."""
    balls: Floats
    """Radius of the ball, mm, 0 at nodes without a ball, shape (M,)."""
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
        return np.asarray(self._distances(points, np.sqrt(_square(points))).min(axis=0))

    def _excess(self, every: Floats, size: Floats, most: float) -> Floats:
        """Return by how much points are deeper in a strut or ball than allowed, (M, S).

        Parameters
        ----------
        every : (N + 1, M, S) float64, see `_distances`
        size : (M, S) float64, distances from the node
        most : depth that is allowed, over the radius of the strut
        """
        nearest = (1 - most) * every[-1] + most * size
        for distance, radii in zip(every, self.radii.T, strict=False):
            np.minimum(nearest, distance + most * radii[:, None], out=nearest)
        return np.asarray(-nearest)

    def deepest(self, points: Floats) -> Floats:
        """Return how deep `points` (3, M, S) are in a strut or ball, over its radius, (M, S)."""
        square = _square(points)
        size = np.sqrt(square)
        if self._is_straight:
            deepest = 1 - np.sqrt(self._least_square(points, square))
        else:
            distances = self._distances(points, size)[:-1]
            deepest = np.maximum(-(distances / self.radii.T[..., None]).min(axis=0), 0.0)
            for strut in range(self.radii.shape[1]):
                radius = self.radii[:, strut, None]
                np.maximum(deepest, self.cosines[:, strut, None] - size / radius, out=deepest)
        balls = np.flatnonzero(self.balls > 0)
        deepest[balls] = np.maximum(deepest[balls], 1 - size[balls] / self.balls[balls, None])
        return np.asarray(deepest)

    def _least_square(self, points: Floats, square: Floats) -> Floats:
        """Return the least squared distance from an axis ahead, over its strut's radius, (M, S).

        Parameters
        ----------
        points : (3, M, S) float64
        square : (M, S) float64, their squared distance from the node
        """
        least = np.ones_like(square)
        for strut, radii in enumerate(self.radii.T):
            t = _along(points, self.directions[:, :, strut])
            np.maximum(t, 0.0, out=t)  # behind the end: the ball, which is nearer than the cylinder
            t *= t
            np.subtract(square, t, out=t)
            t *= 1 / radii[:, None] ** 2
            np.minimum(least, t, out=least)
        return np.asarray(np.maximum(least, 0.0, out=least))

    def value_and_slope(self, points: Floats) -> tuple[Floats, Floats]:
        """Return f at `points` (3, M, S), shape (M, S), and its gradient, (3, M, S)."""
        size = np.maximum(np.sqrt(_square(points)), 1e-150)
        return self._filleted(points, self._distances(points, size))

    def _filleted(self, points: Floats, distances: Floats) -> tuple[Floats, Floats]:
        """Return f and its gradient where distances are those (N + 1, M, S)."""
        blends = self.blends[:, None]
        # Far from all struts f is the distance to the nearest one.
        value = distances.min(axis=0)
        reach = np.maximum(blends, value + 1e-6 * blends)
        every = distances.reshape(len(distances), -1)
        reach, value, flat = reach.reshape(-1), value.reshape(-1), points.reshape(3, -1)
        near, other, count = nearby(every, reach)
        row = np.repeat(np.arange(len(self.blends)), points.shape[2])
        slope = self._normals(flat, row, near)

        two = np.flatnonzero(count == 2)
        one, second, far = near[two], other[two], reach[two]
        by_strut = every.reshape(-1)
        lack, second_lack = (far - by_strut[each * len(row) + two] for each in (one, second))
        normals = self._normals(_columns(flat, two), row[two], second)
        norm, turned = of_two(lack, second_lack, _columns(slope, two), normals)
        _put(slope, two, turned)
        value[two] = far - norm
        for most in {3, int(count.max(initial=3))}:
            many = np.flatnonzero((count > 3) if most > 3 else (count == 3))
            if len(many) == 0:
                continue
            struts, lacks = most_needed(_columns(every, many), reach[many], most)
            at, of = _columns(flat, many), row[many]
            norm, turned = of_many(lacks, np.stack([self._normals(at, of, k) for k in struts]))
            _put(slope, many, turned)
            value[many] = reach[many] - norm
        return value.reshape(points.shape[1:]), slope.reshape(points.shape)

    def _distances(self, points: Floats, size: Floats) -> Floats:
        """Return the distances to struts, then to all balls, (N + 1, M, S).

        Behind the end of its cone a strut is a ball, and counts with the node's own.

        Parameters
        ----------
        points : (3, M, S) float64
        size : (M, S) float64, their distance from the node
        """
        every = np.empty((self.radii.shape[1] + 1, *size.shape))
        ball = np.zeros_like(size) + np.where(self.balls > 0, self.balls, -np.inf)[:, None]
        square = size * size
        cosines = self.cosines
        for strut, distance in enumerate(every[:-1]):
            radius = self.radii[:, strut, None]
            cosine = cosines[:, strut, None]
            t = _along(points, self.directions[:, :, strut])
            np.multiply(t, t, out=distance)
            np.subtract(square, distance, out=distance)
            np.maximum(distance, (NEAR_AXIS * radius) ** 2, out=distance)
            np.sqrt(distance, out=distance)
            if self._is_straight:
                is_behind = t <= 0
                distance -= radius
            else:
                sine = cosine * self.slopes[:, strut, None]
                is_behind = t * cosine + distance * sine <= 0
                distance *= cosine
                distance -= t * sine + radius * cosine
            np.maximum(ball, np.where(is_behind, radius * cosine, -np.inf), out=ball)
            np.copyto(distance, np.inf, where=is_behind)
        np.subtract(size, ball, out=every[-1])
        return every

    def _normals(self, points: Floats, row: Ints, strut: Ints) -> Floats:
        """Return the gradients of distances to a strut, or to the ball (N), of each point.

        Parameters
        ----------
        points : (3, P) float64
        row, strut : (P,) intp

        Returns
        -------
        (3, P) float64, unit vectors
        """
        place = row * (self.radii.shape[1] + 1) + strut
        axis = _columns(self._axes, place)  # (3, P), 0 for the ball
        across = points - leading_dot(points, axis) * axis
        across /= np.sqrt(np.maximum(_square(across), 1e-300))
        if self._is_straight:
            return np.asarray(across)
        cosine, sine = _columns(self._leans, place)
        return np.asarray(cosine * across - sine * axis)

    @cached_property
    def _is_straight(self) -> bool:
        """Whether all struts are cylinders."""
        return bool((self.slopes == 0).all())

    @cached_property
    def _axes(self) -> Floats:
        """Directions of each node's struts, then 0 for its ball, shape (3, M (N + 1))."""
        axes = np.pad(self.directions, ((0, 0), (0, 0), (0, 1)))
        return np.ascontiguousarray(axes.reshape(3, -1))

    @cached_property
    def _leans(self) -> Floats:
        """Cos α and sin α of each node's struts, then 1 and 0 for its ball, (2, M (N + 1))."""
        sines = np.pad(self.cosines * self.slopes, ((0, 0), (0, 1)))
        cosines = np.pad(self.cosines, ((0, 0), (0, 1)), constant_values=1.0)
        return np.stack([cosines.reshape(-1), sines.reshape(-1)])

    def planes_at(self, points: Floats) -> Planes:
        """Return f and its gradient at `points` (3, M, S)."""
        return Planes(points, *self.value_and_slope(points))

    def planes_and_excess(self, points: Floats, most: float) -> tuple[Planes, Floats]:
        """Return the planes at `points` (3, M, S), and by how much these are too deep, (M, S).

        That is by how much they are deeper in a strut or ball than allowed, in mm, and negative
        where they are not.

        Parameters
        ----------
        most : depth that is allowed, over the radius of the strut
        """
        size = np.maximum(np.sqrt(_square(points)), 1e-150)
        every = self._distances(points, size)
        return Planes(points, *self._filleted(points, every)), self._excess(every, size, most)

    def projected(self, points: Floats, steps: int) -> Floats:
        """Return `points` (3, M, S) moved toward f = 0 by Newton steps along the gradient."""
        for _ in range(steps):
            points = self.planes_at(points).reached(points)
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


def _columns(rows: Floats, which: Ints) -> Floats:
    """Return some columns of `rows` (k, P): much faster than by an index of two axes."""
    return np.take(rows, which, axis=1)


def _put(rows: Floats, which: Ints, values: Floats) -> None:
    """Set some columns of `rows` (k, P) to `values` (k, p)."""
    for row, new in zip(rows, values, strict=True):
        row[which] = new


def _square(points: Floats) -> Floats:
    return leading_dot(points, points)


def _along(points: Floats, axes: Floats) -> Floats:
    """Return the parts of `points` (3, M, S) along `axes` (3, M), shape (M, S)."""
    along: Floats = points[0] * axes[0][:, None]
    along += points[1] * axes[1][:, None]
    along += points[2] * axes[2][:, None]
    return along
