"""The curves in which the surfaces of a star meet, each over an angle in [0, 2π).

A pair of struts meets on generators of the one whose own ball is smaller: each leaves the other
strut once, where a quadratic equation in the height on the generator says. For equal struts this is
in the plane between them: of cylinders an ellipse. Struts leave the ball on circles; two that lie
on one line meet on a circle, their rim. Half a circle from pole to pole,
its seam, closes the ball's face.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cache

import numpy as np

from scaffold_cad.base.arrays import (
    Bools,
    Floats,
    Frames,
    Frozen,
    Ints,
    Points,
    UnitVectors,
    read_only,
)
from scaffold_cad.base.vectors import any_perpendicular, dot, length, normalize
from scaffold_cad.struts.sharp.stars import SAME, SharpStars

ONE_LINE = 1e-9
"""Angle below which two struts that leave a node oppositely are on one line, rad."""

NEVER = -1.0
"""What is returned for points that are not on the surface of the union, as they do not exist."""

POLES, MERIDIANS = 48, 24
"""Axes that are tried for a ball, and seams for each of them."""

LATITUDES = 96
"""Points of a seam at which it is looked for struts."""


class Kind(IntEnum):
    """Kinds of curves."""

    PAIR = 0
    RIM = 1
    BALL = 2
    SEAM = 3


@dataclass(frozen=True, eq=False)
class StarCurves(Frozen):
    """Curves of stars, node after node."""

    stars: SharpStars
    node: Ints
    """Node of each, shape (c,)."""
    kind: Ints
    """`Kind` of each, shape (c,)."""
    one: Ints
    """Strut on whose generators each is, shape (c,); for seams -1."""
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
    frames: Frames
    """Each ball's x, y and z, its axis, rows; its seam is the meridian opposite of x. 0 where no
    ball is seen, shape (M, 3, 3)."""

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
        on_ball = (kind == Kind.BALL) | (kind == Kind.SEAM)
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
        found = np.where(kind == Kind.SEAM, np.minimum(found, -np.cos(angle)), found)
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
    frames, seamed = _frames(stars, ~stars.mitred & ~rimmed.any(axis=1))
    none = np.full(len(seamed), -1)
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
        np.concatenate([nodes, seamed]),
        np.concatenate([kinds, np.full(len(seamed), Kind.SEAM)]),
        np.concatenate([pairs[:, 0], none]),
        np.concatenate([pairs[:, 1], none]),
        np.concatenate([height[:, None] * axis, np.zeros((len(seamed), 3))]),
        np.concatenate([stars.radii[own] + stars.slopes[own] * height, np.ones(len(seamed))]),
        np.concatenate([stars.x[own], frames[seamed, 0]]),
        np.concatenate([stars.y[own], -frames[seamed, 2]]),
        frames,
    )


def _frames(stars: SharpStars, shown: Bools) -> tuple[Frames, Ints]:
    """Return the frames of balls, (M, 3, 3), and those nodes on whose ball a seam is seen.

    The visible part of a ball that two struts touch lies within a lune: the seam is opposite, below
    these struts. All other balls have a seam that keeps clear of circles and corners.

    Parameters
    ----------
    shown : (M,) nodes of which a ball may be seen
    """
    found = np.zeros((len(stars), 3, 3))
    touching = stars.tangent.sum(axis=1)
    for node in np.flatnonzero(shown).tolist():
        axes = stars.directions[node]
        if touching[node] < 2:
            z, seam = _best_seam(axes, np.arccos(np.clip(stars.leave[node], -1.0, 1.0)))
        else:
            axes = axes[stars.tangent[node]]
            cosines = axes @ axes.T
            one, other = np.unravel_index(np.argmin(cosines), cosines.shape)
            z, seam = normalize(np.stack([axes[one] - axes[other], axes[one] + axes[other]]))
        found[node] = -seam, np.cross(z, -seam), z
    return found, np.flatnonzero(shown & (touching < 2))


def _best_seam(axes: UnitVectors, caps: Floats) -> tuple[UnitVectors, UnitVectors]:
    """Return the axis z of a ball and the middle of its seam, away from circles and their corners.

    Few visible pieces of a seam are better: one that ends in a pole never parts the ball's face.

    Parameters
    ----------
    axes, caps : (N, 3), (N,) the struts' directions, and the angles of their circles from these
    """
    poles, meridians = _seam_choices()  # (q, 3), (q, s, 3)
    across = np.arccos(np.clip(poles @ axes.T, -1.0, 1.0))  # (q, N)
    holds = (across < caps) | (np.pi - across < caps)
    margin = np.minimum(np.abs(across - caps), np.abs(np.pi - across - caps)).min(axis=1)[:, None]
    beside = np.cross(poles[:, None], meridians)  # (q, s, 3)
    touched = np.abs(np.abs(np.arcsin(np.clip(beside @ axes.T, -1.0, 1.0))) - caps)
    touched[(meridians @ axes.T < 0) | holds[:, None]] = np.pi
    margin = np.minimum(margin, touched.min(axis=2))
    corners = _corners(axes, caps)
    if len(corners):
        away = np.abs(np.arcsin(np.clip(beside @ corners.T, -1.0, 1.0)))
        margin = np.minimum(margin, np.where(meridians @ corners.T < 0, np.pi, away).min(axis=2))
    height = np.pi * ((np.arange(LATITUDES) + 0.5) / LATITUDES - 0.5)[:, None]
    low, along = (poles @ axes.T)[:, None, None], (meridians @ axes.T)[:, :, None]
    inside = np.sin(height) * low + np.cos(height) * along > np.cos(caps)  # (q, s, l, N)
    seen = np.asarray(~inside.any(axis=3))
    pieces = (seen[..., 1:] & ~seen[..., :-1]).sum(axis=2) + seen[..., 0]
    pole, meridian = divmod(int(np.argmax(margin / (1.0 + pieces))), MERIDIANS)
    return poles[pole], meridians[pole, meridian]


@cache
def _seam_choices() -> tuple[UnitVectors, Floats]:
    """Return axes (q, 3), evenly spread over a half sphere, and those across them (q, s, 3)."""
    turn = np.arange(POLES) + 0.5
    height, angle = 1.0 - turn / POLES, np.pi * (1.0 + np.sqrt(5.0)) * turn
    wide = np.sqrt(1.0 - height**2)
    poles = np.stack([wide * np.cos(angle), wide * np.sin(angle), height], axis=1)
    x = any_perpendicular(poles)[:, None]
    turned = 2 * np.pi / MERIDIANS * np.arange(MERIDIANS)[:, None]
    across = np.cos(turned) * x + np.sin(turned) * np.cross(poles[:, None], x)
    return read_only(poles), read_only(across)


def _corners(axes: UnitVectors, caps: Floats) -> UnitVectors:
    """Return where circles on a ball meet, (c, 3)."""
    one, other = np.triu_indices(len(axes), 1)
    cosine = dot(axes[one], axes[other])
    a, b = np.cos(caps[one]), np.cos(caps[other])
    square = np.maximum(1.0 - cosine**2, ONE_LINE**2)
    u, v = (a - b * cosine) / square, (b - a * cosine) / square
    middle = u[:, None] * axes[one] + v[:, None] * axes[other]
    room = (1.0 - dot(middle, middle)) / square
    meets = (room > 0) & (square > ONE_LINE)
    up = np.sqrt(room[meets])[:, None] * np.cross(axes[one], axes[other])[meets]
    return np.concatenate([middle[meets] + up, middle[meets] - up])
