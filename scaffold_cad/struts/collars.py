"""Collars: where a strut leaves its node, on an exact circle across its axis.

The collar of a strut stands as near to the node as it can while the fillets end before it: there,
and from there on, the filleted union is the strut itself. A fillet with another strut ends where a
ball of radius ρ that touches both surfaces touches this one: at a distance d from the other of
ρ (1 − cos φ), where φ is the angle between their normals, at most π/2. It is looked for all around
the circle, on one side of the plane of both axes, as the other is its mirror image.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.struts.distances import Union

LEAST_BLEND = 0.1
"""Least ρ over the mean radius of the node's struts: where that has no room, nothing has."""
HALVINGS = 30
"""Halvings of the range that a collar, or the largest ρ with room, is searched in."""
AROUND = 9
"""Points on half a circle at which a collar is looked at."""
EXACT = 1e-9
"""How far a fillet may be past a collar, in radii: rounding."""
BLOCK = 1 << 14
"""Points on circles looked at together: their arrays stay in the processor's cache."""
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
        for _ in range(HALVINGS):
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
    nearest = np.zeros_like(union.radii)
    strut, other = np.nonzero(~np.eye(count, dtype=np.bool_))
    room = max(1, BLOCK // (AROUND * max(len(strut), 1)))
    for at in range(0, len(nearest) if count > 1 else 0, room):
        some = slice(at, at + room)
        clear = _clear(union[some], blends[some, None], strut, other)
        nearest[some] = clear.reshape(-1, count, count - 1).max(axis=2)
    # A ball of radius ρ that touches the node's ball and a cylinder touches them from outside.
    with_ball = np.where(union.balls > 0, union.balls + blends, 0.0)[:, None]
    return np.maximum(nearest, _outside(union.radii, union.slopes, with_ball))


def _clear(union: Union, blends: Floats, strut: Ints, other: Ints) -> Floats:
    """Return from where on circles of struts (p,) are clear of their fillets with others, (M, p).

    Parameters
    ----------
    blends : (M, 1) ρ, mm
    """
    axes = union.directions
    cosine = np.clip((axes[:, :, strut] * axes[:, :, other]).sum(axis=0), -1, 1)[..., None]
    sine = np.sqrt(1 - cosine**2)  # (M, p, 1)
    radius, slope = union.radii[:, strut, None], union.slopes[:, strut, None]
    own = union.cosines[:, strut, None]
    turn = union.cosines[:, other, None]
    lean = turn * union.slopes[:, other, None]
    inscribed = union.radii[:, other, None] * turn
    towards = np.cos(np.linspace(0.0, np.pi, AROUND))  # (AROUND,)

    def is_clear(distance: Floats) -> Bools:
        c = distance[..., None]
        wide = radius + slope * c
        t = c * cosine + wide * towards * sine
        size = np.sqrt(c * c + wide * wide)
        q = np.sqrt(np.maximum(size**2 - t * t, 1e-18 * size**2))
        beside = t * turn + q * lean > 0
        gap = np.where(beside, q * turn - t * lean, size) - inscribed
        by_point = np.where(beside, turn / q, 1 / size)
        by_axis = np.where(beside, -t * by_point - lean, 0.0)
        along_point = own * (wide - slope * c)
        along_axis = own * (towards * sine - slope * cosine)
        normals = by_point * along_point + by_axis * along_axis
        needed = blends[..., None] * (1 - np.maximum(normals, 0.0)) - EXACT * radius
        return np.asarray((gap >= needed).all(axis=-1))

    high = _surely_clear(union, blends, strut, other)
    low = np.zeros_like(high)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        clear = is_clear(middle)
        low, high = np.where(clear, low, middle), np.where(clear, middle, high)
    return high


def _surely_clear(union: Union, gap: Floats, strut: Ints, other: Ints) -> Floats:
    """Return where the circles of struts (p,) are at least `gap` (M, 1) from others, (M, p)."""
    clear = [_at_gap(union, gap, strut, other, side) for side in (1.0, -1.0)]
    return np.maximum(*clear)


def _at_gap(union: Union, blends: Floats, strut: Ints, other: Ints, side: float) -> Floats:
    """Return where circles' points towards other struts, or away, are at a gap of them, (M, p).

    On a circle the distance to another cone is a concave function of the height along that cone's
    axis, so it is least at the two points of the circle in the plane of both axes. In that plane
    the distances are those to a line and to a point, which have closed forms.
    """
    axes = union.directions
    cosine = np.clip((axes[:, :, strut] * axes[:, :, other]).sum(axis=0), -1, 1)
    sine = np.sqrt(1 - cosine**2)
    radius, slope = union.radii[:, strut], union.slopes[:, strut]
    turn = union.cosines[:, other]
    lean = turn * union.slopes[:, other]
    inscribed = union.radii[:, other] * turn
    # The point is (c, side (r + s c)); its height along the other axis and its distance from
    # that axis are linear in c.
    height, height_rate = side * radius * sine, cosine + side * slope * sine
    width, width_rate = -side * radius * cosine, sine - side * slope * cosine
    tau, tau_rate = height * turn + width * lean, height_rate * turn + width_rate * lean
    rate = width_rate * turn - height_rate * lean
    offset = width * turn - height * lean - inscribed
    never = NEVER * radius
    line = np.where(rate > 1e-9, (blends - offset) / np.maximum(rate, 1e-9), never)
    ball = _outside(radius, slope, inscribed + blends)
    is_ball = tau + tau_rate * ball <= 0
    return np.where(is_ball, ball, np.minimum(line, never))


def _outside(radii: Floats, slopes: Floats, size: Floats) -> Floats:
    """Return the c from which on the circle of radius r + s c is `size` from the node."""
    lead = 1 + slopes**2
    half = radii * slopes
    root = half**2 - lead * (radii**2 - size**2)
    far = (np.sqrt(np.maximum(root, 0)) - half) / lead
    return np.where(root > 0, np.maximum(far, 0.0), 0.0)
