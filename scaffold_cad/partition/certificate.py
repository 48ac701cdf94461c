"""The proof that quads tile the sphere, each one star-shaped around its direction.

Quad i with corners a, b, c, d, counter-clockwise seen from outside, is star-shaped around P_i
when det(a, b, P_i), det(b, c, P_i), det(c, d, P_i) and det(d, a, P_i) are all positive. The 4 N
spherical triangles (P_i, a, b) then keep their orientation. If each arc is run along once in
either direction they close up to a surface that covers the sphere a whole number of times, and
if their areas add up to 4 π it covers it once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints, UnitVectors
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import dot, length, triple
from scaffold_cad.partition.arcs import is_closed

MIN_CLEARANCE = 1e-9
"""Least clearance of a certified quad, rad: rounding moves a determinant by some 1e-15."""
SHORTEST_ARC = 1e-6
"""Least sine of an arc's length: the normal of a shorter one is off by more than 1e-10 rad."""
AREA_TOLERANCE = 1e-6
"""Largest error of the sum of the triangles' areas, steradian: it can only jump by 4 π."""
QUAD_BYTES = 320
"""What a quad takes where it is certified."""


@dataclass(frozen=True, eq=False)
class Certificate(Frozen):
    """What was proved about each of M partitions of valency N."""

    clearance: Floats
    """Angle from each direction to the nearest great circle of its quad, rad, shape (M, N).

    It is negative where the direction lies on the wrong side of an arc.
    """
    valid: Bools
    """Whether the quads tile the sphere, each star-shaped around its direction, shape (M,)."""

    def __str__(self) -> str:
        return f"Certificate: {self.valid.sum()} of {len(self.valid)} partitions are valid"


def certify(directions: UnitVectors, vertices: UnitVectors, quads: Ints) -> Certificate:
    """Return the clearances of M partitions, and whether each is valid.

    Parameters
    ----------
    directions : (M, N, 3) float64, unit vectors
    vertices : (M, N + 2, 3) float64, unit vectors
    quads : (M, N, 4) intp, vertices of the quad around each direction
    """
    clearance = np.empty(directions.shape[:2])
    valid = np.empty(len(directions), dtype=np.bool_)
    for block in blocks(len(directions), directions.shape[1] * QUAD_BYTES):
        apexes, corners = directions[block], corners_of(vertices[block], quads[block])
        clearance[block] = clearances(apexes, arc_normals(corners))
        areas = triangle_areas(apexes, corners).sum(axis=(1, 2))
        with np.errstate(invalid="ignore"):
            valid[block] = (
                (clearance[block] > MIN_CLEARANCE).all(axis=1)
                & (np.abs(areas - 4 * np.pi) < AREA_TOLERANCE)
                & is_closed(quads[block])
            )
    return Certificate(clearance, valid)


def corners_of(vertices: UnitVectors, quads: Ints) -> UnitVectors:
    """Return the corners of each quad, shape (M, N, 4, 3)."""
    return vertices[np.arange(len(quads))[:, None, None], quads]


def arc_normals(corners: UnitVectors) -> UnitVectors:
    """Return the unit normal, toward the quad, of each arc's great circle, (..., 4, 3).

    The normal of an arc between vertices that are nearly equal or opposite is not a number.
    """
    normals = np.cross(corners, np.roll(corners, -1, axis=-2))
    size = length(normals)[..., None]
    unit: UnitVectors = normals / np.where(size > SHORTEST_ARC, size, np.nan)
    return unit


def clearances(directions: UnitVectors, normals: UnitVectors) -> Floats:
    """Return the angle from each direction to the nearest great circle of its arcs, rad, (M, N)."""
    sines = dot(normals, directions[:, :, None])  # (M, N, 4)
    nearest: Floats = np.arcsin(np.clip(sines, -1.0, 1.0)).min(axis=2)
    return nearest


def triangle_areas(directions: UnitVectors, corners: UnitVectors) -> Floats:
    """Return the signed areas of the triangles (P_i, corner, next corner), (M, N, 4).

    References
    ----------
    Van Oosterom, Strackee, The solid angle of a plane triangle, IEEE TBME 30(2), 1983.
    """
    following = np.roll(corners, -1, axis=2)
    apexes = directions[:, :, None]
    spanned = triple(corners, following, apexes)
    leaving = dot(apexes, corners)
    along = dot(corners, following)
    areas: Floats = 2 * np.arctan2(spanned, 1 + leaving + np.roll(leaving, -1, axis=2) + along)
    return areas
