"""Sections of cones, cylinders and balls in closed form.

The side of a cone is made of generators, a straight line for each angle θ around the axis. With θ
counted from where the side is highest, the ends of generators are at the heights c + r s cos θ,
s the sine of the axis' angle to the vertical: so a plane at height h meets the generators between
two angles, cos θ = (h − c) / (r s) at the one end and at the other, and all of them where that is
beyond ±1. The section is convex: the two arcs of these angles, mirror images, and chords in the
discs at the ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, Points
from scaffold_cad.base.ranges import ranges
from scaffold_cad.layers.loops import Loops

UPRIGHT = 1e-12
"""Sine of the angle between an axis and the vertical below which the axis is vertical."""

LEVEL = 1e-9
"""Rise of a cone's generators, in radii, below which they are horizontal."""

NARROW = 0.05
"""Angle (rad) between the first and the last generator below which points of a section are at even
steps along the axis."""

STEEP = 1e-3
"""Rise of an axis, mm per mm, from which polygons of its sections are made larger, see `swell`."""


def swell(steps: Floats) -> Floats:
    """Return how much larger than its circle a polygon of its area is, whose sides are `steps`.

    It is the radius compensation of layers.

    Parameters
    ----------
    steps : angles of the sides at the center, rad
    """
    larger: Floats = np.sqrt(steps / np.sin(steps))
    return larger


@dataclass(frozen=True, eq=False)
class Cones(Frozen):
    """Cones and cylinders between two flat discs across their axes."""

    starts: Points
    """Center of the first disc, shape (k, 3), mm."""
    ends: Points
    """Center of the second disc, shape (k, 3), mm."""
    radii: Floats
    """Radius of both discs, shape (k, 2), mm."""

    def __len__(self) -> int:
        return len(self.starts)

    def __getitem__(self, item: Ints) -> Cones:
        return Cones(self.starts[item], self.ends[item], self.radii[item])

    def extents(self) -> tuple[Floats, Floats]:
        """Return the lowest and the highest height of each, both (k,), mm."""
        low, high = self.boxes()
        return low[:, 2], high[:, 2]

    def boxes(self) -> tuple[Points, Points]:
        """Return the lowest and the highest corner of the box around each, both (k, 3), mm."""
        span = self.ends - self.starts
        square = span * span
        total = square.sum(axis=1, keepdims=True)
        wide = np.sqrt((np.roll(square, 1, axis=1) + np.roll(square, 2, axis=1)) / total)
        near, far = self.radii[:, :1] * wide, self.radii[:, 1:] * wide
        low = np.minimum(self.starts - near, self.ends - far)
        return low, np.maximum(self.starts + near, self.ends + far)

    def loops(self, heights: Floats, sides: int) -> Loops:
        """Return the sections at ascending `heights` (h,), polygons of `sides` corners."""
        cone, level = crossed(*self.extents(), heights)
        points = _sections(self[cone], heights[level], sides)
        return Loops(points.reshape(-1, 2), sides * np.arange(len(cone) + 1), level)


@dataclass(frozen=True, eq=False)
class Balls(Frozen):
    """Balls."""

    centers: Points
    """Shape (k, 3), mm."""
    radii: Floats
    """Shape (k,), mm."""

    def __len__(self) -> int:
        return len(self.centers)

    def __getitem__(self, item: Ints) -> Balls:
        return Balls(self.centers[item], self.radii[item])

    def extents(self) -> tuple[Floats, Floats]:
        """Return the lowest and the highest height of each, both (k,), mm."""
        return self.centers[:, 2] - self.radii, self.centers[:, 2] + self.radii

    def boxes(self) -> tuple[Points, Points]:
        """Return the lowest and the highest corner of the box around each, both (k, 3), mm."""
        return self.centers - self.radii[:, None], self.centers + self.radii[:, None]

    def loops(self, heights: Floats, sides: int) -> Loops:
        """Return the sections at ascending `heights` (h,), polygons of `sides` corners."""
        ball, level = crossed(*self.extents(), heights)
        up = heights[level] - self.centers[ball, 2]
        radius = np.sqrt(np.maximum(self.radii[ball] ** 2 - up**2, 0.0))
        angle = 2 * np.pi / sides * (np.arange(sides) + 0.5)
        radius = radius * swell(np.array(2 * np.pi / sides))
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        points = self.centers[ball, None, :2] + radius[:, None, None] * circle
        return Loops(points.reshape(-1, 2), sides * np.arange(len(ball) + 1), level)


def crossed(low: Floats, high: Floats, heights: Floats) -> tuple[Ints, Ints]:
    """Return pairs of a thing (k,) and a height (h,) above its low end and up to its high one.

    Pairs are in order of heights and, at one, of things.
    """
    first = np.searchsorted(heights, low, side="right")
    count = np.searchsorted(heights, high, side="right") - first
    thing = np.repeat(np.arange(len(low)), count)
    level = ranges(first, count)
    order = np.argsort(level, kind="stable")
    return thing[order], level[order]


def _sections(cones: Cones, heights: Floats, sides: int) -> Floats:
    """Return the section of each cone at a height of its own (q,), counter-clockwise.

    Returns
    -------
    (q, sides, 2) float64, mm
    """
    span = cones.ends - cones.starts
    size = np.sqrt((span * span).sum(axis=1))
    wide = np.hypot(span[:, 0], span[:, 1]) / size  # s, (q,)
    upright = wide < UPRIGHT
    rise = span[:, 2] / size
    # Across the axis: toward where the side is highest, and level; only x and y of both.
    level = np.where(upright[:, None], [0.0, 1.0], span[:, [1, 0]] * [1.0, -1.0])
    level = level / np.hypot(level[:, 0], level[:, 1])[:, None]
    toward = np.where(upright, 1.0, -rise)[:, None] * np.stack([-level[:, 1], level[:, 0]], axis=1)
    arcs = _arcs(cones, heights, wide, upright)
    cosine, sine, along, growth = _along(cones, heights, wide, rise, arcs, sides // 2)
    radius = growth * (cones.radii[:, :1] + along * np.diff(cones.radii, axis=1))  # (q, m)
    center = cones.starts[:, None, :2] + along[..., None] * span[:, None, :2]
    middle = _middles(cones, heights, span)
    center = middle + growth[..., None] * (center - middle)
    high = center + (radius * cosine)[..., None] * toward[:, None]
    beside = (radius * sine)[..., None] * level[:, None]
    points = np.concatenate([(high - beside)[:, ::-1], high + beside], axis=1)
    x, y = points[..., 0], points[..., 1]
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    turned: Floats = np.where(area[:, None, None] < 0, points[:, ::-1], points)
    return turned


@dataclass(frozen=True, eq=False)
class _Arcs:
    """Angles between which planes meet the sides of cones, on both sides alike."""

    first: Floats
    """Shape (q,), in [0, π]."""
    last: Floats
    """Shape (q,), in [0, π], not less."""
    starts_at_disc: Bools
    """Whether a chord in an end disc begins at the first angle, shape (q,)."""
    ends_at_disc: Bools
    """Whether a chord in an end disc begins at the last angle, shape (q,)."""
    disc: Ints
    """The disc, 0 or 1, whose rim the side is cut at first, shape (q,)."""


def _arcs(cones: Cones, heights: Floats, wide: Floats, upright: Bools) -> _Arcs:
    middles = np.stack([cones.starts[:, 2], cones.ends[:, 2]], axis=1)  # (q, 2)
    reach = cones.radii * np.where(upright, 1.0, wide)[:, None]
    # Generators that rise by next to nothing are horizontal: between both ends no angle is left.
    rises = np.abs(np.diff(middles, axis=1)) + np.abs(np.diff(reach, axis=1))
    flat = rises < LEVEL * reach.max(axis=1, keepdims=True)
    middles = np.where(flat, middles.mean(axis=1, keepdims=True), middles)
    cosines = (heights[:, None] - middles) / reach
    cosines = np.where(upright[:, None], [2.0, -2.0], cosines)
    disc = (cosines[:, 1] > cosines[:, 0]).astype(np.intp)
    high, low = cosines.max(axis=1), cosines.min(axis=1)
    first = np.arccos(np.clip(high, -1.0, 1.0))
    last = np.maximum(np.arccos(np.clip(low, -1.0, 1.0)), first)
    return _Arcs(first, last, high < 1, low > -1, disc)


def _along(
    cones: Cones, heights: Floats, wide: Floats, rise: Floats, arcs: _Arcs, count: int
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the points of one arc of each section.

    Returns
    -------
    Four (q, count): cosine and sine of their angles, where they are from the first disc to the
    second, 0 to 1, and by how much they are moved away from the middle of the section.
    """
    begin = np.where(arcs.starts_at_disc, 0.0, 0.5)
    steps = count - 1 + begin + np.where(arcs.ends_at_disc, 0.0, 0.5)
    share = (np.arange(count) + begin[:, None]) / steps[:, None]  # (q, count)
    width = arcs.last - arcs.first
    angle = arcs.first[:, None] + share * width[:, None]
    cosine, sine = np.cos(angle), np.sin(angle)
    low, high = (
        center[:, 2, None] + radius[:, None] * wide[:, None] * cosine
        for center, radius in zip(
            (cones.starts, cones.ends), (cones.radii[:, 0], cones.radii[:, 1]), strict=True
        )
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (heights[:, None] - low) / (high - low)
    along = np.clip(np.where(np.isfinite(along), along, 0.5), 0.0, 1.0)
    even = arcs.starts_at_disc & arcs.ends_at_disc & (width < NARROW)
    if even.any():
        along[even] = np.where(arcs.disc[even, None] == 0, share[even], 1 - share[even])
        middle = cones.starts[even, 2, None] * (1 - along[even])
        middle = middle + cones.ends[even, 2, None] * along[even]
        radii = cones.radii[even]
        radius = radii[:, :1] * (1 - along[even]) + radii[:, 1:] * along[even]
        found = (heights[even, None] - middle) / (radius * wide[even, None])
        cosine[even] = np.clip(found, -1.0, 1.0)
        sine[even] = np.sqrt(1 - cosine[even] ** 2)
    growth = np.ones_like(cosine)
    steep = np.abs(rise) > STEEP
    growth[steep] = swell(np.maximum(width / steps, 1e-6))[steep, None]
    growth[arcs.starts_at_disc, 0] = 1.0
    growth[arcs.ends_at_disc, -1] = 1.0
    return cosine, sine, along, growth


def _middles(cones: Cones, heights: Floats, span: Floats) -> Floats:
    """Return where planes meet the axes of cones, (q, 1, 2); of level axes the start."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (heights - cones.starts[:, 2]) / span[:, 2]
    share = np.where(np.abs(share) < 1 / STEEP**2, share, 0.0)
    middles: Floats = (cones.starts[:, :2] + share[:, None] * span[:, :2])[:, None]
    return middles
