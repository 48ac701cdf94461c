"""A quarter of a circle as a quintic Bézier curve, and how a cone leaves it.

The quintic has its ends and its end tangents on the circle exactly, the same speed at both ends,
and is off the circle by 1.4e-9 of the radius at most: its three free numbers are those of least
greatest error. (Degree 4 reaches 1e-6 only, degree 6 has nothing to gain that a CAD kernel sees.)
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, read_only
from scaffold_cad.brep.bernstein import bernstein

DEGREE = 5
"""Degree of the arcs and of all patches in both directions."""

_A, _B, _C = 0.31893447147525056, 0.8728511772889636, 0.6304232836547656

ARC: Floats = read_only(
    np.array([[1.0, 0.0], [1.0, _A], [_B, _C], [_C, _B], [_A, 1.0], [0.0, 1.0]])
)
"""Control points of the unit quarter circle from (1, 0) to (0, 1), shape (6, 2)."""

ARC_ERROR = 1.4e-9
"""Greatest distance of the curve from the unit circle."""


def _spread() -> Floats:
    """Return control points G of a curve with G(u) · e(u) = m(u), for the arc e, shape (6, 2).

    Here m falls from 1 to 0 with coefficients 1, 1, 1, 0, 0, 0. Value and derivative at both ends
    are those of m e, and the rest is the least-squares solution.
    """
    at = np.asarray((1 - np.cos(np.linspace(0, np.pi, 65))) / 2)
    basis = bernstein(DEGREE, at)  # (65, 6)
    arc = basis @ ARC  # (65, 2)
    wanted = basis @ np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])  # (65,)
    given = np.zeros((DEGREE + 1, 2))
    given[:2] = ARC[:2]
    missing = wanted - ((basis @ given) * arc).sum(axis=1)
    free = (basis[:, 2:4, None] * arc[:, None]).reshape(len(at), 4)
    given[2:4] = np.linalg.lstsq(free, missing, rcond=None)[0].reshape(2, 2)
    return given


SPREAD: Floats = read_only(_spread())
"""How far a curve G along a cone leaves the axis, where its length along it falls from 1 to 0."""
