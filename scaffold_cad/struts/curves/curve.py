"""Curves: struts that run on smoothly through joints, from one straight strut to another.

At each joint stands a circle of the joint's radius in the plane that halves its angle. Between two
circles sections are affine images of a circle,

    S(e, v) = A(v) + B(v) e,    e on the unit circle,

with a center A and two half-diameters B that are cubic in v. Their derivatives at a joint are those
of a tube with the joint's curvature k and growth s of the radius r:

    A' = λ T,    (B e)' = λ (s e − r (k · e) T),

T across the circle's plane, the same on both sides of the joint but for λ, so that the surface has
one tangent plane there. For equal arcs of a circle it is a torus to a few parts in 10⁷.

With the quintics of `quarter` for e there are four patches of degree 5 around and 3 along between
circles, and four faces per curve, splines of two continuous derivatives less along: C1.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.frames import accumulate, double_reflection, turn
from scaffold_cad.base.ranges import steps
from scaffold_cad.base.topology import chains
from scaffold_cad.base.vectors import (
    angle_between,
    any_perpendicular,
    dot,
    length,
    normalize,
    rotate,
)
from scaffold_cad.struts.curves.joints import CurvedJoints
from scaffold_cad.struts.runs import Runs

ALONG = 3
"""Degree of pieces along the curve."""


NOT_OF_CIRCLES = ("offsets", "half_runs", "curved", "tori")
"""Fields that have no row for each circle."""


@dataclass(frozen=True, eq=False)
class Curves(Frozen):
    """Circles, curve after curve, and what lies between those that follow each other.

    A curve begins and ends on the circles of two straight struts; a closed one begins and ends at
    one joint, whose circle is there twice.
    """

    offsets: Ints
    """Curve c has the circles offsets[c] to offsets[c + 1], shape (c + 1,)."""
    half_runs: Ints
    """Half-runs on which each curve begins and ends, shape (c, 2); -1 for closed ones."""
    nodes: Ints
    """Joint of each circle, or -1 for the circles of straight struts, shape (s,)."""
    run: Ints
    """Run that lies between each circle and the next, -1 after the last one, shape (s,)."""
    centers: Points
    """Shape (s, 3), mm."""
    tangents: UnitVectors
    """Axes of the circles, the way the curve runs, shape (s, 3)."""
    x: UnitVectors
    """Where the circles begin, shape (s, 3)."""
    radii: Floats
    """Shape (s,), mm."""
    outline: Floats
    """Radii that the number of rings goes by, shape (s,), mm: inside of others theirs, so that the
    rings of both are at the same places."""
    slopes: Floats
    """Growth of the radius along the curve, shape (s,)."""
    bends: Floats
    """Curvature, toward the center of the bend, shape (s, 3), 1/mm."""
    twists: Floats
    """How fast circles turn about the curve, so that closed ones meet, shape (s,), rad/mm."""
    curved: Bools
    """Runs that are curved from end to end, shape (k,)."""
    tori: Floats
    """Centerline radius of curves that are parts of tori, nan for others, shape (c,), mm."""

    @staticmethod
    def none(runs: int) -> Curves:
        """Return curves for a number of runs none of which is curved."""
        empty, rows = np.empty(0), np.empty((0, 3))
        no_numbers = np.empty(0, dtype=np.intp)
        return Curves(
            np.zeros(1, dtype=np.intp),
            np.empty((0, 2), dtype=np.intp),
            *(no_numbers, no_numbers, rows, rows, rows, empty, empty, empty, rows, empty),
            np.zeros(runs, dtype=np.bool_),
            empty,
        )

    @staticmethod
    def joined(first: Curves, second: Curves) -> Curves:
        """Return the curves of one after those of the other; they are of the same runs."""
        both = {
            each.name: np.concatenate([getattr(first, each.name), getattr(second, each.name)])
            for each in fields(first)
        }
        offsets = np.concatenate([first.offsets, first.offsets[-1] + second.offsets[1:]])
        both |= {"offsets": offsets, "curved": first.curved | second.curved}
        return Curves(**both)

    def chosen(self, keep: Bools) -> Curves:
        """Return some of the curves, for `keep` (c,)."""
        counts = np.diff(self.offsets)
        rows = np.repeat(keep, counts)
        own = [each.name for each in fields(self) if each.name not in NOT_OF_CIRCLES]
        per_circle = {name: getattr(self, name)[rows] for name in own}
        offsets = np.concatenate([[0], np.cumsum(counts[keep])])
        half_runs, tori = self.half_runs[keep], self.tori[keep]
        return replace(self, offsets=offsets, half_runs=half_runs, tori=tori, **per_circle)

    @cached_property
    def closed(self) -> Bools:
        """Whether each curve is closed, shape (c,)."""
        return self.half_runs[:, 0] < 0

    @cached_property
    def pieces(self) -> Ints:
        """First circle of each piece, shape (p,): all but the last ones of curves."""
        last = np.zeros(len(self.nodes), dtype=np.bool_)
        last[self.offsets[1:] - 1] = True
        return np.flatnonzero(~last)

    @cached_property
    def curve_of_piece(self) -> Ints:
        """Curve that each piece belongs to, shape (p,)."""
        return np.repeat(np.arange(len(self.half_runs)), np.diff(self.offsets) - 1)

    @cached_property
    def speeds(self) -> Floats:
        """Length λ of the derivative by v at both ends of each piece, shape (p,), mm."""
        first = self.pieces
        chord = self.centers[first + 1] - self.centers[first]
        size = length(chord)
        cosines = dot(self.tangents[first] + self.tangents[first + 1], chord) / size
        # That of the cubic nearest to an arc.
        speeds: Floats = 2 * size / (1 + cosines / 2)
        return speeds

    @cached_property
    def turns(self) -> Floats:
        """By how much each piece and its outline turn, back and forth added up, (p,), rad."""
        first, last = self.pieces, self.pieces + 1
        chord = self.centers[last] - self.centers[first]
        size = length(chord)
        way, growth = chord / size[:, None], (self.outline[last] - self.outline[first]) / size
        found = np.zeros(len(first))
        for at in (first, last):
            found += angle_between(self.tangents[at], way)
            found += np.abs(np.arctan(self.slopes[at]) - np.arctan(growth))
        return found

    @cached_property
    def frames(self) -> Floats:
        """Control points of A, and of B's two columns, of each piece, shape (p, 4, 3, 3), mm."""
        first = self.pieces
        rows = np.empty((len(first), ALONG + 1, 3, 3))
        step = self.speeds[:, None, None] / ALONG
        values, slopes = self._values, self._slopes
        rows[:, 0], rows[:, 3] = values[first], values[first + 1]
        rows[:, 1] = values[first] + step * slopes[first]
        rows[:, 2] = values[first + 1] - step * slopes[first + 1]
        return rows

    @property
    def y(self) -> UnitVectors:
        """Where the circles have made a quarter, shape (s, 3)."""
        return np.cross(self.tangents, self.x)

    @property
    def _values(self) -> Floats:
        """A and B's columns at each circle, shape (s, 3, 3)."""
        spokes = self.radii[:, None, None] * np.stack([self.x, self.y], axis=1)
        return np.concatenate([self.centers[:, None], spokes], axis=1)

    @property
    def _slopes(self) -> Floats:
        """Their derivatives along the curve, shape (s, 3, 3)."""
        axes = np.stack([self.x, self.y], axis=1)  # (s, 2, 3)
        turned = np.stack([self.y, -self.x], axis=1)
        radius, ahead = self.radii[:, None, None], self.tangents[:, None]
        bend = np.einsum("six,sx->si", axes, self.bends)[..., None]
        grown = self.slopes[:, None, None] * axes - radius * bend * ahead
        return np.concatenate([ahead, grown + radius * self.twists[:, None, None] * turned], axis=1)


def curves(runs: Runs, joints: CurvedJoints, collar: Floats, x: Floats) -> Curves:
    """Return the curves through joints.

    Parameters
    ----------
    collar : (2 k,) distance from its node at which each half-run's straight part begins, mm
    x : (2 k, 3) where the circles of half-runs at blended nodes begin; 0 at other nodes
    """
    if not joints.at.any():
        return Curves.none(len(runs.edges))
    links = _links(runs, joints)
    found = chains(links.edges, len(runs.nodes) + len(runs.tails))
    offsets = np.concatenate([[0], np.cumsum(np.diff(found.offsets) + 1)])
    first = np.delete(np.arange(offsets[-1]), offsets[1:] - 1)  # circle before each piece
    ends = links.edges.reshape(-1)
    node, run = np.empty(offsets[-1], dtype=np.intp), np.full(offsets[-1], -1, dtype=np.intp)
    node[first], node[first + 1] = ends[found.half_edges], ends[found.half_edges ^ 1]
    run[first] = links.run[found.half_edges >> 1]
    half_run = node - len(runs.nodes)
    straight, at_joint = np.flatnonzero(half_run >= 0), np.flatnonzero(half_run < 0)
    on, node[straight] = half_run[straight], -1
    half_run[at_joint] = -1
    centers, radii = np.empty((len(node), 3)), np.empty(len(node))
    centers[straight] = runs.nodes[runs.tails[on]] + collar[on, None] * runs.directions[on]
    radii[straight] = runs.radii_at(on, collar[on])
    radius_of = np.empty(len(runs.nodes))
    radius_of[runs.tails] = runs.radii.reshape(-1)
    centers[at_joint], radii[at_joint] = runs.nodes[node[at_joint]], radius_of[node[at_joint]]
    both = half_run[np.stack([offsets[:-1], offsets[1:] - 1], axis=1)]
    sides = _Sides.of(offsets, found.closed, centers, radii, joints.curved[run])
    tangents = normalize(sides.before + sides.after)
    bends = 2 * (sides.after - sides.before) / (sides.length_before + sides.length_after)[:, None]
    made = Curves(
        offsets,
        both,
        node,
        run,
        centers,
        tangents,
        np.zeros_like(centers),
        radii,
        radii,
        sides.growth,
        bends,
        np.zeros(len(node)),
        joints.curved,
        np.full(len(both), np.nan),
    )
    return _turned(made, np.where(both[..., None] >= 0, x[both ^ 1], 0.0))


@dataclass(frozen=True, eq=False)
class _Links(Frozen):
    """The pieces of curves as edges between joints and the ends of straight struts."""

    edges: Edges
    """Joints by their number, ends by that of their half-run beyond all nodes, shape (p, 2)."""
    run: Ints
    """Run of each, shape (p,)."""


def _links(runs: Runs, joints: CurvedJoints) -> _Links:
    curved = np.flatnonzero(joints.curved)
    half = np.flatnonzero(joints.at[runs.tails] & ~np.repeat(joints.curved, 2))
    leaving = np.stack([runs.tails[half], len(runs.nodes) + half], axis=1)
    return _Links(
        np.concatenate([runs.edges[curved], leaving]), np.concatenate([curved, half >> 1])
    )


@dataclass(frozen=True, eq=False)
class _Sides(Frozen):
    """What is on both sides of circles; at the ends of curves the same on both."""

    before: UnitVectors
    """Direction from the circle before, shape (s, 3)."""
    after: UnitVectors
    """Direction to the circle after, shape (s, 3)."""
    length_before: Floats
    """Length over which the curve turns before, shape (s,), mm."""
    length_after: Floats
    """The same after, shape (s,), mm."""
    growth: Floats
    """Growth of the radius, shape (s,): between those on both sides, none at a thickest place."""

    @staticmethod
    def of(offsets: Ints, closed: Bools, centers: Points, radii: Floats, whole: Bools) -> _Sides:
        """Return the sides of circles.

        Parameters
        ----------
        offsets, closed : of curves
        whole : (s,) whether the piece after each circle lies between two joints
        """
        start, end = offsets[:-1], offsets[1:] - 1
        chords = np.roll(centers, -1, axis=0) - centers
        chords[end] = chords[end - 1]
        chords[end[closed]] = chords[start[closed]]
        span = length(chords)
        growth = (np.roll(radii, -1) - radii) / span
        # Beside a straight strut a piece turns there and back.
        turning = np.where(whole, span, span / 2)
        for values in (growth, turning):
            values[end] = values[end - 1]
            values[end[closed]] = values[start[closed]]
        after = chords / span[:, None]

        def shifted(values: Floats) -> Floats:
            earlier = np.roll(values, 1, axis=0)
            earlier[start] = values[start]
            earlier[start[closed]] = values[end[closed] - 1]
            return earlier

        length_before, growth_before = shifted(turning), shifted(growth)
        # The harmonic mean: radii between those of two circles stay between them.
        same = np.asarray(growth * growth_before > 0)
        weights = 2 * turning + length_before, turning + 2 * length_before
        below = np.where(same, weights[0] * growth + weights[1] * growth_before, 1.0)
        mean = (weights[0] + weights[1]) * growth * growth_before / below
        return _Sides(shifted(after), after, length_before, turning, np.where(same, mean, 0.0))


def _turned(made: Curves, x: Floats) -> Curves:
    """Return curves whose circles turn about them as little as they can.

    Parameters
    ----------
    x : (c, 2, 3) where the first and the last circle of each begin, 0 for anywhere; the first one
        counts if both do
    """
    first, start, end = made.pieces, made.offsets[:-1], made.offsets[1:] - 1
    from_end = ~x[:, 0].any(axis=1) & x[:, 1].any(axis=1)
    last, x = x[:, 1], x[:, 0]
    counts = np.diff(made.offsets) - 1
    tangents = made.tangents
    x = np.where(np.any(x, axis=1, keepdims=True), x, any_perpendicular(tangents[start]))
    chords = normalize(made.centers[first + 1] - made.centers[first])
    turns = double_reflection(chords, tangents[first], tangents[first + 1])
    position = steps(counts)
    turned = np.empty_like(tangents)
    turned[start] = x
    turned[first + 1] = turn(accumulate(turns, position), np.repeat(x, counts, axis=0))
    ahead = np.zeros(len(tangents))
    ahead[first + 1] = made.speeds
    along = np.cumsum(ahead) - np.repeat(np.cumsum(ahead)[start], counts + 1)  # (s,) mm
    wanted = np.where(made.closed[:, None], x, last)  # (c, 3)
    y = np.cross(tangents[end], turned[end])
    missing = np.arctan2(dot(wanted, y), dot(wanted, turned[end]))  # (c,)
    rate = np.repeat(np.where(made.closed, missing, 0.0) / along[end], counts + 1)
    whole = np.repeat(np.where(from_end, missing, 0.0), counts + 1)
    turned = rotate(turned, tangents, rate * along + whole)
    turned[end[made.closed]] = x[made.closed]
    return replace(made, x=turned, twists=rate)
