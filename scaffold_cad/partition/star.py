"""Stars: the directions in which a branch point's edges leave, checked and grouped.

A star is an array of N unit vectors; stars of one valency are stacked as (M, N, 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors, as_floats
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import angle_between, length, normalize
from scaffold_cad.errors import PartitionError
from scaffold_cad.skeleton.overlaps import LEAST_ANGLE

MIN_VALENCY = 3
"""A partition needs a branch point: two directions bound no quad."""
PAIR_BYTES = 640
"""What a pair of directions takes where its angle is calculated."""
KEY_STEPS = 1_000_000
"""Directions are put in a common order by their coordinates rounded to 1/KEY_STEPS.

A coordinate then takes 2 000 001 values, which is less than 2**21: a direction fits 63 bits.
"""
FINE_STEPS = 1000 * KEY_STEPS
"""Directions that agree when rounded to 1/FINE_STEPS belong to one distinct star, and are
partitioned as rounded: so what a star gets depends on no other star, to the last bit."""


def as_stars(values: ArrayLike) -> UnitVectors:
    """Return `values` (M, N, 3) as float64 scaled to unit length.

    Raises
    ------
    PartitionError
        If the shape is wrong, N < 3, or a direction is not finite or zero; it is named.
    """
    stars = as_floats(values, "directions", PartitionError)
    if stars.ndim != 3 or stars.shape[2] != 3:
        raise PartitionError(f"directions have shape {stars.shape}; need (M, N, 3)")
    if stars.shape[1] < MIN_VALENCY:
        raise PartitionError(f"a star has {stars.shape[1]} directions; need at least {MIN_VALENCY}")
    finite = np.isfinite(stars).all(axis=2)
    if not finite.all():
        star, item = np.argwhere(~finite)[0]
        raise PartitionError(
            f"direction {item} of star {star} is {stars[star, item].tolist()}; need finite numbers"
        )
    # Dividing by the largest coordinate first keeps the squares from overflow and underflow.
    largest = np.abs(stars).max(axis=2, keepdims=True, initial=0.0)
    if not (largest > 0).all():
        star, item = np.argwhere(largest[..., 0] == 0)[0]
        raise PartitionError(f"direction {item} of star {star} has length 0; need > 0")
    stars /= largest
    stars /= length(stars)[..., None]
    return stars


def pairwise_angles(stars: UnitVectors) -> Floats:
    """Return the angle between every two directions of each star, π on the diagonal, (M, N, N)."""
    angles = angle_between(stars[:, :, None], stars[:, None])
    diagonal = np.arange(stars.shape[1])
    angles[:, diagonal, diagonal] = np.pi
    return angles


def nearest_angles(stars: UnitVectors) -> Floats:
    """Return the angle from each direction to its nearest neighbor in the star, rad, (M, N)."""
    nearest = np.empty(stars.shape[:2])
    for block in blocks(len(stars), stars.shape[1] ** 2 * PAIR_BYTES):
        nearest[block] = pairwise_angles(stars[block]).min(axis=2)
    return nearest


@dataclass(frozen=True, eq=False)
class DistinctStars:
    """Stars grouped by the set of their rounded directions, whatever their order."""

    first: Ints
    """A star of each group, the first one, shape (U,)."""
    group: Ints
    """Group of each star, shape (M,)."""
    order: Ints
    """Directions of each star in the group's common order, shape (M, N)."""

    def representatives(self, stars: UnitVectors) -> UnitVectors:
        """Return each group's star, rounded, its directions in the common order, (U, N, 3)."""
        chosen = stars[self.first[:, None], self.order[self.first]]
        return normalize(np.rint(chosen * FINE_STEPS))

    def ranks(self) -> Ints:
        """Return the place of each direction of each star in the common order, shape (M, N)."""
        ranks = np.empty_like(self.order)
        np.put_along_axis(ranks, self.order, np.arange(self.order.shape[1])[None], axis=1)
        return ranks


def distinct_stars(stars: UnitVectors) -> DistinctStars:
    """Return the groups of `stars` (M, N, 3) that agree up to the order of their directions."""
    keys = direction_keys(stars)
    order = np.argsort(keys, axis=1, kind="stable")
    rows = np.concatenate(
        [np.take_along_axis(part, order, axis=1) for part in (keys, _fine_keys(stars))], axis=1
    )
    first, group = unique_rows(rows)
    return DistinctStars(first, group, order)


def ordered_stars(stars: UnitVectors, keys: Ints) -> DistinctStars:
    """Return the groups of `stars` that agree in order, and in `keys` (M, K)."""
    rows = np.concatenate([direction_keys(stars), _fine_keys(stars), keys], axis=1)
    return DistinctStars(*unique_rows(rows), _given_order(stars))


def each_alone(stars: UnitVectors) -> DistinctStars:
    """Return groups of one star each."""
    alone = np.arange(len(stars))
    return DistinctStars(alone, alone, _given_order(stars))


def _given_order(stars: UnitVectors) -> Ints:
    return np.broadcast_to(np.arange(stars.shape[1]), stars.shape[:2])


def direction_keys(stars: UnitVectors) -> Ints:
    """Return a number for each direction, the same for those that round alike, (M, N)."""
    return _packed(np.rint(stars * KEY_STEPS).astype(np.int64) + KEY_STEPS)


def _fine_keys(stars: UnitVectors) -> Ints:
    """Return what the finer rounding of each direction adds to its key, (M, N)."""
    coarse, fine = (np.rint(stars * steps).astype(np.int64) for steps in (KEY_STEPS, FINE_STEPS))
    return _packed(fine - coarse * (FINE_STEPS // KEY_STEPS) + FINE_STEPS // KEY_STEPS)


def _packed(steps: Ints) -> Ints:
    """Return three numbers (M, N, 3) in 0..2**21 - 1 as one, (M, N)."""
    packed: Ints = (steps[..., 0] << 42) | (steps[..., 1] << 21) | steps[..., 2]
    return packed


def unique_rows(rows: Ints) -> tuple[Ints, Ints]:
    """Return the first of each set of equal rows of `rows` (M, K), and the set of each row.

    Rows are compared by a 64-bit hash: equal rows always meet, and that different ones do is
    so unlikely that callers, who check what they share, may pay for it with a wasted look.
    """
    mixed = np.zeros(len(rows), dtype=np.uint64)
    for column in rows.astype(np.uint64).T:
        # Multiply and fold, as in the finalizer of splitmix64.
        mixed = (mixed ^ column) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    _, first, group = np.unique(mixed, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))  # groups in order of their first row
    return np.sort(first), rank[group.reshape(-1)]


def check_separated(stars: UnitVectors, names: Ints, order: Ints) -> None:
    """Refuse directions that are too close to be kept apart.

    Parameters
    ----------
    stars : (M, N, 3) float64
    names : (M,) intp, the caller's number of each star
    order : (M, N) intp, the caller's number of each direction

    Raises
    ------
    PartitionError
        If two directions of a star are less than `LEAST_ANGLE` apart; they are named.
    """
    close = np.flatnonzero((nearest_angles(stars) < LEAST_ANGLE).any(axis=1))
    if len(close):
        star = close[np.argmin(names[close])]
        angles = pairwise_angles(stars[star : star + 1])[0]
        i, j = np.unravel_index(np.argmin(angles), angles.shape)
        pair = sorted(order[star, [i, j]].tolist())
        raise PartitionError(
            f"directions {pair[0]} and {pair[1]} of star {names[star]} are "
            f"{np.degrees(angles[i, j]):.3g}° apart; need at least {np.degrees(LEAST_ANGLE):g}°"
        )
