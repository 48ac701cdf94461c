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

NEAR_AXIS = 1e-9
"""Part of the radius that points are taken to be away from an axis, where it has no normal."""
SWEEPS = 6
"""Steps in which the shares of normals in the way to the ball's center are found."""
SAME_WAY = 1 - 1e-9
"""Cosine between normals from which on they are taken to be the same."""
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
            values = values + _dot(points - self.points, self.slopes)
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
    """Growth of the radius along the strut, mm a mm, shape (M, N)."""
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
        distances, ball = self._distances(points, np.sqrt(_square(points)))
        return np.asarray(np.minimum(distances.min(axis=0), ball))

    def excess(self, points: Floats, most: float) -> Floats:
        """Return by how much `points` (3, M, S) are deeper in a strut or ball than allowed, (M, S).

        That is in mm, and negative where they are not.

        Parameters
        ----------
        most : depth that is allowed, over the radius of the strut
        """
        size = np.sqrt(_square(points))
        distances, ball = self._distances(points, size)
        for distance, radii in zip(distances, self.radii.T, strict=True):
            distance += most * radii[:, None]
        nearest = distances.min(axis=0)
        return np.asarray(-np.minimum(nearest, (1 - most) * ball + most * size))

    def deepest(self, points: Floats) -> Floats:
        """Return how deep `points` (3, M, S) are in a strut or ball, over its radius, (M, S)."""
        size = np.sqrt(_square(points))
        distances, _ = self._distances(points, size)
        deepest = np.maximum(-(distances / self.radii.T[..., None]).min(axis=0), 0.0)
        for strut in range(self.radii.shape[1]):
            radius = self.radii[:, strut, None]
            np.maximum(deepest, self.cosines[:, strut, None] - size / radius, out=deepest)
        balls = np.flatnonzero(self.balls > 0)
        deepest[balls] = np.maximum(deepest[balls], 1 - size[balls] / self.balls[balls, None])
        return np.asarray(deepest)

    def value_and_slope(self, points: Floats) -> tuple[Floats, Floats]:
        """Return f at `points` (3, M, S), shape (M, S), and its gradient, (3, M, S)."""
        size = np.maximum(np.sqrt(_square(points)), 1e-150)
        distances, ball = self._distances(points, size)
        blends = self.blends[:, None]
        # Far from all struts f is the distance to the nearest one.
        value = np.minimum(distances.min(axis=0), ball)
        reach = np.maximum(blends, value + 1e-6 * blends)
        every = np.concatenate([distances, ball[None]]).reshape(len(distances) + 1, -1)
        reach, value, flat = reach.reshape(-1), value.reshape(-1), points.reshape(3, -1)
        near, other, count = _nearby(every, reach)
        row = np.repeat(np.arange(len(self.blends)), points.shape[2])
        slope = self._normals(flat, row, near)

        two = np.flatnonzero(count == 2)
        one, second, far = near[two], other[two], reach[two]
        by_strut = every.reshape(-1)
        lack, second_lack = (far - by_strut[each * len(row) + two] for each in (one, second))
        normals = self._normals(_columns(flat, two), row[two], second)
        norm, turned = _of_two(lack, second_lack, _columns(slope, two), normals)
        _put(slope, two, turned)
        value[two] = far - norm
        for most in {3, int(count.max(initial=3))}:
            many = np.flatnonzero((count > 3) if most > 3 else (count == 3))
            if len(many) == 0:
                continue
            struts, lacks = _most_needed(_columns(every, many), reach[many], most)
            at, of = _columns(flat, many), row[many]
            norm, turned = _of_many(lacks, np.stack([self._normals(at, of, k) for k in struts]))
            _put(slope, many, turned)
            value[many] = reach[many] - norm
        return value.reshape(ball.shape), slope.reshape(points.shape)

    def _distances(self, points: Floats, size: Floats) -> tuple[Floats, Floats]:
        """Return the distances to struts, (N, M, S), and to all balls, (M, S).

        Behind the end of its cone a strut is a ball, and counts with the node's own.

        Parameters
        ----------
        points : (3, M, S) float64
        size : (M, S) float64, their distance from the node
        """
        distances = np.empty((self.radii.shape[1], *size.shape))
        ball = np.zeros_like(size) + np.where(self.balls > 0, self.balls, -np.inf)[:, None]
        square = size * size
        cosines = self.cosines
        for strut, distance in enumerate(distances):
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
            distance += np.where(is_behind, np.inf, 0.0)
        return distances, size - ball

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
        across = points - _dot(points, axis) * axis
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

    def projected(self, points: Floats, steps: int) -> Floats:
        """Return `points` (3, M, S) moved towards f = 0 by Newton steps along the gradient."""
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


def _nearby(distances: Floats, reach: Floats) -> tuple[Ints, Ints, Ints]:
    """Return two of the distances (n, P) below `reach` (P,), and how many there are, all (P,).

    Where there is only one, it is the first of the two; where there are more, any two are.
    """
    count, total, square = (np.zeros(len(reach), dtype=np.int32) for _ in range(3))
    for strut, distance in enumerate(distances):
        is_near = distance < reach
        count += is_near
        total += np.multiply(is_near, strut, dtype=np.int32)
        square += np.multiply(is_near, strut * strut, dtype=np.int32)
    # Two numbers with a given sum and a given sum of squares; or one, and 0.
    apart = np.sqrt(np.maximum(2 * square - total * total, 0)).astype(np.int32)
    near = np.where(count == 1, total, (total + apart) >> 1)
    near = np.minimum(near, len(distances) - 1)
    return near.astype(np.intp), ((total - apart) >> 1).astype(np.intp), count.astype(np.intp)


def _most_needed(distances: Floats, reach: Floats, most: int) -> tuple[Ints, Floats]:
    """Return which of distances (n, P) are below `reach` (P,), and by how much, both (most, P).

    Where fewer are, the first one stands for the rest, with needs of 0.
    """
    is_near = distances < reach
    found = np.flatnonzero(is_near.T)
    if len(found) == most * len(reach):  # as many at each point
        struts = np.ascontiguousarray((found % len(distances)).reshape(-1, most).T)
        places = struts * len(reach) + np.arange(len(reach))
        return struts, reach - distances.reshape(-1)[places]
    place = np.cumsum(is_near, axis=0) - 1
    which, point = np.nonzero(is_near)
    struts, needs = np.zeros((most, len(reach)), dtype=np.intp), np.zeros((most, len(reach)))
    struts[place[which, point], point] = which
    needs[place[which, point], point] = reach[point] - distances[which, point]
    return struts, needs


def _of_two(one: Floats, other: Floats, first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """Return |y| and its direction where two surfaces are near, (P,) and (3, P).

    Parameters
    ----------
    one, other : (P,) float64, what distances lack
    first, second : (3, P) float64, the normals
    """
    cosine = np.clip(_dot(first, second), 0.0, 1.0)
    # The shares of both, up to a factor; where one is none the other's need is enough for both.
    shares = np.maximum(one - cosine * other, 0.0), np.maximum(other - cosine * one, 0.0)
    is_corner = (shares[0] > 0) & (shares[1] > 0) & (cosine < SAME_WAY)
    sine = np.where(is_corner, np.sqrt(1 - cosine**2), 1.0)
    norm = np.sqrt(one * shares[0] + other * shares[1]) / sine
    norm = np.where(is_corner, norm, np.maximum(one, other))
    parts = (
        np.where(is_corner, share / (sine**2 * norm), is_more)
        for share, is_more in zip(shares, (one >= other, one < other), strict=True)
    )
    return norm, next(parts) * first + next(parts) * second


def _of_many(needs: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """Return |y| and its direction where n surfaces are near, (P,) and (3, P).

    λ ≥ 0 makes e · λ / |y| greatest, e what each distance lacks; found by Gauss and Seidel's
    steps, of which few are enough: |y| is wrong by the square of what λ is.

    Parameters
    ----------
    needs : (n, P) float64, what distances lack
    normals : (n, 3, P) float64
    """
    every = range(len(needs))
    cosines = np.zeros((len(needs), *needs.shape))  # 0 on the diagonal
    for i in every:
        for j in range(i):
            cosines[i, j] = cosines[j, i] = np.clip(_dot(normals[i], normals[j]), 0.0, 1.0)
    # Rounding must not choose between equal needs.
    shares = np.where(needs >= (1 - 1e-9) * needs.max(axis=0), needs, 0.0)
    for _ in range(SWEEPS):
        for i in every:
            shares[i] = np.maximum(needs[i] - (cosines[i] * shares).sum(axis=0), 0.0)
    rest = np.stack([(cosines[i] * shares).sum(axis=0) for i in every])
    square = (shares * (shares + rest)).sum(axis=0)
    norm = (needs * shares).sum(axis=0) / np.sqrt(np.maximum(square, 1e-300))
    return norm, (shares[:, None] * normals).sum(axis=0) / norm


def _square(points: Floats) -> Floats:
    return _dot(points, points)


def _dot(one: Floats, other: Floats) -> Floats:
    """Return the dot products of vectors whose coordinates come first."""
    product: Floats = one[0] * other[0]
    product += one[1] * other[1]
    product += one[2] * other[2]
    return product


def _along(points: Floats, axes: Floats) -> Floats:
    """Return the parts of `points` (3, M, S) along `axes` (3, M), shape (M, S)."""
    along: Floats = points[0] * axes[0][:, None]
    along += points[1] * axes[1][:, None]
    along += points[2] * axes[2][:, None]
    return along
