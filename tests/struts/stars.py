"""Stars of struts that tests are made of."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.partition import partition_spheres
from scaffold_cad.struts import Stars
from scaffold_cad.struts.blending.bends import bend_partitions

TRIPOD = np.eye(3)
TEE = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0]])
CUBIC = np.concatenate([np.eye(3), -np.eye(3)])
BODY_CENTERED = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
FAN = np.array([[0.0, 0, 1], [0.5, 0, 0.87], [-0.2, 0.46, 0.87], [-0.2, -0.46, 0.87]])
FIVE_TUBES = np.array(
    [[1, 0, 0], [-0.3, 0, 1], [0.7, 0, -0.8], [-0.8, 0.35, -0.2], [-0.8, -0.35, -0.2]]
)


def random_stars(
    count: int, valency: int, least_angle: float, rng: np.random.Generator
) -> UnitVectors:
    """Return random directions (count, valency, 3), no two nearer than `least_angle` (degrees)."""
    most = np.cos(np.radians(least_angle))
    found: list[UnitVectors] = []
    total = 0
    while total < count:
        batch = np.zeros((4000, valency, 3))
        open_rows = np.ones(len(batch), dtype=np.bool_)
        for strut in range(valency):
            waiting = open_rows.copy()
            for _ in range(60):
                tried = normalize(rng.normal(size=(len(batch), 3)))
                nearest = np.einsum("mjx,mx->mj", batch[:, :strut], tried)
                fits = waiting & (nearest < most).all(axis=1)
                batch[fits, strut] = tried[fits]
                waiting &= ~fits
            open_rows &= ~waiting
        found.append(batch[open_rows])
        total += len(found[-1])
    return np.concatenate(found)[:count]


def stars_of(
    directions: UnitVectors,
    radii: Floats | float = 1.0,
    *,
    blends: Floats | float = 0.6,
    slopes: Floats | float = 0.0,
    balls: Floats | float = 0.0,
    most: Floats | float = np.inf,
) -> Stars:
    """Return stars with partitions around `directions`, (M, N, 3) or those of one node, (N, 3)."""
    unit = normalize(np.asarray(directions, dtype=np.float64).reshape(-1, *directions.shape[-2:]))
    make = bend_partitions if unit.shape[1] == 2 else partition_spheres
    return Stars.of(make(unit), radii=radii, blends=blends, slopes=slopes, balls=balls, most=most)
