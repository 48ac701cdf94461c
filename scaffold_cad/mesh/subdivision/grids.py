"""Grids: the parts of quads that are cut in four again and again, in rows and columns."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints


def grid_places(levels: int) -> Ints:
    """Return where the corners of a quad's parts are on its grid, (4^levels, 4, 2).

    The parts are in the order of `Connectivity.subdivided`. Corner 0 of the quad is at [0, 0],
    corner 1 at [2^levels, 0].
    """
    places = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]]])
    for _ in range(levels):
        corner = 2 * places
        ahead = places + np.roll(places, -1, axis=1)
        middle = np.broadcast_to(places.sum(axis=1, keepdims=True) // 2, places.shape)
        before = np.roll(ahead, 1, axis=1)
        places = np.stack([corner, ahead, middle, before], axis=2).reshape(-1, 4, 2)
    return places


def as_grids(corners: Floats, levels: int) -> Floats:
    """Return what `corners` of the parts of quads are, on a grid a quad.

    Parameters
    ----------
    corners : (f · 4^levels, 4, 3) float64, of the parts in the order of `Connectivity.subdivided`

    Returns
    -------
    (f, 2^levels + 1, 2^levels + 1, 3) float64
    """
    places = grid_places(levels)
    count = 2**levels + 1
    grids = np.empty((len(corners) // 4**levels, count, count, 3))
    grids[:, places[..., 0], places[..., 1]] = corners.reshape(-1, *places.shape[:2], 3)
    return grids
