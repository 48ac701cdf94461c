"""How far outer points of hexahedra are moved, so that these have the volume of round struts.

Faces between points of a round surface lie behind it, or before it where it is hollow. As
compensation, each point is moved along the surface's normal until that adds the gaps around it: on
cylinders by as much as polygons are larger than circles of their area. Where a hexahedron would
become too bad, its points are moved less.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points, Quads, UnitVectors
from scaffold_cad.base.vectors import dot, length
from scaffold_cad.mechanics.hexahedra.quality import scaled_jacobians

LEAST_ANGLE = 1e-4
"""Between normals, rad; below it a side's gap is that of a parabola."""

LEAST_PART = 1 / 8
"""Of a move; where half of that is too much for a hexahedron its points stay."""


def compensated(
    points: Points, hexahedra: Ints, faces: Quads, normals: UnitVectors, goal: float
) -> Points:
    """Return the points, those of `faces` moved along their normals by the gaps around them.

    No hexahedron gets a scaled Jacobian below `goal`, or below what it has.

    Parameters
    ----------
    points : (p, 3) float64, mm, on a surface where they are of faces
    hexahedra : (k, 8)
    faces : (f, 4) outer faces on the surface, counter-clockwise seen from outside
    normals : (p, 3) of the surface, outward, at the points of faces
    """
    moves = _lifts(points, faces, normals)[:, None] * normals
    least = np.minimum(scaled_jacobians(points, hexahedra), goal)
    part, looked_at = np.ones(len(points)), np.arange(len(hexahedra))
    while True:
        moved: Points = points + part[:, None] * moves
        bad = scaled_jacobians(moved, hexahedra[looked_at]) < least[looked_at]
        if not bad.any():
            return moved
        slower = np.unique(hexahedra[looked_at[bad]])
        part[slower] = np.where(part[slower] > LEAST_PART, part[slower] / 2.0, 0.0)
        is_slower = np.zeros(len(points), dtype=np.bool_)
        is_slower[slower] = True
        looked_at = np.flatnonzero(is_slower[hexahedra].any(axis=1))


def _lifts(points: Points, faces: Quads, normals: UnitVectors) -> Floats:
    """Return how far points are to be moved for the gaps of the faces around them, (p,), mm."""
    corners, ways = points[faces], normals[faces]  # (f, 4, 3)
    gaps = _gaps(corners, ways)  # (f, 4) of the sides that begin at corners
    area = length(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])) / 2.0
    added = area[:, None] * (gaps + np.roll(gaps, 1, axis=1))
    count = len(points)
    total = np.bincount(faces.reshape(-1), added.reshape(-1), count)
    share = np.bincount(faces.reshape(-1), np.repeat(area, 4), count)
    return np.divide(total, share, out=np.zeros(count), where=share > 0.0)


def _gaps(corners: Points, ways: UnitVectors) -> Floats:
    """Return how far the sides of faces are to be moved, as if each were a chord of a circle.

    A polygon whose chords each turn by an angle t has its circle's area if its corners are moved
    outward by the part √(t / sin t) − 1 of the radius.

    Parameters
    ----------
    corners : (f, 4, 3) mm
    ways : (f, 4, 3) normals there
    """
    chord, turn = (np.roll(each, -1, axis=1) - each for each in (corners, ways))
    half = np.minimum(length(turn) / 2.0, np.sqrt(0.5))  # sin(t / 2)
    angle = np.maximum(2.0 * np.arcsin(half), LEAST_ANGLE)
    part = (np.sqrt(angle / np.sin(angle)) - 1.0) / (4.0 * np.sin(angle / 2.0) ** 2)
    return np.asarray(part * dot(chord, turn))
