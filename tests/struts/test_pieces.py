"""Convex pieces of round struts."""

from __future__ import annotations

import numpy as np

from scaffold_cad.struts.blending.splines import spline
from scaffold_cad.struts.pieces import slicing


def test_slices_together_are_the_curve() -> None:
    curve = spline(2)
    control = np.random.default_rng(2).normal(size=(curve.count, 3))
    pieces = slicing(4, curve) @ control  # (4, d + 1, 3)
    for number, piece in enumerate(pieces):
        ends = curve.values_at(np.array([number, number + 1]) / 4) @ control
        np.testing.assert_allclose(piece[[0, -1]], ends, atol=1e-12)
