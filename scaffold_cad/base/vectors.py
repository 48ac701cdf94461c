"""Helpers on stacks of vectors: the last axis has length 3, the others are free."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Edges, Floats, Frames, Ints, Points, UnitVectors

STILL = 1e-6
"""Weight of no rotation among directions of weight 1: it decides where they leave a choice."""


def dot(a: Floats, b: Floats) -> Floats:
    """Return the dot products of `a` and `b` along the last axis, shape (...)."""
    products: Floats = np.einsum("...i,...i->...", a, b)
    return products


def leading_dot(a: Floats, b: Floats) -> Floats:
    """Return the dot products of `a` and `b` (3, ...) along the first axis, shape (...)."""
    products: Floats = a[0] * b[0]
    products += a[1] * b[1]
    products += a[2] * b[2]
    return products


def length(vectors: Floats) -> Floats:
    """Return the lengths of `vectors` (..., 3), shape (...)."""
    lengths: Floats = np.sqrt(dot(vectors, vectors))
    return lengths


def normalize(vectors: Floats) -> UnitVectors:
    """Return `vectors` (..., 3) scaled to length 1; a zero vector stays zero."""
    lengths = length(vectors)[..., None]
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)


def both_directions(nodes: Points, edges: Edges) -> UnitVectors:
    """Return the unit vectors in which edges (m, 2) leave their first and last node, (2 m, 3)."""
    ahead = normalize(nodes[edges[:, 1]] - nodes[edges[:, 0]])
    return np.stack([ahead, -ahead], axis=1).reshape(-1, 3)


def triple(a: Floats, b: Floats, c: Floats) -> Floats:
    """Return det(a, b, c), the signed volume that the vectors span, shape (...)."""
    return dot(np.cross(a, b), c)


def angle_between(a: UnitVectors, b: UnitVectors) -> Floats:
    """Return the angles between unit vectors in [0, π], exact for tiny angles too, rad."""
    return 2.0 * np.arctan2(length(a - b), length(a + b))


def mirror(vectors: Floats, normals: Floats) -> Floats:
    """Return `vectors` mirrored in the planes through 0 with `normals` (of any length > 0)."""
    scale = 2.0 * dot(vectors, normals) / dot(normals, normals)
    return vectors - scale[..., None] * normals


def any_perpendicular(vectors: UnitVectors) -> UnitVectors:
    """Return a unit vector at right angles to each of `vectors` (..., 3).

    It is the part of the coordinate axis least along the vector that is at right angles to
    it: the same input gives the same output.
    """
    axes = np.eye(3)[np.argmin(np.abs(vectors), axis=-1)]
    return normalize(axes - dot(axes, vectors)[..., None] * vectors)


def four_around(x: Floats, y: Floats) -> Floats:
    """Return x, y, -x and -y of each row (k, 3), the corners of a square: (k, 4, 3)."""
    return np.stack([x, y, -x, -y], axis=1)


def sums_by_row(values: Floats, rows: Ints, count: int) -> Floats:
    """Return the sum of the `values` of each of `count` rows, shape (count, *s).

    Parameters
    ----------
    values : (..., *s) float64
    rows : (...) intp, in 0..count-1: the row that each value is added to

    Examples
    --------
    >>> sums_by_row(np.array([[1.0, 0.0], [2.0, 1.0], [5.0, 5.0]]), np.array([0, 0, 2]), 3).tolist()
    [[3.0, 1.0], [0.0, 0.0], [5.0, 5.0]]
    """
    each, flat = values.shape[rows.ndim :], rows.reshape(-1)
    columns = values.reshape(len(flat), int(np.prod(each))).T
    sums = [np.bincount(flat, weights=column, minlength=count) for column in columns]
    table: Floats = np.stack(sums, axis=-1).astype(np.float64, copy=False)
    return table.reshape(count, *each)


def running_sums(values: Floats, position: Ints) -> Floats:
    """Return the sum of each of `values` (k,) and of those before it in its own run, (k,).

    A run's sums are the same to the last bit whatever other runs there are.

    Parameters
    ----------
    values : (k,) float64, run after run
    position : (k,) intp, number of values before each one in its run

    Examples
    --------
    >>> running_sums(np.array([1.0, 2.0, 3.0, 5.0]), np.array([0, 1, 2, 0])).tolist()
    [1.0, 3.0, 6.0, 5.0]
    """
    total = values.copy()
    reach = 1
    while reach <= position.max(initial=0):
        late = np.flatnonzero(position >= reach)
        total[late] = total[late] + total[late - reach]
        reach *= 2
    return total


def rotate(vectors: Floats, axes: UnitVectors, angles: Floats) -> Floats:
    """Return `vectors` turned about `axes` by `angles` (rad, right-handed): Rodrigues."""
    cosine = np.cos(angles)[..., None]
    sine = np.sin(angles)[..., None]
    along = dot(axes, vectors)[..., None] * axes
    return cosine * (vectors - along) + sine * np.cross(axes, vectors) + along


def rotated(vectors: Floats, turns: Floats) -> Floats:
    """Return vectors (k, 3) turned by rotation vectors (k, 3), rad."""
    angles = length(turns)
    return rotate(vectors, turns / np.maximum(angles, 1e-300)[:, None], angles)


def shortest_turns(before: UnitVectors, after: UnitVectors) -> Floats:
    """Return the rotation vectors that turn unit vectors (k, 3) to others the shortest way, rad."""
    across = np.cross(before, after)
    sine = length(across)
    axis = np.where(sine[:, None] > 0, across, any_perpendicular(before))
    return np.asarray(np.arctan2(sine, dot(before, after))[:, None] * normalize(axis))


def best_turns(sums: Floats) -> Frames:
    """Return the rotations (k, 3, 3) that bring directions closest to others, the least of these.

    Parameters
    ----------
    sums : (k, 3, 3) of the outer products of where each direction is to be and where it is

    References
    ----------
    Kabsch, A solution for the best rotation to relate two sets of vectors, 1976.
    """
    left, _, right = np.linalg.svd(sums + STILL * np.eye(3))
    left[:, :, 2] *= np.sign(np.linalg.det(left) * np.linalg.det(right))[:, None]
    turns: Frames = left @ right
    return turns
