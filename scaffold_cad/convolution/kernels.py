"""Kernels of convolution surfaces, and their integrals along edges in closed form.

The kernel's width grows with the radius along the edge. Seen from a point p, what counts is its
offset from each point s of the edge, measured in the radius there: v(s) = (p − s) / r(s). With
h(|v|²) the kernel and N its norm, the integral is

    f(p) = 1/N ∫ h(|v|²) ds / r.

It has no unit, so that a skeleton and its surface can be scaled together, and it adds up when an
edge is cut in two. N is such that f = 1 at distance r from an endless straight edge of radius r:
there the surface f = 1 is exactly its cylinder.

References
----------
Zanni, Bernhardt, Quiblier, Cani, SCALe-invariant integral surfaces, Computer Graphics Forum 32(8),
2013: the weight ds / r.
Hubert, Cani, Convolution surfaces based on polygonal curve skeletons, JSC 47(6), 2012: kernels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from scaffold_cad.base.arrays import Floats

SERIES_LIMIT = 0.3
"""Where the moments of 1 / (1 − e z) are taken from their series rather than from a logarithm,
which loses a factor of e⁻⁶ of its precision."""

SERIES_TERMS = 15
"""Terms of that series: those left out are below 0.3³⁰."""

ENDLESS = 1e3
"""Length of an edge whose start its end does not feel, in radii."""

CUTS, PLACES = 6, 1025
"""How often a range is narrowed down to one of its parts, and how many places bound these: in all
by 2⁶⁰, beyond what floating point tells apart."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Points, and edges whose field is asked for there.

    The first two are of one shape, to which the others are broadcast.
    """

    along: Floats
    """How far along the edge's line the foot of the point lies, from its start, mm."""
    off: Floats
    """Squared distance of the point from that line, mm²."""
    length: Floats
    """Length of the edge, mm."""
    start_radius: Floats
    """Radius at the edge's start, mm."""
    end_radius: Floats
    """Radius at its end, mm."""


@dataclass(frozen=True, eq=False)
class Slopes:
    """Gradients of integrals, in the plane through the point and the edge."""

    along: Floats
    """Component along the edge, 1/mm."""
    off: Floats
    """Component away from the edge's line, over the distance from it, 1/mm²."""


class Integrals(Protocol):
    """A kernel integrated along the edge of each pair."""

    def values(self) -> Floats:
        """Return the integrals."""

    def slopes(self) -> Slopes:
        """Return their gradients."""


class Kernel(Protocol):
    """A kernel of some width, in radii."""

    @property
    def support(self) -> float:
        """Distance in radii from which on the kernel is 0."""

    @property
    def exponent(self) -> float:
        """The power of the field of an endless edge that is linear in the squared distance."""

    def over(self, pairs: Pairs) -> Integrals:
        """Return the kernel integrated along the edge of each pair."""


@dataclass(frozen=True)
class CompactCubic:
    """h(|v|²) = (1 − |v|² / width²)³ where |v| < width, and 0 beyond.

    At x radii from an endless edge the field is ((width² − x²) / (width² − 1))^(7/2), from
    ∫ (c² − s²)³ ds = 32/35 c⁷ over |s| < c: hence the norm.
    """

    width: float

    @property
    def support(self) -> float:
        """Distance in radii from which on the kernel is 0."""
        return self.width

    @property
    def exponent(self) -> float:
        """The power of the field of an endless edge that is linear in the squared distance."""
        return 2 / 7

    @cached_property
    def norm(self) -> float:
        """The integral at distance 1 from an endless edge of radius 1."""
        return float(32 / 35 * (self.width**2 - 1) ** 3.5 / self.width**6)

    def over(self, pairs: Pairs) -> Integrals:
        """Return the kernel integrated along the edge of each pair."""
        return _CubicIntegrals(self, pairs)


class _CubicIntegrals:
    """Integrals of the compact kernel.

    Let 1/r, not s, change evenly with the parameter y from 0 to 1 along the edge. Then v moves
    straight from v₀ to v₁, the support is a ball, and with r₀, r₁ the radii and ℓ the length

        ds / r = ℓ dy / q,  q(y) = r₁ + y (r₀ − r₁),  1 / r = q / (r₀ r₁).

    On the part inside the ball let y = middle + half z, −1 ≤ z ≤ 1. There 1 − |v|² / width² is a
    quadratic g(z) and q is proportional to 1 − e z with |e| < 1: the value is an integral of
    g³ / (1 − e z), which is a sum of moments, and the gradient one of the polynomial g² v.
    Nothing is divided by r₁ − r₀.
    """

    def __init__(self, kernel: CompactCubic, pairs: Pairs) -> None:
        square = kernel.width**2
        first, last = pairs.start_radius, pairs.end_radius
        off = np.sqrt(pairs.off)
        start, start_off = pairs.along / first, off / first  # v0
        span = (pairs.along - pairs.length) / last - start  # v1 − v0
        span_off = off / last - start_off
        span_square = span * span + span_off * span_off
        nearest = -_over(start * span + start_off * span_off, span_square)
        least = (start + nearest * span) ** 2 + (start_off + nearest * span_off) ** 2
        # On a line through the apex of its cone an edge may be seen at one place: v0 = v1.
        room = np.maximum(square - least, 0)
        reach = np.sqrt(np.divide(room, span_square, out=np.sign(room), where=span_square > 0))
        low = np.clip(nearest - reach, 0, 1)
        high = np.clip(nearest + reach, 0, 1)
        middle, self.half = (low + high) / 2, (high - low) / 2
        beyond = middle - nearest

        self.kernel, self.pairs = kernel, pairs
        # g(z) = g0 + g1 z + g2 z²
        self.g0 = 1 - (least + span_square * beyond * beyond) / square
        self.g1 = -2 / square * span_square * beyond * self.half
        self.g2 = -1 / square * span_square * self.half * self.half
        self.ends = last + low * (first - last), last + high * (first - last)
        self.q = (self.ends[0] + self.ends[1]) / 2
        self.tilt = self.half * (last - first) / self.q  # e
        self.along, self.span = start + middle * span, span

    def values(self) -> Floats:
        """Return the integrals."""
        a, b, c, e = self.g0, self.g1, self.g2, self.tilt
        moment = self._sixth_moment()
        total = c * c * c * moment
        moment = e * moment
        total += 3 * b * c * c * moment
        moment = e * moment + 2 / 5
        total += 3 * c * (a * c + b * b) * moment
        moment = e * moment
        total += b * (6 * a * c + b * b) * moment
        moment = e * moment + 2 / 3
        total += 3 * a * (a * c + b * b) * moment
        moment = e * moment
        total += 3 * a * a * b * moment
        moment = e * moment + 2
        total += a * a * a * moment
        total *= self.pairs.length * self.half / self.q / self.kernel.norm
        return np.maximum(total, 0)  # rounding

    def _sixth_moment(self) -> Floats:
        """Return ∫ z⁶ / (1 − e z) dz over −1 ≤ z ≤ 1.

        Moment j − 1 is e times moment j plus ∫ zʲ⁻¹ dz: the lower ones follow without loss.
        """
        square = self.tilt * self.tilt
        moment = np.full_like(square, 2 / (2 * SERIES_TERMS + 5))
        for term in range(SERIES_TERMS - 2, -1, -1):
            moment *= square
            moment += 2 / (2 * term + 7)
        steep = np.abs(self.tilt) > SERIES_LIMIT
        if steep.any():
            e, e2 = self.tilt[steep], square[steep]
            zeroth = np.log(self.ends[0][steep] / self.ends[1][steep]) / e
            moment[steep] = (zeroth - 2 - e2 * (2 / 3 + e2 * (2 / 5))) / e2**3
        return moment

    def slopes(self) -> Slopes:
        """Return their gradients."""
        a, b, c = self.g0, self.g1, self.g2
        even = 2 * (a * a + (b * b + 2 * a * c) / 3 + c * c / 5)  # ∫ g² dz
        odd = 4 * b * (a / 3 + c / 5)  # ∫ g² z dz
        pairs, kernel = self.pairs, self.kernel
        radii = pairs.start_radius * pairs.end_radius
        factor = -6 / (kernel.norm * kernel.width**2) * pairs.length * self.half / radii
        return Slopes(
            along=factor * (self.along * even + self.half * self.span * odd),
            off=factor * self.q / radii * (even - self.tilt * odd),
        )


@dataclass(frozen=True)
class Cauchy:
    """h(|v|²) = 1 / (1 + |v|² / width²)²: nowhere 0, a quarter at |v| = width.

    At x radii from an endless edge the field is ((width² + 1) / (width² + x²))^(3/2), from
    ∫ ds / (c² + s²)² = π / (2 c³): hence the norm.
    """

    width: float

    @property
    def support(self) -> float:
        """Distance in radii from which on the kernel is 0."""
        return float("inf")

    @property
    def exponent(self) -> float:
        """The power of the field of an endless edge that is linear in the squared distance."""
        return -2 / 3

    @cached_property
    def norm(self) -> float:
        """The integral at distance 1 from an endless edge of radius 1."""
        return float(np.pi / 2 * self.width**4 / (self.width**2 + 1) ** 1.5)

    def over(self, pairs: Pairs) -> Integrals:
        """Return the kernel integrated along the edge of each pair."""
        return _CauchyIntegrals(self, pairs)


class _CauchyIntegrals:
    """Integrals of the Cauchy kernel.

    With w the width and k the radius's slope, h / r = w⁴ r³ / Q² where Q = w² r² + |p − s|². From
    the place along the edge's line where it is least, Q = α z² + c with α = 1 + w² k², and
    r = r* + k z: rational integrals of degree 3 over Q², and of degree 4 over Q³ for the gradient.
    Since c ≥ α w² r*², no term is large where the sum is not. Nothing is divided by k.
    """

    def __init__(self, kernel: Cauchy, pairs: Pairs) -> None:
        self.kernel = kernel
        square = kernel.width**2
        slope = (pairs.end_radius - pairs.start_radius) / pairs.length
        alpha = 1 + square * slope * slope
        radius = (pairs.start_radius + slope * pairs.along) / alpha  # r*
        # Not 0 at the apex of the edge's cone, where r* is.
        floor = 1e-60 * pairs.length * pairs.length
        least = np.maximum(alpha * square * radius * radius + pairs.off, floor)  # c
        start = (square * slope * pairs.start_radius - pairs.along) / alpha
        end = start + pairs.length
        low, high = alpha * start * start + least, alpha * end * end + least
        root = np.sqrt(alpha * least)
        angle = np.arctan2(root * pairs.length, least + alpha * start * end) / root

        self.alpha, self.least = alpha, least
        self.start, self.end, self.low, self.high = start, end, low, high
        self.shift = square * slope * radius  # the foot of the point, from the least Q
        # Coefficients of r³ = (r* + k z)³; products, for a power takes ten times as long.
        self.cubic = (
            radius * radius * radius,
            3 * radius * radius * slope,
            3 * radius * slope * slope,
            slope * slope * slope,
        )
        across = end / high - start / low
        # ∫ zⁿ / Q² dz, n = 0, 1, 2
        self.squares = (
            (across + angle) / (2 * least),
            (1 / low - 1 / high) / (2 * alpha),
            (angle - across) / (2 * alpha),
        )

    def values(self) -> Floats:
        """Return the integrals."""
        third = np.log(self.high / self.low) + self.least * (1 / self.high - 1 / self.low)
        total = self._with_cubic((*self.squares, third / (2 * self.alpha * self.alpha)))
        total *= self.kernel.width**4 / self.kernel.norm
        return np.maximum(total, 0)  # rounding

    def slopes(self) -> Slopes:
        """Return their gradients."""
        quarter = 1 / (4 * self.alpha)
        low, high = 1 / (self.low * self.low), 1 / (self.high * self.high)
        # zⁿ / Q² between the edge's ends, n = 0 .. 3
        ends = [high - low]
        for _ in range(3):
            low, high = self.start * low, self.end * high
            ends.append(high - low)
        # ∫ zⁿ / Q³ dz, n = 0 .. 4, by parts
        moments = (
            (ends[1] + 3 * self.squares[0]) / (4 * self.least),
            -quarter * ends[0],
            quarter * (self.squares[0] - ends[1]),
            quarter * (2 * self.squares[1] - ends[2]),
            quarter * (3 * self.squares[2] - ends[3]),
        )
        factor = -4 * self.kernel.width**4 / self.kernel.norm
        off = factor * self._with_cubic(moments[:4])
        return Slopes(self.shift * off - factor * self._with_cubic(moments[1:]), off)

    def _with_cubic(self, moments: Sequence[Floats]) -> Floats:
        """Return the integral of r³ times that of which the first four moments are given."""
        total = self.cubic[0] * moments[0]
        for coefficient, moment in zip(self.cubic[1:], moments[1:], strict=True):
            total += coefficient * moment
        return total


def tip_reach(kernel: Kernel) -> float:
    """Return how far beyond its end the surface of an endless half of an edge goes, in radii."""
    inside, outside = -ENDLESS / 2, 1.0
    for _ in range(CUTS):
        places = np.linspace(inside, outside, PLACES)
        one = np.ones(PLACES)
        pairs = Pairs(ENDLESS + places, 0 * one, ENDLESS * one, one, one)
        first = max(int(np.argmax(kernel.over(pairs).values() < 1)), 1)
        inside, outside = places[first - 1], places[first]
    return float(outside)


def _over(numerator: Floats, denominator: Floats) -> Floats:
    """Return the quotients, and 0 where the denominator is 0."""
    return np.divide(numerator, denominator, out=np.zeros_like(numerator), where=denominator > 0)
