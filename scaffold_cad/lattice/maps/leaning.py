"""Directions in which a layer on quads rises, leaned where its cells would fold."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Points, Quads, UnitVectors
from scaffold_cad.base.vectors import normalize, sums_by_row, triple

LEAST_VOLUME = 0.02
"""Volume at the corner of a cell below which it counts as folded, in the mean of its corners."""

ROUNDS = 60
"""How often directions around folded cells are evened at most."""


def leaned(
    vertices: Points, quads: Quads, directions: UnitVectors, low: Floats, high: Floats
) -> UnitVectors:
    """Return directions (v, 3) at the vertices of quads under which few cells fold, none if found.

    Beside a sharp edge the layer is narrower than the surface, and quads there have room only if
    those beside them give way: around folded cells each direction becomes the mean of its
    neighbors', again and again. Others stay.

    Parameters
    ----------
    vertices, quads : (v, 3) float64, mm, and (f, 4) intp
    directions : (v, 3), normals of the surface
    low, high : heights of the layer's bottom and top at the vertices, (v,), mm
    """
    ends = np.concatenate([quads.reshape(-1), np.roll(quads, 1, axis=1).reshape(-1)])
    others = np.concatenate([np.roll(quads, 1, axis=1).reshape(-1), quads.reshape(-1)])
    best, fewest = directions, len(quads) + 1
    for _ in range(ROUNDS):
        folded = _folded(vertices, quads, directions, low, high)
        count = int(folded.sum())
        if count < fewest:
            best, fewest = directions, count
        if count == 0:
            break
        near = np.zeros(len(vertices), dtype=np.bool_)
        near[quads[folded]] = True
        around = sums_by_row(directions[others], ends, len(vertices))
        directions = np.where(near[:, None], normalize(directions + normalize(around)), directions)
    return best


def _folded(
    vertices: Points, quads: Quads, directions: UnitVectors, low: Floats, high: Floats
) -> Bools:
    """Return which quads have a cell with a corner that is inside out, (f,)."""
    bottom = (vertices + low[:, None] * directions)[quads]  # (f, 4, 3)
    top = (vertices + high[:, None] * directions)[quads]
    up = (top - bottom) * np.sign(high - low)[quads][..., None]
    volumes = np.concatenate(
        [
            triple(np.roll(one, -1, axis=1) - one, np.roll(one, 1, axis=1) - one, up)
            for one in (bottom, top)
        ],
        axis=1,
    )  # (f, 8)
    folded: Bools = volumes.min(axis=1) < LEAST_VOLUME * np.abs(volumes).mean(axis=1)
    return folded
