"""Families of random stars that are hard in different ways."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Random = np.random.Generator
Stars = NDArray[np.float64]

LEAST_ANGLE = np.radians(0.02)
"""No two directions of a star are closer, rad."""
CLOSE_PAIR = np.radians(1.0)


def uniform(random: Random, count: int, valency: int) -> Stars:
    """Return directions spread evenly over the sphere, shape (count, valency, 3)."""
    return _unit(random.normal(size=(count, valency, 3)))


def clustered(random: Random, count: int, valency: int) -> Stars:
    """Return directions within some 15 degrees of one of three."""
    centers = uniform(random, count, 3)
    chosen = random.integers(3, size=(count, valency))
    near = centers[np.arange(count)[:, None], chosen]
    return _unit(near + 0.25 * random.normal(size=(count, valency, 3)))


def coplanar(random: Random, count: int, valency: int) -> Stars:
    """Return directions in a plane at any angle, exact but for rounding."""
    angles = random.uniform(0, 2 * np.pi, (count, valency, 1))
    x, y = np.moveaxis(uniform(random, count, 2), 1, 0)
    y = _unit(y - (x * y).sum(axis=1, keepdims=True) * x)
    return np.asarray(np.cos(angles) * x[:, None] + np.sin(angles) * y[:, None])


def flattened(random: Random, count: int, valency: int) -> Stars:
    """Return directions within some 3 degrees of a plane."""
    return _unit(uniform(random, count, valency) * [1.0, 1.0, 0.05])


def hemispherical(random: Random, count: int, valency: int) -> Stars:
    """Return directions in one half of the sphere: their hull is far from the center."""
    stars = uniform(random, count, valency)
    stars[..., 2] = np.abs(stars[..., 2])
    return stars


def narrow(random: Random, count: int, valency: int) -> Stars:
    """Return directions within some 20 degrees of one."""
    return _unit([0.0, 0.0, 1.0] + 0.3 * random.normal(size=(count, valency, 3)))


def paired(random: Random, count: int, valency: int) -> Stars:
    """Return even directions, two of them one degree apart."""
    stars = uniform(random, count, valency)
    beside = _unit(np.cross(stars[:, 0], stars[:, -1]))
    stars[:, 1] = np.cos(CLOSE_PAIR) * stars[:, 0] + np.sin(CLOSE_PAIR) * beside
    return stars


FAMILIES: dict[str, Callable[[Random, int, int], Stars]] = {
    "uniform": uniform,
    "clustered": clustered,
    "coplanar": coplanar,
    "flattened": flattened,
    "hemispherical": hemispherical,
    "narrow": narrow,
    "paired": paired,
}


def drawn(family: str, random: Random, count: int, valency: int) -> Stars:
    """Return stars of a family, those drawn again that have two directions almost in line."""
    draw = FAMILIES[family]
    stars = draw(random, count, valency)
    while True:
        # The chord: an arc cosine of the dot product knows no angle under 1e-8.
        apart = stars[:, :, None] - stars[:, None]
        chords = np.sqrt((apart**2).sum(axis=-1)) + 2 * np.eye(valency)
        tight = chords.min(axis=(1, 2)) < LEAST_ANGLE
        if not tight.any():
            return stars
        stars[tight] = draw(random, int(tight.sum()), valency)


def _unit(vectors: Stars) -> Stars:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
