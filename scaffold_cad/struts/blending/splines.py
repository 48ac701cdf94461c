"""Quintic splines over [0, 1] with equal pieces, and their pieces in Bézier form."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen
from scaffold_cad.brep.bernstein import bernstein, gram
from scaffold_cad.struts.blending.quarter import DEGREE

SMOOTHNESS = 2
"""Derivatives that agree where two pieces meet."""


@dataclass(frozen=True, eq=False)
class Spline(Frozen):
    """The clamped splines of degree D with `pieces` equal pieces."""

    pieces: int
    """Number of pieces."""

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return DEGREE + 1 + (self.pieces - 1) * (DEGREE - SMOOTHNESS)

    @property
    def step(self) -> float:
        """Length of a piece: the derivative at an end is D / step times the last difference."""
        return 1 / self.pieces

    @cached_property
    def extraction(self) -> Floats:
        """What takes coefficients to Bézier coefficients, (pieces, D + 1, count)."""
        at = (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)
        to_bezier = np.linalg.inv(bernstein(DEGREE, at))
        values = _basis(self.knots, (at + np.arange(self.pieces)[:, None]) / self.pieces)
        return np.asarray(to_bezier @ values)

    @cached_property
    def refinement(self) -> Floats:
        """What takes Bézier coefficients over [0, 1] to those of this spline, (count, D + 1)."""
        at = (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1)
        to_bezier = np.linalg.inv(bernstein(DEGREE, at))
        whole = (at + np.arange(self.pieces)[:, None]) / self.pieces
        parts = to_bezier @ np.stack([bernstein(DEGREE, each) for each in whole])
        wide = self.extraction.reshape(-1, self.count)
        return np.asarray(np.linalg.lstsq(wide, parts.reshape(len(wide), -1), rcond=None)[0])

    @cached_property
    def knots(self) -> Floats:
        """Knots, each as often as it counts, shape (count + D + 1,)."""
        inner = np.repeat(np.arange(1, self.pieces) / self.pieces, DEGREE - SMOOTHNESS)
        return np.concatenate([np.zeros(DEGREE + 1), inner, np.ones(DEGREE + 1)])

    @property
    def middles(self) -> Floats:
        """Where each coefficient counts, in [0, 1]: the means of D knots, shape (count,)."""
        sums = np.cumsum(self.knots)
        return np.asarray((sums[DEGREE:-1] - sums[: -DEGREE - 1]) / DEGREE)

    def values(self, at: Floats, order: int = 0) -> Floats:
        """Return derivatives of the basis at `at` (n,) of each piece, (pieces n, count)."""
        basis = bernstein(DEGREE, at, order) / self.step**order @ self.extraction
        return np.asarray(basis.reshape(-1, self.count))

    def values_at(self, at: Floats, order: int = 0) -> Floats:
        """Return derivatives of the basis at parameters `at` (n,) in [0, 1], (n, count)."""
        piece = np.minimum((at * self.pieces).astype(np.intp), self.pieces - 1)
        basis = bernstein(DEGREE, at * self.pieces - piece, order) / self.step**order
        return np.asarray(np.einsum("ni,nij->nj", basis, self.extraction[piece]))

    def products(self, order: int) -> Floats:
        """Return the integrals of products of derivatives of `order`, (count, count)."""
        scale = self.step ** (1 - 2 * order)
        block = scale * gram(DEGREE, order)
        return np.asarray(np.einsum("pai,ab,pbj->ij", self.extraction, block, self.extraction))


@lru_cache
def spline(pieces: int) -> Spline:
    """Return the splines with a number of pieces."""
    return Spline(pieces)


def _basis(knots: Floats, at: Floats) -> Floats:
    """Return the B-splines at `at` (...), by the recurrence of Cox and de Boor, (..., count)."""
    at = at[..., None]
    basis = ((knots[:-1] <= at) & (at < knots[1:])).astype(np.float64)
    for degree in range(1, DEGREE + 1):
        width = knots[degree:] - knots[:-degree]
        width = np.where(width > 0, width, np.inf)
        up = (at - knots[: -degree - 1]) / width[:-1] * basis[..., :-1]
        down = (knots[degree + 1 :] - at) / width[1:] * basis[..., 1:]
        basis = up + down
    return np.asarray(basis)
