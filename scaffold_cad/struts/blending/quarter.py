"""A quarter of a circle as a quintic Bézier curve, and how a cone leaves it.

The quintic has its ends and its end tangents on the circle exactly, the same speed at both ends,
and is off the circle by 1.4e-9 of the radius at most: its three free numbers are those of least
greatest error. (Degree 4 reaches 1e-6 only, degree 6 has nothing to gain that a CAD kernel sees.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, read_only
from scaffold_cad.brep.bernstein import bernstein

DEGREE = 5
"""Degree of the arcs and of all patches in both directions."""

# `python -m tests.benchmarks.quarter` makes these numbers.
_A, _B, _C = 0.31893447147525056, 0.8728511772889636, 0.6304232836547656

ARC: Floats = read_only(
    np.array([[1.0, 0.0], [1.0, _A], [_B, _C], [_C, _B], [_A, 1.0], [0.0, 1.0]])
)
"""Control points of the unit quarter circle from (1, 0) to (0, 1), shape (6, 2)."""

ARC_ERROR = 1.4e-9
"""Greatest distance of the curve from the unit circle."""


@dataclass(frozen=True, eq=False)
class Companion(Frozen):
    """A curve G that fades out beside the arc e: G(u) · e(u) = m(u).

    Its value and its first derivative at both ends are those of m e. Between them G and m are
    those for which the equation holds in least squares.
    """

    curve: Floats
    """Control points, shape (6, 2)."""
    fade: Floats
    """Coefficients of m, shape (6,)."""


def companion(value: float, slope: float) -> Companion:
    """Return the companion whose m begins with `value` and `slope`."""
    at = np.asarray((1 - np.cos(np.linspace(0, np.pi, 65))) / 2)
    basis = bernstein(DEGREE, at)  # (65, 6)
    arc = basis @ ARC  # (65, 2)
    curve, fade = np.zeros((DEGREE + 1, 2)), np.zeros(DEGREE + 1)
    fade[:2] = value, value + slope / DEGREE
    curve[:2] = fade[:2, None] * ARC[0] + value * (ARC[:2] - ARC[0])
    missing = basis @ fade - ((basis @ curve) * arc).sum(axis=1)
    free = (basis[:, 2:4, None] * arc[:, None]).reshape(len(at), 4)
    unknown = np.concatenate([free, -basis[:, 2:4]], axis=1)
    found = np.linalg.lstsq(unknown, missing, rcond=1e-12)[0]
    curve[2:4] = found[:4].reshape(2, 2)
    fade[2:4] = found[4:]
    return Companion(curve, fade)


OUTWARD, OUTWARD_SLOPE = companion(1.0, 0.0), companion(0.0, -1.0)
"""How curves along a cone leave the axis: error 1.5e-9 and 1e-8 of their length."""
