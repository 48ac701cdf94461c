"""The shortest way of a ball's center that is far enough from the planes near it.

See `distances`: at distances d_j from planes with normals n_j, each lacks e_j = ρ − d_j, and the
center is moved by the shortest y with n_j · y ≥ e_j.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.base.vectors import leading_dot

SWEEPS = 6
"""Steps in which the shares of normals in the way to the ball's center are found."""
SAME_WAY = 1 - 1e-9
"""Cosine between normals from which on they are taken to be the same."""


def nearby(distances: Floats, reach: Floats) -> tuple[Ints, Ints, Ints]:
    """Return two of the distances (n, P) below `reach` (P,), and how many there are, all (P,).

    Where there is only one, it is the first of the two; where there are more, any two are.
    """
    count, total, square = (np.zeros(len(reach), dtype=np.int32) for _ in range(3))
    for strut, distance in enumerate(distances):
        is_near = distance < reach
        count += is_near
        total += np.multiply(is_near, strut, dtype=np.int32)
        square += np.multiply(is_near, strut * strut, dtype=np.int32)
    # Two numbers with a given sum and a given sum of squares; or one, and 0.
    apart = np.sqrt(np.maximum(2 * square - total * total, 0)).astype(np.int32)
    near = np.where(count == 1, total, (total + apart) >> 1)
    near = np.minimum(near, len(distances) - 1)
    return near.astype(np.intp), ((total - apart) >> 1).astype(np.intp), count.astype(np.intp)


def most_needed(distances: Floats, reach: Floats, most: int) -> tuple[Ints, Floats]:
    """Return which of distances (n, P) are below `reach` (P,), and by how much, both (most, P).

    Where fewer are, the first one stands for the rest, with needs of 0.
    """
    is_near = distances < reach
    found = np.flatnonzero(is_near.T)
    if len(found) == most * len(reach):  # as many at each point
        struts = np.ascontiguousarray((found % len(distances)).reshape(-1, most).T)
        places = struts * len(reach) + np.arange(len(reach))
        return struts, reach - distances.reshape(-1)[places]
    place = np.cumsum(is_near, axis=0) - 1
    which, point = np.nonzero(is_near)
    struts, needs = np.zeros((most, len(reach)), dtype=np.intp), np.zeros((most, len(reach)))
    struts[place[which, point], point] = which
    needs[place[which, point], point] = reach[point] - distances[which, point]
    return struts, needs


def of_two(one: Floats, other: Floats, first: Floats, second: Floats) -> tuple[Floats, Floats]:
    """Return |y| and its direction where two surfaces are near, (P,) and (3, P).

    Parameters
    ----------
    one, other : (P,) float64, what distances lack
    first, second : (3, P) float64, the normals
    """
    cosine = np.clip(leading_dot(first, second), 0.0, 1.0)
    # The shares of both, up to a factor; where one is missing the other's need is enough for both.
    shares = np.maximum(one - cosine * other, 0.0), np.maximum(other - cosine * one, 0.0)
    is_corner = (shares[0] > 0) & (shares[1] > 0) & (cosine < SAME_WAY)
    sine = np.where(is_corner, np.sqrt(1 - cosine**2), 1.0)
    norm = np.sqrt(one * shares[0] + other * shares[1]) / sine
    norm = np.where(is_corner, norm, np.maximum(one, other))
    parts = (
        np.where(is_corner, share / (sine**2 * norm), is_more)
        for share, is_more in zip(shares, (one >= other, one < other), strict=True)
    )
    return norm, next(parts) * first + next(parts) * second


def of_many(needs: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """Return |y| and its direction where n surfaces are near, (P,) and (3, P).

    λ ≥ 0 makes e · λ / |y| greatest, e what each distance lacks; found by Gauss and Seidel's
    steps, of which few are enough: |y| is wrong by the square of what λ is.

    Parameters
    ----------
    needs : (n, P) float64, what distances lack
    normals : (n, 3, P) float64
    """
    every = range(len(needs))
    cosines = np.empty((len(needs), *needs.shape))  # without the diagonal
    for i in every:
        for j in range(i):
            cosines[i, j] = cosines[j, i] = np.clip(leading_dot(normals[i], normals[j]), 0.0, 1.0)
    # Rounding must not choose between equal needs.
    shares = np.where(needs >= (1 - 1e-9) * needs.max(axis=0), needs, 0.0)
    for _ in range(SWEEPS):
        for i in every:
            np.maximum(needs[i] - _of_others(i, cosines, shares), 0.0, out=shares[i])
    rest = np.stack([_of_others(i, cosines, shares) for i in every])
    square = (shares * (shares + rest)).sum(axis=0)
    norm = (needs * shares).sum(axis=0) / np.sqrt(np.maximum(square, 1e-300))
    return norm, (shares[:, None] * normals).sum(axis=0) / norm


def _of_others(which: int, cosines: Floats, shares: Floats) -> Floats:
    """Return the sum of the other shares (n, P) times their cosines (n, n, P), shape (P,)."""
    first, *others = (k for k in range(len(shares)) if k != which)
    total: Floats = cosines[which, first] * shares[first]
    for k in others:
        total += cosines[which, k] * shares[k]
    return total
