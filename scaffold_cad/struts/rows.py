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
from scaffold_cad.struts.quarter import ARC, DEGREE, FALL, OUTWARD, SIDEWARD
from scaffold_cad.struts.system import Layout

LEAST_LENGTH = 0.15
"""Least length of m, in radii of the collar."""

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
    union: Union,
    collars: Collars,
    rings: Rings,
    lengths: tuple[Floats, Floats, Floats],
    layout: Layout,
) -> tuple[Floats, Floats]:
    """Return the row on the collar and the row before it, both (3, M, N, 4, n_u).

    Parameters
    ----------
    lengths : three (M, N, 4) float64
        The wanted m at the corners and in the middle of each quarter, and how fast the curves at
        the corners go round the strut, mm.
    """
    start, end = rings.corners[..., None], np.roll(rings.corners, -1, axis=3)[..., None]
    radii = collars.radii[:, :, None, None]
    last = rings.centers[..., None, None] + radii * (ARC[:, 0] * start + ARC[:, 1] * end)
    corner, middle, turn = lengths
    least = LEAST_LENGTH * collars.radii[:, :, None]
    first = np.maximum(corner, least)  # (M, N, 4)
    second = np.roll(first, -1, axis=2)
    bump = (np.maximum(middle, least) - (first + second) / 2) / _BUMP_HEIGHT
    # On cones the bump has no curve of the same degree.
    bump = np.where(union.slopes[:, :, None] == 0, bump, 0.0)
    bump = np.maximum(bump, -np.minimum(first, second) / 2)
    length = first[..., None] * FALL + second[..., None] * FALL[::-1] + bump[..., None] * _BUMP
    across = union.slopes[:, :, None, None] * _companions(OUTWARD, 1.0, (first, second), start, end)
    turns = turn, np.roll(turn, -1, axis=2)
    across = across + _companions(SIDEWARD, -1.0, turns, start, end)
    derivative = length * union.directions[:, :, :, None, None] + across
    before = last - derivative * (layout.v.step / DEGREE)
    refinement = layout.u.refinement.T
    return last @ refinement, before @ refinement


def _companions(
    curve: Floats, sign: float, sizes: tuple[Floats, Floats], start: Floats, end: Floats
) -> Floats:
    """Return `curve` (6, 2) of the first size and its mirror image of the second, (3, ..., 6)."""
    mirrored = sign * curve[::-1, ::-1]
    first = sizes[0][..., None] * (curve[:, 0] * start + curve[:, 1] * end)
    second = sizes[1][..., None] * (mirrored[:, 0] * start + mirrored[:, 1] * end)
    return np.asarray(first + second)
