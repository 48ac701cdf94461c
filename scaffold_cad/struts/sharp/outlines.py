"""Outlines: the pieces of a star's curves that are on the surface of the union."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.struts.sharp.curves import Kind, StarCurves

SAMPLES = 256
"""Samples of a curve between which its pieces are looked for."""

SHIFT = 0.3819
"""Where between its steps a curve is sampled: ends of pieces often lie on even parts of a turn."""

HALVINGS = 52
"""Halvings of a step in which an end of a piece is found."""

CLOSE = 4.0
"""How fast what is seen changes along a curve at most, for the search between samples."""

THIRDS = 40
"""Steps in which an extremum between samples is found."""

LEAST = 1e-9
"""What an extremum is beyond 0 at least: in less, surfaces touch."""

TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Outlines(Frozen):
    """Pieces of curves, by curve and angle."""

    curve: Ints
    """Shape (e,)."""
    start: Floats
    """Angle in [0, 2π) at which each begins, shape (e,), rad."""
    end: Floats
    """Angle at which it ends, shape (e,), rad; a turn more than the start for whole curves."""

    def angles(self, count: int) -> Floats:
        """Return evenly spaced angles of each, (e, count)."""
        share = np.linspace(0.0, 1.0, count)
        return np.asarray(self.start[:, None] + (self.end - self.start)[:, None] * share)

    def chosen(self, rows: Ints) -> Outlines:
        """Return some of the pieces."""
        return Outlines(self.curve[rows], self.start[rows], self.end[rows])


def outlines_of(curves: StarCurves) -> Outlines:
    """Return the visible pieces of curves; those of balls end where seams meet them."""
    count = len(curves.node)
    step = TURN / SAMPLES
    at = np.asarray(step * (np.arange(SAMPLES) + SHIFT), dtype=np.float64)
    number = np.repeat(np.arange(count), SAMPLES)
    values = curves.seen(number, np.tile(at, count)).reshape(count, SAMPLES)
    curve, sample = np.nonzero((values > 0) != (np.roll(values, -1, axis=1) > 0))
    more, turning, place = _turned_back(curves, values, at)
    brackets = [
        (curve, at[sample], at[sample] + step, values[curve, sample] > 0),
        (more, at[turning] - step, place, values[more, turning] > 0),
        (more, place, at[turning] + step, values[more, turning] < 0),
    ]
    curve, low, high, first = (np.concatenate(each) for each in zip(*brackets, strict=True))
    order = np.lexsort((low, curve))
    curve, low, high, first = curve[order], low[order], high[order], first[order]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        same = (curves.seen(curve, middle) > 0) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    ends = _joined(curve, (low + high) / 2, ~first)
    ended = np.zeros(count, dtype=np.bool_)
    ended[curve] = True
    whole = np.flatnonzero((values > 0).all(axis=1) & ~ended)
    found = Outlines(
        np.concatenate([ends.curve, whole]),
        np.concatenate([ends.start, np.zeros(len(whole))]),
        np.concatenate([ends.end, np.full(len(whole), TURN)]),
    )
    return _halved(curves, found)


def _turned_back(curves: StarCurves, values: Floats, at: Floats) -> tuple[Ints, Ints, Floats]:
    """Return samples beside which what is seen changes twice: curve, sample, and an angle between.

    There the values, whose signs are those of the samples around, have an extremum of another sign.
    """
    before, after = np.roll(values, 1, axis=1), np.roll(values, -1, axis=1)
    sign = np.where(values > 0, 1.0, -1.0)
    turns = (sign * before >= sign * values) & (sign * after >= sign * values)
    turns &= (sign * before > 0) & (sign * after > 0) & (sign * values < CLOSE * TURN / SAMPLES)
    curve, sample = np.nonzero(turns)
    way, step = sign[curve, sample], TURN / SAMPLES
    low, high = at[sample] - step, at[sample] + step
    for _ in range(THIRDS):
        third = (high - low) / 3
        inner = [way * curves.seen(curve, each) for each in (low + third, high - third)]
        left = inner[0] < inner[1]
        low, high = np.where(left, low, low + third), np.where(left, high - third, high)
    place = (low + high) / 2
    changes = way * curves.seen(curve, place) < -LEAST
    return curve[changes], sample[changes], place[changes]


def _joined(curve: Ints, angle: Floats, begins: np.ndarray) -> Outlines:
    """Return the pieces between ends of visible stretches, which are sorted by curve and angle."""
    # Of a curve that is seen at angle 0 the first end belongs to the last begin.
    is_first = np.diff(curve, prepend=-1) != 0
    angle = np.where(is_first & ~begins, angle + TURN, angle)
    order = np.lexsort((angle, curve))
    curve, angle = curve[order], angle[order]
    return Outlines(curve[0::2], angle[0::2], angle[1::2])


def _halved(curves: StarCurves, found: Outlines) -> Outlines:
    """Return the pieces, those of balls cut where the seam of their ball meets them."""
    x, y, center = curves.x[found.curve], curves.y[found.curve], curves.center[found.curve]
    radius = curves.radius[found.curve]
    frame = curves.frames[curves.node[found.curve]]  # (e, 3, 3)
    # Toward the ball's x and y, what a circle's x, its y and its center are: (2, 3, e).
    circle = np.stack([radius[:, None] * x, radius[:, None] * y, center])
    along, (a, b, c) = np.einsum("ecx,kex->cke", frame[:, :2], circle)
    size = np.hypot(a, b)
    meets = (curves.kind[found.curve] == Kind.BALL) & (size > np.abs(c)) & (size > 0)
    half = np.arccos(np.clip(-c / np.where(size > 0, size, 1.0), -1.0, 1.0))
    middle = np.arctan2(b, a)
    cuts = np.full((len(size), 4), np.nan)
    for k, at in enumerate((middle - half, middle + half)):
        offset = found.start + np.mod(at - found.start, TURN)
        inside = meets & (offset > found.start) & (offset < found.end)
        inside &= along[0] * np.cos(at) + along[1] * np.sin(at) + along[2] < 0
        cuts[inside, 1 + k] = offset[inside]
    cuts[:, 0], cuts[:, 3] = found.start, found.end
    cuts.sort(axis=1)  # nan last
    row, column = np.nonzero(~np.isnan(cuts[:, 1:]))
    pieces = Outlines(found.curve[row], cuts[row, column], cuts[row, column + 1])
    order = np.lexsort((pieces.start, pieces.curve))
    # A whole circle that is cut has no end at its first angle.
    return _without_first(pieces.chosen(order), found)


def _without_first(pieces: Outlines, before: Outlines) -> Outlines:
    """Return pieces, the first and last of each whole circle that was cut in one."""
    whole = np.zeros(int(before.curve.max(initial=-1)) + 1, dtype=np.bool_)
    whole[before.curve[before.end - before.start > TURN - 1e-12]] = True
    if len(pieces.curve) == 0:
        return pieces
    first = np.diff(pieces.curve, prepend=-1) != 0
    last = np.diff(pieces.curve, append=-1) != 0
    joins = whole[pieces.curve] & ~(first & last)
    end = pieces.end.copy()
    heads, tails = np.flatnonzero(joins & first), np.flatnonzero(joins & last)
    end[tails] = pieces.end[heads] + TURN
    keep = np.ones(len(end), dtype=np.bool_)
    keep[heads] = False
    return Outlines(pieces.curve[keep], pieces.start[keep], end[keep])
