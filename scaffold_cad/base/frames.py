"""Rotation-minimizing frames along polylines, by the double reflection method.

The step from one node to the next is a rotation: a reflection in the plane across the chord, then
one that brings the mirrored tangent onto the next tangent. Two reflections are one quaternion, and
the frames of all polylines come from one segmented scan over the products of these quaternions.

References
----------
Wang, Jüttler, Zheng, Liu, Computation of rotation minimizing frames, ACM TOG 27(1), 2008.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scaffold_cad.base.arguments import as_direction, checks_keywords
from scaffold_cad.base.arrays import Floats, Frames, Ints, Points, UnitVectors, as_points
from scaffold_cad.base.placements import DirectionLike
from scaffold_cad.base.summaries import counted
from scaffold_cad.base.vectors import any_perpendicular, dot, length, normalize
from scaffold_cad.errors import OptionError

Quaternions: TypeAlias = NDArray[np.float64]
"""Rotations as unit quaternions (w, x, y, z), shape (k, 4)."""

LEAST_ACROSS = 1e-9
"""Least length of a difference of unit vectors, or of a part of one: rounding decides below it."""


def double_reflection(
    chords: UnitVectors, start_tangents: UnitVectors, end_tangents: UnitVectors
) -> Quaternions:
    """Return the rotation that each step of a polyline makes its frame undergo.

    Parameters
    ----------
    chords : (k, 3) float64, unit vectors from the step's first node to its second
    start_tangents, end_tangents : (k, 3) float64, unit tangents at those nodes

    Returns
    -------
    (k, 4) float64, unit quaternions that turn `start_tangents` to `end_tangents`
    """
    mirrored = start_tangents - 2.0 * dot(chords, start_tangents)[:, None] * chords
    normals = end_tangents - mirrored
    # Where a tangent was turned back already, any mirror that it lies in leaves it so.
    turned_back = length(normals) < LEAST_ACROSS
    normals[turned_back] = any_perpendicular(end_tangents[turned_back])
    normals = normalize(normals)
    # Mirroring in planes with unit normals c, then n, turns by twice the angle from c to n.
    return np.column_stack([dot(chords, normals), np.cross(chords, normals)])


def multiply(later: Quaternions, earlier: Quaternions) -> Quaternions:
    """Return the rotations that do `earlier` first and `later` then, (k, 4)."""
    scalar = later[:, 0] * earlier[:, 0] - dot(later[:, 1:], earlier[:, 1:])
    vector = (
        later[:, :1] * earlier[:, 1:]
        + earlier[:, :1] * later[:, 1:]
        + np.cross(later[:, 1:], earlier[:, 1:])
    )
    return np.column_stack([scalar, vector])


def turn(rotations: Quaternions, vectors: Floats) -> Floats:
    """Return `vectors` (k, 3) turned by `rotations` (k, 4)."""
    scalar, axis = rotations[:, :1], rotations[:, 1:]
    across = 2.0 * np.cross(axis, vectors)
    return vectors + scalar * across + np.cross(axis, across)


def accumulate(steps: Quaternions, position: Ints) -> Quaternions:
    """Return the product of each step with all steps before it in its polyline.

    Parameters
    ----------
    steps : (k, 4) float64, the steps of all polylines one after the other
    position : (k,) intp, number of steps before each one in its own polyline

    Notes
    -----
    A segmented scan by doubling: O(k log L) array work for polylines of up to L steps.
    """
    total = steps.copy()
    reach = 1
    while reach <= position.max(initial=0):
        late = np.flatnonzero(position >= reach)
        total[late] = multiply(total[late], total[late - reach])
        reach *= 2
    total /= np.linalg.norm(total, axis=1, keepdims=True)
    return total


def bisectors(before: UnitVectors, after: UnitVectors) -> UnitVectors:
    """Return the unit tangents between the chords `before` and those `after`, (k, 3).

    Chords that turn back on themselves have no bisector: the tangent stays along the first.
    """
    sums = before + after
    sharp = length(sums) < LEAST_ACROSS
    sums[sharp] = before[sharp]
    return normalize(sums)


@checks_keywords()
def rotation_minimizing_frames(points: ArrayLike, first_x: DirectionLike | None = None) -> Frames:
    """Return a frame at each point of an open polyline that turns about its tangent least.

    Parameters
    ----------
    points : (k, 3) float64, mm, no two consecutive ones equal
    first_x : (3,) float64, x axis at the first point; made perpendicular to the polyline

    Returns
    -------
    (k, 3, 3) float64, rows x, y, z, with z along the polyline: where it bends along the bisector
        of both sides, and where it turns back on itself along the side before

    Raises
    ------
    OptionError
        If there are fewer than two points, two consecutive ones are equal, or `first_x` is no
        vector or along the polyline.

    Examples
    --------
    >>> from scaffold_cad import rotation_minimizing_frames
    >>> rotation_minimizing_frames([[0, 0, 0], [1, 0, 0], [2, 1, 0]], [0, 0, 1]).shape
    (3, 3, 3)
    """
    points = as_points(points, "points", OptionError)
    if len(points) < 2:
        raise OptionError(f"the polyline has {counted(len(points), 'point')}; need 2 or more")
    chords = normalize(np.diff(points, axis=0))
    still = np.flatnonzero(~chords.any(axis=1))
    if len(still):
        place = points[still[0]].tolist()
        raise OptionError(
            f"points {still[0]} and {still[0] + 1} are both at {place} mm; need distinct ones"
        )
    tangents = np.vstack([chords[:1], bisectors(chords[:-1], chords[1:]), chords[-1:]])
    x = any_perpendicular(tangents[0]) if first_x is None else _across(first_x, tangents[0])
    steps = double_reflection(chords, tangents[:-1], tangents[1:])
    turned = turn(accumulate(steps, np.arange(len(steps))), np.broadcast_to(x, chords.shape))
    axes = np.vstack([x[None, :], turned])  # (k, 3)
    return np.stack([axes, np.cross(tangents, axes), tangents], axis=1)


def _across(vector: DirectionLike, tangent: UnitVectors) -> UnitVectors:
    """Return the direction of the part of `vector` (3,) at right angles to `tangent` (3,)."""
    direction = as_direction(vector, "first_x")
    across = direction - dot(direction, tangent) * tangent
    if length(across) < LEAST_ACROSS:
        raise OptionError(
            f"first_x is along {direction.tolist()}, as the polyline's start; need one across it"
        )
    return normalize(across)


def square_phases(corners: Points, x: UnitVectors, y: UnitVectors) -> Floats:
    """Return the angle from `x` toward `y` to the first corner of the square that fits best.

    It is the circular mean of the angles at which the corners stand, corner k turned back by k
    quarter turns; rad, shape (...).

    Parameters
    ----------
    corners : (..., 4, 3) float64, seen from the middle of the square
    x, y : (..., 3) float64, at right angles to each other

    Examples
    --------
    >>> corners = np.array([[0.0, 2, 0], [-1, 0, 0], [0, -1, 0], [1, 0, 5]])
    >>> float(np.degrees(square_phases(corners, np.eye(3)[0], np.eye(3)[1])))
    90.0
    """
    across, along = dot(corners, x[..., None, :]), dot(corners, y[..., None, :])
    size = np.sqrt(np.maximum(across * across + along * along, 1e-300))
    turned = (across + 1j * along) / size * np.array([1, -1j, -1, 1j])
    phases: Floats = np.angle(turned.sum(axis=-1))
    return phases
