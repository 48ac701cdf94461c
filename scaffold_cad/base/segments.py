"""Distances between segments in space, and whether they meet a box, many at once."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.base.vectors import dot, length


def nearest_on_segments(
    start_a: Points, end_a: Points, start_b: Points, end_b: Points
) -> tuple[Points, Points]:
    """Return the nearest points of each pair of segments, two arrays of shape (k, 3).

    Parameters
    ----------
    start_a, end_a, start_b, end_b : (k, 3) float64; a segment may have length 0

    References
    ----------
    Ericson, Real-Time Collision Detection, 2005, section 5.1.9.
    """
    along_a, along_b, between = end_a - start_a, end_b - start_b, start_a - start_b
    a, b, e = dot(along_a, along_a), dot(along_a, along_b), dot(along_b, along_b)
    c, f = dot(along_a, between), dot(along_b, between)
    s = np.clip(_quotient(b * f - c * e, a * e - b * b), 0.0, 1.0)
    t = np.clip(_quotient(b * s + f, e), 0.0, 1.0)
    s = np.clip(_quotient(b * t - c, a), 0.0, 1.0)
    return start_a + s[:, None] * along_a, start_b + t[:, None] * along_b


def distance_to_side(a: Floats, b: Floats) -> Floats:
    """Return the distance from 0 to the segments from `a` to `b` (..., 3), shape (...)."""
    span = b - a
    squared = np.maximum(dot(span, span), np.finfo(np.float64).tiny)
    nearest = np.clip(-dot(a, span) / squared, 0.0, 1.0)
    return length(a + nearest[..., None] * span)


def meet_box(start: Points, end: Points, low: Floats, high: Floats) -> Bools:
    """Return which segments (k, 3) have a point in a box along the axes, or on its faces, (k,).

    Parameters
    ----------
    start, end : (k, 3) float64
    low, high : (3,) float64, corners of the box
    """
    span = end - start
    inverse = _quotient(np.ones_like(span), span)
    first, last = (low - start) * inverse, (high - start) * inverse
    beside = (span == 0.0) & ((start < low) | (start > high))
    enters = np.where(span == 0.0, 0.0, np.minimum(first, last)).max(axis=1)
    leaves = np.where(span == 0.0, 1.0, np.maximum(first, last)).min(axis=1)
    meets: Bools = ~beside.any(axis=1) & (np.maximum(enters, 0.0) <= np.minimum(leaves, 1.0))
    return meets


def _quotient(numerator: Floats, denominator: Floats) -> Floats:
    """Return the quotients, and 0 where the denominator is 0."""
    return np.divide(
        numerator, denominator, out=np.zeros_like(numerator), where=np.abs(denominator) > 0
    )
