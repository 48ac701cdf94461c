"""What is surely seen from a point, in rounded numbers."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.base.vectors import dot, length, triple

MARGIN = 1e-9
"""Least distance from a separating plane that counts as apart, in lengths of what is compared."""

ROUNDING = 1e-14
"""Error of a coordinate and what is added to it, in largest coordinates: some 50 roundings."""


SINGLE_ROUNDING = 2.0**-22
"""More than twice as far as a point is off in 32-bit coordinates, in its largest coordinate."""


def rounding_of(vertices: Points, part: float = ROUNDING) -> float:
    """Return how far coordinates may be off, mm, given that as a part of the largest of them."""
    return part * float(np.abs(vertices).max())


def in_front(planes: Floats, points: Points, spread: Floats, rounding: float) -> Bools:
    """Return which points surely lie in front of which planes through 0.

    Parameters
    ----------
    planes : (..., q, 3) float64, normals, each the product of two vectors, mm²
    points : (..., p, 3) float64, mm
    spread : (..., q) float64, by how much the size of a plane may change for each mm that
        coordinates are off: the sum of the lengths of its two vectors, twice that where both ends
        of these may be off, mm
    rounding : how far coordinates may be off, mm

    Returns
    -------
    (..., p, q) bool
    """
    heights = points @ np.swapaxes(planes, -1, -2)
    size, reach = length(planes)[..., None, :], length(points)[..., :, None]
    margin = MARGIN * reach * size + rounding * (size + reach * spread[..., None, :])
    return np.asarray(heights > margin)


def seen(a: Points, b: Points, c: Points, rounding: float) -> tuple[Bools, Floats]:
    """Return which triangles are surely seen from 0 from their inner side, and how large.

    Parameters
    ----------
    a, b, c : (..., 3) float64, corners, counter-clockwise seen from outside, mm
    rounding : how far coordinates may be off, mm

    Returns
    -------
    (...) bool, and (...) float64, their solid angles, rad²

    References
    ----------
    van Oosterom, Strackee, The solid angle of a plane triangle, 1983.
    """
    la, lb, lc = length(a), length(b), length(c)
    product, volume = la * lb * lc, triple(a, b, c)
    cosine = product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    margin = MARGIN * product + rounding * (la * lb + lb * lc + lc * la)
    return np.asarray(volume > margin), 2.0 * np.arctan2(volume, cosine)
