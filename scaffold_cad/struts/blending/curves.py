"""The condition that two patches meet smoothly along a curve, and all that satisfy it.

Two patches f and g meet smoothly along their common curve e if D_v f + D_v g = α e', with both
derivatives taken away from the curve, and α of degree 2 with the coefficients 2 cos(2π/n₀), 0,
−2 cos(2π/n₁), where n₀ and n₁ patches meet at the ends: it is linear, and corners on the collar,
where 4 patches meet, agree with any given rows.

The condition is one on e and on the sum of the rows on either side of it. Their two numbers at
either end belong to other curves too. Those between are the curve's own, and follow from the ends'
but for some that are free; what is left are a few conditions on the ends alone. All of that
depends on n₀ and n₁ only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.brep.bernstein import bernstein, elevation, product
from scaffold_cad.struts.blending.quarter import DEGREE
from scaffold_cad.struts.blending.splines import Spline, spline

RANK = 1e-9
"""Equations whose size is below this part of the first follow from the others."""


@dataclass(frozen=True)
class Kind:
    """What the condition along a curve depends on."""

    pieces: int
    """Polynomial pieces of the curve."""
    across: int
    """Pieces of the patches away from it."""
    starts: int
    """How many patches meet at its start."""
    ends: int
    """How many patches meet at its end."""
    is_spoke: bool
    """Whether it ends on the collar."""


@dataclass(frozen=True, eq=False)
class Curve(Frozen):
    """The solutions of the condition along a curve of a kind.

    The numbers of an end, or of both, are those of the curve, and then the sums beside it.
    """

    conditions: Floats
    """Products with the 8 numbers of the ends (first, second, last but one, last) are 0, (p, 8)."""
    of_ends: Floats
    """From the ends' numbers to those between, (2 (n − 4), 8)."""
    of_free: Floats
    """From free numbers to those between, (2 (n − 4), f)."""


def share(valence: Ints) -> Floats:
    """Return 2 cos(2π/n), exactly 0 where 4 patches meet, for each of `valence`."""
    return np.asarray(np.where(valence == 4, 0.0, 2 * np.cos(2 * np.pi / valence)))


@lru_cache(maxsize=256)
def curve_of(kind: Kind) -> Curve:
    """Return the solutions of the condition along curves of a kind."""
    matrix = _condition(kind)
    count = matrix.shape[1] // 2
    place = np.arange(count)
    is_end = np.tile((place < 2) | (place >= count - 2), 2)
    left, sizes, right = np.linalg.svd(matrix[:, ~is_end])
    rank = int((sizes > RANK * sizes[0]).sum())
    inverse = (right[:rank].T / sizes[:rank]) @ left[:, :rank].T
    rest = left[:, rank:].T @ matrix[:, is_end]
    _, sizes, rows = np.linalg.svd(rest)
    independent = int((sizes > RANK * np.abs(matrix).max()).sum())
    return Curve(rows[:independent], -inverse @ matrix[:, is_end], right[rank:].T)


def _condition(kind: Kind) -> Floats:
    """Return what is 0 on a curve and on the sums beside it, (equations, 2 n)."""
    along, across = spline(kind.pieces), spline(kind.across).step
    first, last = share(np.array([kind.starts, kind.ends]))
    # On spokes α is of degree 1, which leaves them their full degree.
    alpha = np.array([[first, first / 2 if kind.is_spoke else 0.0, -last]])
    difference = np.diff(np.eye(DEGREE + 1), axis=0) / along.step
    parts = []
    for piece, extraction in enumerate(along.extraction):
        part = alpha @ _restriction(piece, along).T
        slope = product(part, DEGREE - 1)[0] @ difference @ extraction  # (D + 2, n)
        raised = elevation(DEGREE, DEGREE + 1) @ extraction / across
        parts.append(np.concatenate([-2 * raised - slope, raised], axis=1))
    return np.concatenate(parts)


def _restriction(piece: int, along: Spline) -> Floats:
    """Return what takes quadratics to one of equal pieces, both in Bernstein form, (3, 3)."""
    at = np.array([0.0, 0.5, 1.0])
    return np.asarray(np.linalg.solve(bernstein(2, at), bernstein(2, (at + piece) / along.pieces)))
