"""The partition that always exists: lunes between meridians.

Around an axis on which no direction lies and which sees all of them at different longitudes,
the two poles and, between consecutive longitudes, one vertex on the equator make N quads
(pole, m_{i-1}, antipole, m_i). Each is a lune cut at the middle of its sides, and is star-shaped
around its direction because both meridians are less than π away in longitude. It is the fallback of
all methods: every star of distinct directions has one.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import any_perpendicular, dot, normalize
from scaffold_cad.partition.star import nearest_angles

AXES = 96
"""Axes tried for each star, spread evenly over half the sphere."""
LONGITUDE_BYTES = 128
"""What a longitude takes where it is looked at."""


def lune_partitions(stars: UnitVectors) -> tuple[UnitVectors, Ints]:
    """Return vertices (M, N + 2, 3) and quads (M, N, 4) of the best lune partition found.

    The best of the axes tried is the one of the largest relative clearance.

    Parameters
    ----------
    stars : (M, N, 3) float64, unit vectors, distinct within each star
    """
    reach = nearest_angles(stars) / 2
    vertices = np.empty((len(stars), stars.shape[1] + 2, 3))
    quads = np.empty((*stars.shape[:2], 4), dtype=np.intp)
    for block in blocks(len(stars), AXES * stars.shape[1] * LONGITUDE_BYTES):
        axes = _best_axes(stars[block], reach[block])
        vertices[block], quads[block] = lunes_about(axes, stars[block], reach[block])
    return vertices, quads


def lunes_about(axes: UnitVectors, stars: UnitVectors, reach: Floats) -> tuple[UnitVectors, Ints]:
    """Return vertices and quads of the lune partitions of `stars` about `axes` (M, 3).

    The vertices are the meridians' middles in order of longitude, the pole and the antipole.

    Parameters
    ----------
    axes : (M, 3) float64, unit vectors
    stars : (M, N, 3) float64, unit vectors
    reach : (M, N) float64, half the angle to the nearest neighbor, rad
    """
    valency = stars.shape[1]
    east = any_perpendicular(axes)
    north = np.cross(axes, east)
    longitude, weight = _longitudes(east[:, None], north[:, None], stars, reach)
    order = np.argsort(longitude, axis=1, kind="stable")
    longitude = np.take_along_axis(longitude, order, axis=1)
    ahead, _ = _meridians(longitude, np.take_along_axis(weight, order, axis=1))
    meridian = (longitude + ahead)[..., None]
    equator = np.cos(meridian) * east[:, None] + np.sin(meridian) * north[:, None]
    vertices = np.concatenate([equator, axes[:, None], -axes[:, None]], axis=1)

    place = np.arange(valency)
    lunes = np.stack(
        [np.full(valency, valency), place - 1, np.full(valency, valency + 1), place], axis=1
    )
    lunes[0, 1] = valency - 1
    quads = np.empty((*stars.shape[:2], 4), dtype=np.intp)
    np.put_along_axis(quads, order[..., None], lunes[None], axis=1)
    return vertices, quads


def _best_axes(stars: UnitVectors, reach: Floats) -> UnitVectors:
    """Return the axis of the largest relative clearance among those tried, shape (M, 3)."""
    axes = _candidate_axes(stars)  # (M, K, 3)
    east = any_perpendicular(axes)
    north = np.cross(axes, east)
    longitude, weight = _longitudes(
        east[:, :, None], north[:, :, None], stars[:, None], reach[:, None]
    )
    order = np.argsort(longitude, axis=2, kind="stable")
    longitude = np.take_along_axis(longitude, order, axis=2)
    _, clearance = _meridians(longitude, np.take_along_axis(weight, order, axis=2))
    best = np.argmax(clearance.min(axis=2), axis=1)
    chosen: UnitVectors = axes[np.arange(len(stars)), best]
    return chosen


def circle_axes(stars: UnitVectors) -> UnitVectors:
    """Return the axis of the circle that comes nearest to all directions of each star, (M, 3).

    For three directions, or coplanar ones, it is at the same angle to each: the meridians of
    lunes about it bisect the angles between neighbors, which nothing can better.
    """
    spread = stars - stars.mean(axis=1, keepdims=True)
    _, frames = np.linalg.eigh(np.einsum("mni,mnj->mij", spread, spread))
    axes: UnitVectors = frames[:, :, 0]
    return axes


def _candidate_axes(stars: UnitVectors) -> UnitVectors:
    """Return the circle's axis, the principal axes, and others spread evenly, (M, K, 3).

    They turn with the star.
    """
    _, frames = np.linalg.eigh(np.einsum("mni,mnj->mij", stars, stars))
    frames = np.swapaxes(frames, 1, 2)  # rows are the axes, the least first
    # Sides chosen by the star itself, so that they do not depend on the eigenvector's sign.
    skew = (np.einsum("mni,mki->mkn", stars, frames) ** 3).sum(axis=2)
    frames = np.where(skew[..., None] < 0, -frames, frames)
    height = (np.arange(AXES) + 0.5) / AXES
    angle = np.pi * (3 - np.sqrt(5)) * np.arange(AXES)  # golden spiral
    radius = np.sqrt(1 - height**2)
    spiral = np.stack([height, radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return np.concatenate([circle_axes(stars)[:, None], frames, normalize(spiral @ frames)], axis=1)


def _longitudes(
    east: UnitVectors, north: UnitVectors, stars: UnitVectors, reach: Floats
) -> tuple[Floats, Floats]:
    """Return longitude (rad) and sin(colatitude) / sin(reach) of each direction, both (..., N)."""
    x, y = dot(stars, east), dot(stars, north)
    return np.arctan2(y, x), np.hypot(x, y) / np.sin(reach)


def _meridians(longitude: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Return how far ahead of each longitude the next meridian runs, and its clearance, (..., N).

    The meridian lies where w_i sin α = w_j sin(gap − α), so that both neighbors have the same
    relative clearance from it, unless one of them reaches its best, at π / 2, before that. It is
    less than π from both.
    """
    gap = np.roll(longitude, -1, axis=-1) - longitude
    gap[..., -1] += 2 * np.pi
    other = np.roll(weight, -1, axis=-1)
    ahead = np.arctan2(other * np.sin(gap), weight + other * np.cos(gap)) % np.pi
    best, best_of_other = np.pi / 2, gap - np.pi / 2
    ahead = np.clip(ahead, np.minimum(best, best_of_other), np.maximum(best, best_of_other))
    return ahead, np.minimum(weight * np.sin(ahead), other * np.sin(gap - ahead))
