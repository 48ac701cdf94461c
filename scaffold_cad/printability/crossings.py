"""Where two triangles that cross meet: a place to point at."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.vectors import dot

SLACK = 1e-9
"""How far outside a triangle, in barycentric coordinates, a place may be by rounding."""


def meeting_places(one: Floats, other: Floats) -> Points:
    """Return a point where each pair of triangles meets, shape (k, 3), mm.

    It is the middle of the places where a side of one goes through the other; for triangles in a
    plane, which have none, the middle of all corners.

    Parameters
    ----------
    one, other : corners, (k, 3, 3), mm
    """
    there, through = _pierced(one, other)
    back, also_through = _pierced(other, one)
    places = np.concatenate([there, back], axis=1)  # (k, 6, 3)
    weights = np.concatenate([through, also_through], axis=1)[:, :, None]
    counts = weights.sum(axis=1)
    sums = np.where(weights > 0, places, 0.0).sum(axis=1)
    middles = (one.mean(axis=1) + other.mean(axis=1)) / 2
    meeting: Points = np.where(counts > 0, sums / np.maximum(counts, 1), middles)
    return meeting


def _pierced(one: Floats, other: Floats) -> tuple[Floats, Floats]:
    """Return where the sides of `one` meet the planes of `other`, and 1 if within both, else 0."""
    start, along = one, np.roll(one, -1, axis=1) - one  # (k, 3, 3)
    corner = other[:, None, 0]
    first, second = other[:, None, 1] - corner, other[:, None, 2] - corner
    normal = np.cross(first, second)
    slope = dot(normal, along)
    share = _ratio(dot(normal, corner - start), slope)
    places = start + share[..., None] * along
    spoke = places - corner
    area = dot(normal, normal)
    v = _ratio(dot(np.cross(spoke, second), normal), area)
    w = _ratio(dot(np.cross(first, spoke), normal), area)
    least = np.minimum.reduce([share, 1 - share, v, w, 1 - v - w])
    within = (slope != 0) & (area > 0) & (least >= -SLACK)
    return places, within.astype(np.float64)


def _ratio(numerator: Floats, denominator: Floats) -> Floats:
    """Return the ratios, 0 where the denominator is 0."""
    numerator, denominator = np.broadcast_arrays(numerator, denominator)
    return np.divide(numerator, denominator, out=np.zeros(numerator.shape), where=denominator != 0)
