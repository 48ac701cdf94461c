"""The given rows of a node's patches: the collar's quarter circles, and the generators beside them.

The derivative across the collar is m(u) (P + s e(u)): along the generators of the cone, so that
the patch meets it with the same tangent planes. Its length m follows the patches' own lengths;
its derivative by u is 0 at the corners, where neighbors must agree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen
from scaffold_cad.struts.collars import Collars
from scaffold_cad.struts.distances import Union
from scaffold_cad.struts.quarter import ARC, DEGREE, SPREAD

LEAST_LENGTH = 0.15
"""Least length of m, in radii of the collar."""

_FALL = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
_BUMP = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
_BUMP_HEIGHT = 0.625
"""Value of the polynomial with coefficients `_BUMP` in the middle."""


@dataclass(frozen=True, eq=False)
class Rings(Frozen):
    """Collars with the corners of their quarters. Coordinates come first."""

    centers: Floats
    """Center of each collar, shape (3, M, N)."""
    corners: Floats
    """Unit vectors across the axis to the start of each quarter, shape (3, M, N, 4)."""


def rings(union: Union, collars: Collars, frame_x: Floats, frame_y: Floats, phase: Floats) -> Rings:
    """Return the rings whose first quarter starts at `phase` (M, N) from `frame_x` (3, M, N)."""
    angle = phase[..., None] + np.arange(4) * (np.pi / 2)
    corners = np.cos(angle) * frame_x[..., None] + np.sin(angle) * frame_y[..., None]
    return Rings(union.directions * collars.distances, corners)


def given_rows(
    union: Union, collars: Collars, rings: Rings, lengths: Floats, middles: Floats
) -> tuple[Floats, Floats]:
    """Return the row on the collar and the row before it, both (3, M, N, 4, D + 1).

    Parameters
    ----------
    lengths : (M, N, 4) float64, wanted m at the corners, mm
    middles : (M, N, 4) float64, wanted m in the middle of each quarter, mm
    """
    start, end = rings.corners[..., None], np.roll(rings.corners, -1, axis=3)[..., None]
    radii = collars.radii[:, :, None, None]
    last = rings.centers[..., None, None] + radii * (ARC[:, 0] * start + ARC[:, 1] * end)
    least = LEAST_LENGTH * collars.radii[:, :, None]
    first_length = np.maximum(lengths, least)  # (M, N, 4)
    next_length = np.roll(first_length, -1, axis=2)
    bump = (np.maximum(middles, least) - (first_length + next_length) / 2) / _BUMP_HEIGHT
    # On cones the bump has no curve of the same degree.
    bump = np.where(union.slopes[:, :, None] == 0, bump, 0.0)
    floor = np.minimum(first_length, next_length) / 2 - np.minimum(first_length, next_length)
    bump = np.maximum(bump, floor)
    length = (
        first_length[..., None] * _FALL
        + next_length[..., None] * _FALL[::-1]
        + bump[..., None] * _BUMP
    )
    axes = union.directions[:, :, :, None, None]
    across = first_length[..., None] * (SPREAD[:, 0] * start + SPREAD[:, 1] * end)
    across = across + next_length[..., None] * (SPREAD[::-1, 1] * start + SPREAD[::-1, 0] * end)
    derivative = length * axes + union.slopes[:, :, None, None] * across
    return last, last - derivative / DEGREE
