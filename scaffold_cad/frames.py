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
from numpy.typing import NDArray

from scaffold_cad.arrays import Floats, Frames, Ints, Points, UnitVectors
from scaffold_cad.vectors import any_perpendicular, dot, normalize

Quaternions: TypeAlias = NDArray[np.float64]
"""Rotations as unit quaternions (w, x, y, z), shape (k, 4)."""


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
    normals = normalize(end_tangents - mirrored)
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


def polyline_tangents(points: Points, *, closed: bool = False) -> UnitVectors:
    """Return a unit tangent at each point of a polyline: the bisector of its two chords, (k, 3).

    The ends of an open polyline take the direction of their only chord.
    """
    chords = normalize(np.diff(points, axis=0, append=points[:1]))
    before = np.roll(chords, 1, axis=0)
    tangents = normalize(before + chords)
    if not closed:
        tangents[0], tangents[-1] = chords[0], before[-1]
    return tangents


def rotation_minimizing_frames(points: Points, first_x: UnitVectors | None = None) -> Frames:
    """Return a frame at each point of an open polyline that turns about its tangent least.

    Parameters
    ----------
    points : (k, 3) float64, mm, no two consecutive ones equal
    first_x : (3,) float64, x axis at the first point; made perpendicular to the polyline

    Returns
    -------
    (k, 3, 3) float64, rows x, y, z, with z along the polyline
    """
    tangents = polyline_tangents(points)
    if first_x is None:
        x = any_perpendicular(tangents[0])
    else:
        x = normalize(first_x - (first_x @ tangents[0]) * tangents[0])
    chords = normalize(np.diff(points, axis=0))
    steps = double_reflection(chords, tangents[:-1], tangents[1:])
    turned = turn(accumulate(steps, np.arange(len(steps))), np.broadcast_to(x, chords.shape))
    axes = np.vstack([x[None, :], turned])  # (k, 3)
    return np.stack([axes, np.cross(tangents, axes), tangents], axis=1)
