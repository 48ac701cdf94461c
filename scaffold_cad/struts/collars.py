"""Collars: where a strut leaves its node, on an exact circle across its axis.

The collar of a strut stands as near to the node as it can while the fillets end before it: there,
and from there on, the filleted union is the strut itself. A fillet with another strut ends where a
ball of radius ρ that touches both surfaces touches this one: at a distance d from the other of
ρ (1 − cos φ), where φ is the angle between their normals, at most π/2. It is looked for all around
the circle, on one side of the plane of both axes, as the other is its mirror image.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.struts.distances import Union

LEAST_BLEND = 0.1
"""Least ρ over the mean radius of the node's struts: where that has no room, nothing has."""
HALVINGS, SECANTS = 6, 10
"""Halvings of the range that a collar is searched in, and steps along secants after them."""
FITTINGS = 30
"""Halvings of the range that the largest ρ with room is searched in."""
BLOCK = 1 << 16
"""Points on circles looked at at once: their arrays stay in the processor's cache."""
AROUND = 9
"""Points on half a circle at which a collar is looked at."""
EXACT = 1e-9
"""How far a fillet may be past a collar, in radii: rounding."""
NEVER = 1e9
"""Collar distance over the radius that stands for struts that never part."""


@dataclass(frozen=True, eq=False)
class Collars(Frozen):
    """Where the N struts of each of M nodes begin."""

    distances: Floats
    """Distance of each collar from the node along its strut, mm, shape (M, N)."""
    radii: Floats
    """Radius of each collar, mm, shape (M, N)."""
    blends: Floats
    """ρ that has room, mm, shape (M,)."""
    has_room: Bools
    """Whether every collar is as near as asked for, shape (M,)."""


def collars(union: Union, most: Floats) -> Collars:
    """Return the nearest collars; where they lie beyond `most` (M, N), ρ shrinks.

    Where even a ρ of `LEAST_BLEND` mean radii has no room, that is the ρ, and `has_room` is false.
    """
    wanted = union.blends
    least = np.minimum(wanted, LEAST_BLEND * union.radii.mean(axis=1))
    nearest = collar_distances(union, wanted)
    blends = wanted.copy()
    short = np.flatnonzero((nearest > most).any(axis=1))
    has_room = np.ones(len(wanted), dtype=np.bool_)
    if len(short):
        part = Union(
            union.directions[:, short],
            union.radii[short],
            union.slopes[short],
            union.balls[short],
            wanted[short],
        )
        low, high = least[short], wanted[short]
        has_room[short] = (collar_distances(part, low) <= most[short]).all(axis=1)
        for _ in range(FITTINGS):
            middle = (low + high) / 2
            fits = (collar_distances(part, middle) <= most[short]).all(axis=1)
            low, high = np.where(fits, middle, low), np.where(fits, high, middle)
        blends[short] = low
        nearest[short] = collar_distances(part, low)
    return Collars(nearest, union.radii + union.slopes * nearest, blends, has_room)


def collar_distances(union: Union, blends: Floats) -> Floats:
    """Return the nearest collar of each strut for `blends` (M,), mm, shape (M, N).

    It is `NEVER` radii where two struts do not part.
    """
    count = union.radii.shape[1]
    pairs = np.nonzero(~np.eye(count, dtype=np.bool_))
    nearest = np.zeros_like(union.radii)
    room = max(1, BLOCK // (AROUND * count * count))
    for start in range(0, len(nearest) if count > 1 else 0, room):
        part = slice(start, start + room)
        clear = _clear(_Pairs.of(union[part], *pairs), blends[part, None])
        nearest[part] = clear.reshape(-1, count, count - 1).max(axis=2)
    # A ball of radius ρ that touches the node's ball and a cylinder touches them from outside.
    with_ball = np.where(union.balls > 0, union.balls + blends, 0.0)[:, None]
    return np.maximum(nearest, _outside(union.radii, union.slopes, with_ball))


@dataclass(frozen=True, eq=False)
class _Pairs(Frozen):
    """Struts, each beside another one of its node, all of shape (M, P)."""

    cosine: Floats
    """Cosine of the angle between both."""
    sine: Floats
    radius: Floats
    """Radius of the strut in the plane through the node, mm."""
    slope: Floats
    """Growth of the strut's radius."""
    turn: Floats
    """Cos α of the other strut."""
    lean: Floats
    """Sin α of the other strut."""
    inscribed: Floats
    """Radius of the ball at the end of the other strut, mm."""

    @staticmethod
    def of(union: Union, strut: Ints, other: Ints) -> _Pairs:
        axes, cosines = union.directions, union.cosines
        cosine = np.clip((axes[:, :, strut] * axes[:, :, other]).sum(axis=0), -1, 1)
        turn = cosines[:, other]
        return _Pairs(
            cosine,
            np.sqrt(1 - cosine**2),
            union.radii[:, strut],
            union.slopes[:, strut],
            turn,
            turn * union.slopes[:, other],
            union.radii[:, other] * turn,
        )


def _clear(pairs: _Pairs, blends: Floats) -> Floats:
    """Return from where on the circle of struts is clear of the fillet with another one, (M, P)."""
    low, high = np.zeros_like(pairs.radius), _surely_clear(pairs, blends)
    below, above = _margin(pairs, blends, low), np.maximum(_margin(pairs, blends, high), 0.0)
    for step in range(HALVINGS + SECANTS):
        middle = (low + high) / 2
        if step >= HALVINGS:
            share = np.clip(-below / np.maximum(above - below, 1e-300), 1e-3, 1 - 1e-3)
            middle = low + share * (high - low)
        margin = _margin(pairs, blends, middle)
        clear = margin >= 0
        # The value at an end that stays is halved, or the other one would hardly move.
        above, below = np.where(clear, margin, above / 2), np.where(clear, below / 2, margin)
        low, high = np.where(clear, low, middle), np.where(clear, middle, high)
    return np.asarray(high)


def _margin(pairs: _Pairs, blends: Floats, distance: Floats) -> Floats:
    """Return how far circles at a `distance` are from their fillets, at the least, mm, (M, P)."""
    towards = np.cos(np.linspace(0.0, np.pi, AROUND))
    each = _Pairs(*(getattr(pairs, field.name)[..., None] for field in fields(pairs)))
    c = distance[..., None]
    own = 1 / np.sqrt(1 + each.slope**2)
    wide = each.radius + each.slope * c
    t = c * each.cosine + wide * each.sine * towards  # (M, P, AROUND)
    square = c * c + wide * wide
    q = np.sqrt(np.maximum(square - t * t, 1e-18 * square))
    size = np.sqrt(square)
    beside = t * each.turn + q * each.lean > 0
    gap = np.where(beside, q * each.turn - t * each.lean, size) - each.inscribed
    by_point = np.where(beside, each.turn / q, 1 / size)
    by_axis = np.where(beside, -t * by_point - each.lean, 0.0)
    along_point = own * (wide - each.slope * c)
    along_axis = own * (each.sine * towards - each.slope * each.cosine)
    normals = np.maximum(by_point * along_point + by_axis * along_axis, 0.0)
    margin = (gap - blends[..., None] * (1 - normals)).min(axis=-1)
    return np.asarray(margin + EXACT * pairs.radius)


def _surely_clear(pairs: _Pairs, gap: Floats) -> Floats:
    """Return where a strut's circle is at least `gap` (M, 1) from another strut, (M, P)."""
    return np.asarray(np.maximum(*(_at_gap(pairs, gap, side) for side in (1.0, -1.0))))


def _at_gap(pairs: _Pairs, blends: Floats, side: float) -> Floats:
    """Return where the circle's point towards the other strut, or away, is at a gap of it, (M, P).

    On a circle the distance to another cone is a concave function of the height along that cone's
    axis, so it is least at the two points of the circle in the plane of both axes. In that plane
    the distances are those to a line and to a point, which have closed forms.
    """
    radius, slope = pairs.radius, pairs.slope
    # The point is (c, side (r + s c)); its height along the other axis and its distance from
    # that axis are linear in c.
    height, height_rate = side * radius * pairs.sine, pairs.cosine + side * slope * pairs.sine
    width, width_rate = -side * radius * pairs.cosine, pairs.sine - side * slope * pairs.cosine
    tau = height * pairs.turn + width * pairs.lean
    tau_rate = height_rate * pairs.turn + width_rate * pairs.lean
    rate = width_rate * pairs.turn - height_rate * pairs.lean
    offset = width * pairs.turn - height * pairs.lean - pairs.inscribed
    never = NEVER * radius
    line = np.where(rate > 1e-9, (blends - offset) / np.maximum(rate, 1e-9), never)
    ball = _outside(radius, slope, pairs.inscribed + blends)
    is_ball = tau + tau_rate * ball <= 0
    return np.where(is_ball, ball, np.minimum(line, never))


def _outside(radii: Floats, slopes: Floats, size: Floats) -> Floats:
    """Return the c from which on the circle of radius r + s c is `size` from the node."""
    lead = 1 + slopes**2
    half = radii * slopes
    root = half**2 - lead * (radii**2 - size**2)
    far = (np.sqrt(np.maximum(root, 0)) - half) / lead
    return np.where(root > 0, np.maximum(far, 0.0), 0.0)
