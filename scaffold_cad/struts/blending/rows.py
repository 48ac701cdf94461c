"""The given rows of a node's patches: the collar's quarter circles, and the generators beside them.

The derivative across the collar is m(u) (P + s e(u)): along the generators of the cone, so that
the patch meets it with the same tangent planes. Its length m follows the patches' own lengths;
its derivative by u is 0 at the corners, where neighbors must agree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.blending.collars import Collars
from scaffold_cad.struts.blending.distances import Union
from scaffold_cad.struts.blending.layouts import Layout
from scaffold_cad.struts.blending.quarter import ARC, DEGREE, OUTWARD, OUTWARD_SLOPE

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
    lengths: tuple[Floats, Floats],
    shares: Floats,
    layout: Layout,
) -> tuple[Floats, Floats]:
    """Return the row on the collar and the row before it, both (3, M, N, 4, n_u).

    Parameters
    ----------
    lengths : two (M, N, 4) float64
        The wanted m at the corners and in the middle of each quarter, mm.
    shares : (M, N, 4) float64
        What tangents along the spoke of each corner have of it at its vertex: α = share (1 − v).
        On the collar the derivative across it turns off by that share at corners.
    """
    start, end = rings.corners[..., None], np.roll(rings.corners, -1, axis=3)[..., None]
    radii = collars.radii[:, :, None, None]
    last = rings.centers[..., None, None] + radii * (ARC[:, 0] * start + ARC[:, 1] * end)
    corner, middle = lengths
    least = LEAST_LENGTH * collars.radii[:, :, None]
    first = np.maximum(corner, least)  # (M, N, 4)
    second = np.roll(first, -1, axis=2)
    half = shares[..., None] / 2, np.roll(shares, -1, axis=-1)[..., None] / 2
    fades = [OUTWARD.fade + each * OUTWARD_SLOPE.fade for each in half]  # (M, N, 4, 6)
    length = first[..., None] * fades[0] + second[..., None] * fades[1][..., ::-1]
    wanted = np.maximum(middle, least)
    bump = _bump(length, wanted, least)
    # On cones the bump has no curve of the same degree.
    bump = np.where(union.slopes[:, :, None] == 0, bump, 0.0)
    length = length + bump[..., None] * _BUMP
    outward = [OUTWARD.curve + each[..., None] * OUTWARD_SLOPE.curve for each in half]
    across = _both(outward, (first, second), start, end)
    derivative = length * union.directions[:, :, :, None, None]
    derivative += union.slopes[:, :, None, None] * across
    before = last - derivative * (layout.v.step / DEGREE)
    refinement = layout.u.refinement.T
    return last @ refinement, before @ refinement


def _bump(length: Floats, wanted: Floats, least: Floats) -> Floats:
    """Return how much of `_BUMP` brings m in the middle to `wanted`, or near it, (M, N, 4).

    As much as leaves m no less than half of `least` anywhere.
    """
    at = np.linspace(0, 1, 17)
    basis = bernstein(DEGREE, at)
    values, shape = length @ basis.T, basis @ _BUMP  # (M, N, 4, 17), (17,)
    bump = (wanted - values[..., 8]) / _BUMP_HEIGHT
    room = (values[..., 1:-1] - least[..., None] / 2) / shape[1:-1]
    return np.asarray(np.maximum(bump, -np.maximum(room.min(axis=-1), 0.0)))


def _both(curves: list[Floats], sizes: tuple[Floats, Floats], start: Floats, end: Floats) -> Floats:
    """Return a curve (M, N, 4, 6, 2) of a size and the mirror image of another, (3, M, N, 4, 6)."""
    here, there = curves[0], curves[1][..., ::-1, ::-1]
    first = sizes[0][..., None] * (here[..., 0] * start + here[..., 1] * end)
    second = sizes[1][..., None] * (there[..., 0] * start + there[..., 1] * end)
    return np.asarray(first + second)
