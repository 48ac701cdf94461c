"""Crotches: short arcs of partitions between struts that part late.

Between two struts at a narrow angle the surface reaches far out, and is sharp there. A patch that
begins on a long arc across such a crotch would go out and back again, and folds. So the arc is
drawn together to the crotch itself, and what lies beside it is left to the arcs that follow.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.vectors import angle_between, dot, normalize, sums_by_row
from scaffold_cad.partition.arcs import side_twins
from scaffold_cad.partition.certificate import certify, corners_of

WIDE = np.radians(45)
"""Angle between two struts from which on an arc between them may be long."""
NARROW = np.radians(20), np.radians(4)
"""Such an angle, and half the length of the arc there, rad."""
BESIDE = np.radians(35)
"""How far the middle of an arc may be from the crotch: arcs on the far side are as they are."""
SHARES = (1.0, 0.5, 0.25)
"""Parts of the way that are tried, until the partition keeps its certificate."""


def half_length(between: Floats) -> Floats:
    """Return half the length of the arc between struts at angles `between`, both rad."""
    found: Floats = np.interp(between, [NARROW[0], WIDE], [NARROW[1], np.pi / 4])
    return found


def with_short_arcs(directions: UnitVectors, vertices: UnitVectors, quads: Ints) -> UnitVectors:
    """Return the vertices (M, N + 2, 3) of M partitions with short arcs in crotches.

    Parameters
    ----------
    directions : (M, N, 3) float64, unit vectors
    vertices : (M, N + 2, 3) float64, unit vectors
    quads : (M, N, 4) intp, vertices of the quad around each direction
    """
    wanted = _wanted(directions, vertices, quads)
    found = np.array(vertices)
    left = np.flatnonzero((wanted != vertices).any(axis=(1, 2)))
    for share in SHARES:
        if len(left) == 0:
            break
        moved = normalize((1 - share) * vertices[left] + share * wanted[left])
        good = certify(directions[left], moved, quads[left]).valid
        found[left[good]] = moved[good]
        left = left[~good]
    return found


def _wanted(directions: UnitVectors, vertices: UnitVectors, quads: Ints) -> UnitVectors:
    """Return where the ends of arcs in crotches are wanted, and other vertices as they are."""
    count = len(quads)
    row = np.arange(count)[:, None]
    start = corners_of(vertices, quads).reshape(count, -1, 3)  # (M, 4 N, 3), of each side
    end = np.roll(corners_of(vertices, quads), -1, axis=2).reshape(count, -1, 3)
    own = np.repeat(directions, 4, axis=1)
    other = directions[row, side_twins(quads) // 4]
    between = angle_between(own, other)  # (M, 4 N)
    middle = normalize(own + other)
    across = np.cross(own, other)
    across = normalize(np.where(dot(across, start - end)[..., None] < 0, -across, across))
    half = half_length(between)
    is_crotch = (between < WIDE) & (dot(normalize(start + end), middle) > np.cos(BESIDE))
    is_crotch &= dot(start, middle) < np.cos(half)  # else it is near enough
    place = np.cos(half)[..., None] * middle + np.sin(half)[..., None] * across
    which = np.nonzero(is_crotch)
    each = vertices.shape[1]
    corner = which[0] * each + quads.reshape(count, -1)[which]
    sums = sums_by_row(place[which], corner, count * each).reshape(vertices.shape)
    found = np.array(vertices)
    moved = (sums != 0).any(axis=2)
    found[moved] = normalize(sums[moved])
    return found
