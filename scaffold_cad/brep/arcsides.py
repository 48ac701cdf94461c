"""Circles at the sides of spline patches: which parameter of the patch each angle has.

A polynomial runs along a circle to a few parts in 10⁹, but not evenly. The parameter as a function
of the angle is itself as smooth as a polynomial of degree 9.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.brep.analytic import Knots
from scaffold_cad.brep.bernstein import bernstein

DEGREE = 9
"""Degree of the polynomials."""


def arc_parameters(
    control: Floats,
    knots: Knots,
    center: Floats,
    x: Floats,
    y: Floats,
    angles: Floats,
    ends: Floats,
) -> Floats:
    """Return Bernstein coefficients of the parameter as a function of the angle, (m, 10).

    Parameters
    ----------
    control : (m, n, 3) control points of the sides of patches, mm
    knots : their knots
    center, x, y : (m, 3) centers and axes of the circles; angles are counted from x to y
    angles : (m, 2) first and last angle, rad
    ends : (m, 2) parameters there
    """
    nodes = (1 - np.cos((np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1) * np.pi)) / 2
    span, length = np.diff(angles, axis=1), np.diff(ends, axis=1)  # (m, 1)
    wanted = angles[:, :1] + nodes * span  # (m, 10)
    found = ends[:, :1] + nodes * length
    local = control - center[:, None]
    flat = np.stack([np.einsum("mix,mx->mi", local, axis) for axis in (x, y)], axis=2)  # (m, n, 2)
    for _ in range(8):  # Newton steps
        at = found.reshape(-1)
        place, speed = (
            np.einsum("mni,mix->mnx", knots.matrix(at, order).reshape(*found.shape, -1), flat)
            for order in (0, 1)
        )
        angle = np.arctan2(place[..., 1], place[..., 0])
        off = np.mod(angle - wanted + np.pi, 2 * np.pi) - np.pi
        turning = (place[..., 0] * speed[..., 1] - place[..., 1] * speed[..., 0]) / np.square(
            place
        ).sum(axis=2)
        found = np.asarray(found - off / turning, dtype=np.float64)
    coefficients = np.array(np.linalg.solve(bernstein(DEGREE, nodes), found.T).T, np.float64)
    coefficients[:, [0, -1]] = ends
    return coefficients
