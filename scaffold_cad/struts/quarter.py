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


FALL: Floats = read_only(np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]))
"""A quintic that falls from 1 to 0, and is level at both ends, shape (6,)."""


def _companion(turn: float) -> Floats:
    """Return a curve G that is the arc, turned by `turn` rad, times m = `FALL`, shape (6, 2).

    That is so for value and derivative at both ends. Between them its angle to the arc is as it
    must be: its part along e(u) is m cos(turn) in least squares.
    """
    at = np.asarray((1 - np.cos(np.linspace(0, np.pi, 65))) / 2)
    basis = bernstein(DEGREE, at)  # (65, 6)
    arc = basis @ ARC  # (65, 2)
    rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    given = np.zeros((DEGREE + 1, 2))
    given[:2] = ARC[:2] @ rotation
    missing = np.cos(turn) * (basis @ FALL) - ((basis @ given) * arc).sum(axis=1)
    free = (basis[:, 2:4, None] * arc[:, None]).reshape(len(at), 4)
    given[2:4] = np.linalg.lstsq(free, missing, rcond=None)[0].reshape(2, 2)
    return given


OUTWARD: Floats = read_only(_companion(0.0))
"""How far a curve along a cone leaves the axis, where its length along it falls from 1 to 0."""

SIDEWARD: Floats = read_only(_companion(np.pi / 2))
"""How far a curve on a cylinder goes round it, where its speed round it falls from 1 to 0."""
