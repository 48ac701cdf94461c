"""Curves as polylines."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scaffold_cad.base.arrays import Floats, Points

SAGITTA = 1e-3
"""How far an edge may be from its curve, as a fraction of the curve's size."""

FEWEST, MOST = 8, 1024
"""Chords of a curve."""


def flattened(curve: Callable[[Floats], Points]) -> Points:
    """Return points along a curve whose chords are within `SAGITTA` of its size, shape (k, 3).

    Parameters
    ----------
    curve : gives the points, shape (k, 3), at parameters (k,) from 0 to 1
    """
    chords = FEWEST
    while True:
        fine = curve(np.linspace(0.0, 1.0, 2 * chords + 1))
        points, between = fine[::2], fine[1::2]
        size = float(np.linalg.norm(np.ptp(fine, axis=0)))
        off = np.linalg.norm(between - (points[:-1] + points[1:]) / 2, axis=1).max()
        if not off > SAGITTA * size or chords >= MOST:
            return points
        chords *= 2
