"""The curves in which the surfaces of a star meet, each over an angle in [0, 2π).

A pair of struts meets on generators of the one whose own ball is smaller: each leaves the other
strut once, where a quadratic equation in the height on the generator says. For equal struts this is
in the plane between them: of cylinders an ellipse. Struts leave the ball on circles; two that lie
on one line meet on a circle, their rim. Circles cut the ball where its face had holes.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, dot, length
from scaffold_cad.struts.sharp.stars import SAME, SharpStars

ONE_LINE = 1e-9
"""Angle below which two struts that leave a node oppositely are on one line, rad."""

NEVER = -1.0
"""What is returned for points that are not on the surface of the union, as they do not exist."""

CUT_CHOICES = 48
"""Axes that are tried for the cuts of a ball."""


class Kind(IntEnum):
    """Kinds of curves."""

    PAIR = 0
    RIM = 1
    BALL = 2
    CUT = 3


@dataclass(frozen=True, eq=False)
class StarCurves(Frozen):
    """Curves of stars, node after node."""

    stars: SharpStars
    node: Ints
    """Node of each, shape (c,)."""
    kind: Ints
    """`Kind` of each, shape (c,)."""
    one: Ints
    """Strut on whose generators each is, shape (c,); for cuts -1."""
    other: Ints
    """The other strut of pairs and rims, else -1, shape (c,)."""
    center: Points
    """Of circles, shape (c, 3)."""
    radius: Floats
    """Of circles, shape (c,)."""
    x: UnitVectors
    """Where circles begin, shape (c, 3)."""
    y: UnitVectors
    """A quarter turn on, shape (c, 3)."""
    planes: UnitVectors
    """Normals of the planes that cut each node's ball, 0 where none does, shape (M, 2, 3)."""

    @property
    def is_plane(self) -> Bools:
        """Whether the two struts of each curve are equal, so that they meet in a plane, (c,)."""
        stars, pair = self.stars, self.kind == Kind.PAIR
        one, other = ((self.node, each) for each in (self.one, self.other))
        same = np.abs(stars.radii[one] - stars.radii[other]) < SAME
        return np.asarray(pair & same & (np.abs(stars.slopes[one] - stars.slopes[other]) < SAME))

    def points(self, curve: Ints, angle: Floats) -> tuple[Points, Bools]:
        """Return points (q, 3) of curves (q,) at angles (q,), and whether they exist, (q,)."""
        turned = np.cos(angle)[:, None] * self.x[curve] + np.sin(angle)[:, None] * self.y[curve]
        found = self.center[curve] + self.radius[curve, None] * turned
        exists = np.ones(len(curve), dtype=np.bool_)
        pair = np.flatnonzero(self.kind[curve] == Kind.PAIR)
        if len(pair):
            found[pair], exists[pair] = self._on_pairs(curve[pair], turned[pair])
        return found, exists

    def _on_pairs(self, curve: Ints, spoke: UnitVectors) -> tuple[Points, Bools]:
        stars, node = self.stars, self.node[curve]
        one, other = (node, self.one[curve]), (node, self.other[curve])
        axis = stars.directions[one]
        r, s, q, u = stars.radii[one], stars.slopes[one], stars.radii[other], stars.slopes[other]
        a, c = dot(spoke, stars.directions[other]), dot(axis, stars.directions[other])
        ahead, grow = c + s * a, 1.0 + u**2
        with np.errstate(divide="ignore", invalid="ignore"):
            flat = r * a / (1.0 - ahead)
            # Of the height t on the generator: A t² + 2 B t + C = 0.
            square = 1.0 + s**2 - grow * ahead**2
            linear = r * s - grow * ahead * r * a - q * u * ahead
            constant = r**2 - grow * (r * a) ** 2 - 2.0 * q * u * r * a - q**2
            root = linear**2 - square * constant
            steep = (np.sqrt(np.maximum(root, 0.0)) - linear) / square
        equal = self.is_plane[curve]
        height = np.where(equal, flat, steep)
        exists = np.where(equal, ahead < 1.0, (root > 0) & (square > 0))
        height = np.where(exists, height, 0.0)
        points = (r + s * height)[:, None] * spoke + height[:, None] * axis
        return points, np.asarray(exists)

    def seen(self, curve: Ints, angle: Floats) -> Floats:
        """Return what is > 0 where points of curves are on the surface of the union, (q,)."""
        stars, node, kind = self.stars, self.node[curve], self.kind[curve]
        points, exists = self.points(curve, angle)
        along = stars.along(node, points)  # (q, N)
        on_ball = (kind == Kind.BALL) | (kind == Kind.CUT)
        on_ball |= (kind == Kind.RIM) & stars.tangent[node, self.one[curve]]
        others = np.where(
            on_ball[:, None], stars.leave[node] - along, stars.beyond(node, points, along)
        )
        row = np.arange(len(curve))
        own = np.stack([self.one[curve], self.other[curve]], axis=1)
        cornered = stars.cornered[node]
        in_corner = cornered[row[:, None], own] & (own >= 0)  # (q, 2)
        # On a strut that ends in planes these are its bounds.
        corner = np.where(in_corner[:, 1], own[:, 1], own[:, 0])
        bounded = np.asarray(in_corner.any(axis=1))[:, None] & cornered
        others = np.where(bounded, along[row, corner][:, None] - along, others)
        for strut in own.T:
            there = strut >= 0
            others[row[there], strut[there]] = np.inf
        found = others.min(axis=1)
        ahead = np.where(in_corner, np.inf, (along - stars.low[node])[row[:, None], own])
        touches = stars.tangent[node[:, None], own].any(axis=1) | stars.mitred[node]
        free = np.where(touches, np.inf, np.linalg.norm(points, axis=1) - 1.0)
        pair = kind == Kind.PAIR
        found = np.where(pair, np.minimum(found, np.minimum(ahead.min(axis=1), free)), found)
        half = (kind == Kind.CUT) & self.planes[node, 1].any(axis=1)  # four meet in one axis
        found = np.where(half, np.minimum(found, np.sin(angle)), found)
        return np.where(exists, np.minimum(found, 1.0), NEVER)


def curves_of(stars: SharpStars) -> StarCurves:
    """Return all curves of stars."""
    count, valency = stars.radii.shape
    one, other = np.triu_indices(valency, 1)
    node = np.repeat(np.arange(count), len(one))
    pair = np.stack([np.tile(one, count), np.tile(other, count)], axis=1)  # (p, 2)
    balls = stars.own_balls[node[:, None], pair]
    swap = balls[:, 1] < balls[:, 0] - SAME
    pair[swap] = pair[swap, ::-1]
    both = stars.directions[node, pair[:, 0]] + stars.directions[node, pair[:, 1]]
    opposite = length(both) < ONE_LINE
    radii, low = stars.radii[node[:, None], pair], stars.low[node[:, None], pair]
    rim = opposite & (np.abs(radii[:, 0] - radii[:, 1]) < SAME)
    through = np.abs(low.sum(axis=1)) < SAME
    rim &= through | (low <= 0).all(axis=1)
    rim &= stars.tangent[node, pair[:, 0]] | (radii[:, 0] >= 1.0)  # not in a larger ball
    rimmed = np.zeros((count, valency), dtype=np.bool_)
    rimmed[node[rim][:, None], pair[rim]] = True
    lone = np.argwhere(~rimmed & ~stars.mitred[:, None])
    planes, cuts = _cuts(stars, rimmed)
    parts = [
        (Kind.PAIR, node[~opposite], pair[~opposite]),
        (Kind.RIM, node[rim], pair[rim]),
        (Kind.BALL, lone[:, 0], np.stack([lone[:, 1], np.full(len(lone), -1)], axis=1)),
    ]
    kinds = np.concatenate([np.full(len(part[1]), part[0]) for part in parts])
    nodes = np.concatenate([part[1] for part in parts])
    pairs = np.concatenate([part[2] for part in parts])
    own = nodes, pairs[:, 0]
    height = np.where(kinds == Kind.BALL, stars.leave[own], 0.0)
    is_rim = kinds == Kind.RIM
    height[is_rim] = np.where(through[rim], low[rim, 0], 0.0)
    axis = stars.directions[own]
    return StarCurves(
        stars,
        np.concatenate([nodes, cuts[0]]),
        np.concatenate([kinds, np.full(len(cuts[0]), Kind.CUT)]),
        np.concatenate([pairs[:, 0], np.full(len(cuts[0]), -1)]),
        np.concatenate([pairs[:, 1], np.full(len(cuts[0]), -1)]),
        np.concatenate([height[:, None] * axis, np.zeros((len(cuts[0]), 3))]),
        np.concatenate([stars.radii[own] + stars.slopes[own] * height, np.ones(len(cuts[0]))]),
        np.concatenate([stars.x[own], cuts[1]]),
        np.concatenate([stars.y[own], cuts[2]]),
        planes,
    )


def _cuts(
    stars: SharpStars, rimmed: Bools
) -> tuple[UnitVectors, tuple[Ints, UnitVectors, UnitVectors]]:
    """Return the planes that cut balls, (M, 2, 3), and their circles: node, x and y of each.

    The visible part of a ball that two struts touch lies within a lune. That of others is cut: in
    two where one strut touches it, else in four, by half circles from where both planes meet.
    """
    planes = np.zeros((len(stars), 2, 3))
    nodes: list[int] = []
    x: list[UnitVectors] = []
    y: list[UnitVectors] = []
    touching = stars.tangent.sum(axis=1)
    for node in np.flatnonzero((touching < 2) & ~stars.mitred & ~rimmed.any(axis=1)).tolist():
        normals = _cut_planes(stars, node, touching[node] == 1)
        planes[node, : len(normals)] = normals
        axis, across = np.cross(normals[0], normals[-1]), normals[0]
        if touching[node]:
            behind = -stars.directions[node, np.argmax(stars.tangent[node])]
            axis, ways = np.cross(behind, across), [behind]
        else:
            ways = [normals[0], normals[1], -normals[0], -normals[1]]
        nodes += [node] * len(ways)
        x += [axis] * len(ways)
        y += ways
    shape = (len(nodes), 3)
    made = np.array(nodes, dtype=np.intp), np.array(x).reshape(shape), np.array(y).reshape(shape)
    return planes, made


def _cut_planes(stars: SharpStars, node: int, touches: bool) -> UnitVectors:
    """Return the normals of the planes that are furthest from all that they might touch, (p, 3)."""
    axes, caps = stars.directions[node], np.arccos(np.clip(stars.leave[node], -1.0, 1.0))
    if touches:
        main = np.argmax(stars.tangent[node])
        behind = axes[main]
        axes, caps = np.delete(axes, main, 0), np.delete(caps, main)
        start = any_perpendicular(behind[None])[0]
        choices = _turned(behind, start, CUT_CHOICES)[:, None]  # (q, 1, 3)
        poles = np.cross(behind, choices[:, 0])
    else:
        turns = [np.linalg.qr(np.random.default_rng(k).normal(size=(3, 3)))[0] for k in range(48)]
        choices = np.array(turns)[:, :2]
        poles = np.array(turns)[:, 2]
    across = np.abs(np.arcsin(np.clip(choices @ axes.T, -1.0, 1.0)))  # (q, p, n)
    margin = np.abs(across - caps).min(axis=(1, 2))
    for way in (1.0, -1.0):
        from_pole = np.arccos(np.clip(way * poles @ axes.T, -1.0, 1.0))
        margin = np.minimum(margin, np.abs(from_pole - caps).min(axis=1))
    return np.asarray(choices[np.argmax(margin)])


def _turned(axis: UnitVectors, start: UnitVectors, count: int) -> UnitVectors:
    """Return directions across an axis, half a turn of them, (count, 3)."""
    angle = np.pi * np.arange(count)[:, None] / count
    turned: UnitVectors = np.cos(angle) * start + np.sin(angle) * np.cross(axis, start)
    return turned
