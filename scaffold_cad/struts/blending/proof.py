"""The proof that a node's surface is star-shaped around its node, hence free of folds.

On a patch S the function S · (S_u × S_v) is a polynomial of degree 3 D − 1 in u and in v. If all
its Bernstein coefficients are positive so is the function, and the patch is seen from the node
from one side only, once from each direction nearby. Where some are not, the patch is cut at the
middle in both directions and its parts are looked at, a few times over. A closed surface of such
patches and of the collars' discs covers the sphere of directions a whole number of times; once,
if its solid angles add up to 4 π.

The coefficients come from values at points. With ε the rounding unit, c, a and b the greatest
lengths of control points and of their differences by u and by v, times D: S is off by 15 ε c at
most, S_u and S_v by 15 ε 2 D c (two sums of six, and the basis, whose slopes add up to 2 D), and
the triple product by what these make of c a b, and 15 ε c a b of its own. What takes values to
coefficients enlarges that by its norm. Cutting adds less: its matrices are off by ε times the root
of that norm. Coefficients count as positive only beyond that bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.vectors import dot, leading_dot
from scaffold_cad.brep.bernstein import bernstein
from scaffold_cad.struts.blending.quarter import DEGREE

TOP = 3 * DEGREE - 1
"""Degree of S · (S_u × S_v) in either direction."""
DEPTH = 6
"""How often patches are halved before the proof is given up."""
ROUNDING = 15 * np.finfo(np.float64).eps
"""Relative error of a point from its control points, and of a triple product."""
PATCH_BYTES = 4096
"""What a patch takes where it is looked at."""

_AT = (1 - np.cos((np.arange(TOP + 1) + 0.5) * np.pi / (TOP + 1))) / 2
_VALUES, _SLOPES = bernstein(DEGREE, _AT), bernstein(DEGREE, _AT, 1)
_TO_BERNSTEIN = np.linalg.inv(bernstein(TOP, _AT))
_NORM = float(np.abs(_TO_BERNSTEIN).sum(axis=1).max()) ** 2
_HALVES = tuple(bernstein(TOP, _AT / 2 + shift) for shift in (0.0, 0.5))
_CUT = tuple(_TO_BERNSTEIN @ half for half in _HALVES)


@dataclass(frozen=True, eq=False)
class Proof(Frozen):
    """What is known of M nodes."""

    is_star_shaped: Bools
    """Whether S · (S_u × S_v) > 0 on all patches is proved, shape (M,)."""
    solid_angle: Floats
    """Sum of the solid angles of patches and collar discs, steradian, shape (M,)."""
    least_cosine: Floats
    """Least cosine between normals and directions from the node at samples, shape (M,)."""

    @property
    def proved(self) -> Bools:
        """Whether each surface covers the sphere of directions once, shape (M,)."""
        return np.asarray(self.is_star_shaped & (np.abs(self.solid_angle - 4 * np.pi) < 1.0))


def prove(control: Floats, collar_distances: Floats, collar_radii: Floats) -> Proof:
    """Return what is known of M nodes.

    Parameters
    ----------
    control : (M, 4 N, D + 1, D + 1, 3) float64, relative to the node
    collar_distances, collar_radii : (M, N) float64, of the discs that close the surface
    """
    slant = np.hypot(collar_distances, collar_radii)
    discs = 2 * np.pi * (1 - collar_distances / slant)
    return prove_around(control, discs.sum(axis=1))


def prove_around(control: Floats, discs: Floats) -> Proof:
    """Return what is known of M nodes around points of which each may be any but on the surface.

    Parameters
    ----------
    control : (M, 4 N, D + 1, D + 1, 3) float64, relative to the point
    discs : (M,) float64, solid angle of the discs that close the surface, seen from there, sr
    """
    nodes, count = control.shape[:2]
    patches = control.reshape(-1, *control.shape[2:])
    positive = np.empty(len(patches), dtype=np.bool_)
    angle, cosine = np.empty(len(patches)), np.empty(len(patches))
    for block in blocks(len(patches), PATCH_BYTES, CACHE):
        positive[block], angle[block], cosine[block] = _patches(patches[block])
    total = angle.reshape(nodes, count).sum(axis=1) + discs
    least = cosine.reshape(nodes, count).min(axis=1)
    proved = np.asarray(positive.reshape(nodes, count).all(axis=1))
    return Proof(proved, total, least)


def _patches(control: Floats) -> tuple[Bools, Floats, Floats]:
    """Return whether each patch is proved, its solid angle and its least cosine, all (k,)."""
    points = np.ascontiguousarray(control.transpose(3, 0, 1, 2))  # (3, k, D + 1, D + 1)
    along_v = points @ _VALUES.T
    surface = _VALUES @ along_v  # (3, k, TOP + 1, TOP + 1)
    slope_u = _SLOPES @ along_v
    slope_v = _VALUES @ (points @ _SLOPES.T)
    normals = _cross(slope_u, slope_v)
    values = leading_dot(surface, normals)
    size = np.sqrt(leading_dot(surface, surface))
    across = np.sqrt(np.maximum(leading_dot(normals, normals), 1e-300))
    cosine = (values / (size * across)).min(axis=(1, 2))
    angle = _WEIGHTS @ (values / (size * size * size)) @ _WEIGHTS
    coefficients = _TO_BERNSTEIN @ values @ _TO_BERNSTEIN.T
    return _positive(coefficients, _margins(control)), np.asarray(angle), cosine


def _margins(control: Floats) -> Floats:
    """Return the bound of the coefficients' rounding errors of each patch, (k,)."""
    size = np.sqrt(dot(control, control)).max(axis=(1, 2))
    steps_u, steps_v = np.diff(control, axis=1), np.diff(control, axis=2)
    most_u = DEGREE * np.sqrt(dot(steps_u, steps_u)).max(axis=(1, 2))
    most_v = DEGREE * np.sqrt(dot(steps_v, steps_v)).max(axis=(1, 2))
    product = size * most_u * most_v
    slopes = 2 * DEGREE * size**2 * (most_u + most_v)
    margins: Floats = ROUNDING * _NORM * (3 * product + slopes)
    return margins


def _positive(coefficients: Floats, margins: Floats) -> Bools:
    """Return whether polynomials with `coefficients` (k, n, n) are proved positive, (k,)."""
    proved = np.ones(len(coefficients), dtype=np.bool_)
    owner = np.arange(len(coefficients))
    for depth in range(DEPTH + 1):
        lowest = coefficients.min(axis=(1, 2))
        doubtful = np.flatnonzero(lowest <= margins[owner])
        if len(doubtful) == 0:
            break
        coefficients, owner = coefficients[doubtful], owner[doubtful]
        corners = coefficients[:, ::TOP, ::TOP].min(axis=(1, 2))
        lost = owner[corners <= margins[owner]]
        proved[lost if depth < DEPTH else owner] = False
        kept = proved[owner]
        coefficients, owner = coefficients[kept], owner[kept]
        coefficients = np.concatenate([one @ coefficients @ two.T for one in _CUT for two in _CUT])
        owner = np.tile(owner, 4)
    return proved


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of vectors whose coordinates come first."""
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def _quadrature() -> Floats:
    """Return the weights with which values at `_AT` give integrals of polynomials, (n,)."""
    moments = np.full(TOP + 1, 1 / (TOP + 1))  # each Bernstein polynomial has the same integral
    weights: Floats = moments @ _TO_BERNSTEIN
    return weights


_WEIGHTS = _quadrature()
