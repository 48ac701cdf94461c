"""Collars: where a strut leaves its node, on an exact circle across its axis.

The collar of a strut stands as near to the node as it can while the fillets end before it: there,
and from there on, the filleted union is the strut itself. A fillet with another strut ends where a
ball of radius ρ that touches both surfaces touches this one: at a distance d from the other of
ρ (1 − cos φ), where φ is the angle between their normals, at most π/2. It is looked for all around
the circle, on one side of the plane of both axes, as the other is its mirror image.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.struts.blending.distances import Union

LEAST_BLEND = 0.1
"""Least ρ over the mean radius of the node's struts: where that has no room, nothing has."""
HALVINGS = 30
"""Halvings of the range that a collar, or the largest ρ with room, is searched in."""
POINT_BYTES = 256
"""What a point on a circle takes where it is looked at."""
AROUND = 9
"""Points on half a circle at which a collar is looked at."""
TOWARDS = np.cos(np.linspace(0.0, np.pi, AROUND))
"""Cosines of their angles from the other strut."""
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

    def __getitem__(self, rows: Ints) -> Collars:
        return Collars(*(getattr(self, field.name)[rows] for field in fields(self)))


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
        has_room[short] = have_room(part, least[short], most[short])
        blends[short] = largest_blends(part, least[short], most[short], HALVINGS)
        own = collar_distances(part, blends[short])
        nearest[short] = np.where(has_room[short, None], np.minimum(own, most[short]), own)
    return Collars(nearest, union.radii + union.slopes * nearest, blends, has_room)


def largest_blends(union: Union, least: Floats, most: Floats, halvings: int) -> Floats:
    """Return the largest ρ with collars within `most` (M, N), from `least` to that wanted, (M,).

    It is `least` where even that has no room.

    Parameters
    ----------
    halvings : how often the range is halved in which it is searched
    """
    low, high = least, union.blends
    for _ in range(halvings):
        middle = (low + high) / 2
        fits = have_room(union, middle, most)
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    return low


def have_room(union: Union, blends: Floats, most: Floats) -> Bools:
    """Return whether collars at `most` (M, N) are clear of fillets of `blends` (M,), (M,)."""
    room = np.asarray((most >= _beside_balls(union, blends)).all(axis=1))
    for part, strut, other in _pairs_of(union):
        pairs, own = _Pairs.of(union[part], strut, other), blends[part, None]
        far, place = _surely_clear(pairs, own), most[part][:, strut]
        clear = _is_clear(pairs.apart(), own[..., None], np.minimum(place, far))
        room[part] &= (clear | (place >= far)).all(axis=1)
    return room


def collar_distances(union: Union, blends: Floats) -> Floats:
    """Return the nearest collar of each strut for `blends` (M,), mm, shape (M, N).

    It is `NEVER` radii where two struts do not part.
    """
    count = union.radii.shape[1]
    nearest = np.zeros_like(union.radii)
    for part, *pairs in _pairs_of(union):
        clear = _clear(_Pairs.of(union[part], *pairs), blends[part, None])
        nearest[part] = clear.reshape(-1, count, count - 1).max(axis=2)
    return np.maximum(nearest, _beside_balls(union, blends))


def _beside_balls(union: Union, blends: Floats) -> Floats:
    """Return where the fillets of struts with the balls of their nodes end, mm, (M, N)."""
    # A ball of radius ρ that touches the node's ball and a cylinder touches them from outside.
    with_ball = np.where(union.balls > 0, union.balls + blends, 0.0)[:, None]
    return _outside(union.radii, union.slopes, with_ball)


def _pairs_of(union: Union) -> Iterator[tuple[slice, Ints, Ints]]:
    """Yield blocks of nodes, with each strut beside each other one of its node, (P,) and (P,)."""
    count = union.radii.shape[1]
    strut, other = np.nonzero(~np.eye(count, dtype=np.bool_))
    each = POINT_BYTES * AROUND * len(strut)  # of a node
    for part in blocks(len(union.radii) if count > 1 else 0, each, CACHE):
        yield part, strut, other


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

    def apart(self) -> _Pairs:
        """Return the pairs with an axis more, for the points on their circles."""
        return _Pairs(*(getattr(self, field.name)[..., None] for field in fields(self)))

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
    pairs, blends = pairs.apart(), blends[..., None]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        clear = _is_clear(pairs, blends, middle)
        low, high = np.where(clear, low, middle), np.where(clear, middle, high)
    return np.asarray(high)


def _is_clear(pairs: _Pairs, blends: Floats, distance: Floats) -> Bools:
    """Return whether circles at a `distance` (M, P) are clear of their fillets, (M, P).

    Fields of `pairs`, and `blends`, have an axis more.
    """
    c = distance[..., None]
    own = 1 / np.sqrt(1 + pairs.slope**2)
    wide = pairs.radius + pairs.slope * c
    t = c * pairs.cosine + wide * pairs.sine * TOWARDS  # (M, P, AROUND)
    square = c * c + wide * wide
    q = np.sqrt(np.maximum(square - t * t, 1e-18 * square))
    size = np.sqrt(square)
    beside = t * pairs.turn + q * pairs.lean > 0
    gap = np.where(beside, q * pairs.turn - t * pairs.lean, size) - pairs.inscribed
    by_point = np.where(beside, pairs.turn / q, 1 / size)
    by_axis = np.where(beside, -t * by_point - pairs.lean, 0.0)
    along_point = own * (wide - pairs.slope * c)
    along_axis = own * (pairs.sine * TOWARDS - pairs.slope * pairs.cosine)
    normals = np.maximum(by_point * along_point + by_axis * along_axis, 0.0)
    return np.asarray((gap >= blends * (1 - normals) - EXACT * pairs.radius).all(axis=-1))


def _surely_clear(pairs: _Pairs, gap: Floats) -> Floats:
    """Return where a strut's circle is at least `gap` (M, 1) from another strut, (M, P)."""
    return np.asarray(np.maximum(*(_at_gap(pairs, gap, side) for side in (1.0, -1.0))))


def _at_gap(pairs: _Pairs, blends: Floats, side: float) -> Floats:
    """Return where the circle's point toward the other strut, or away, is at a gap of it, (M, P).

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
