"""Hexahedra's quality: scaled Jacobians at corners, and volumes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.vectors import triple

NEIGHBORS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
"""The three corners joined to each corner of a hexahedron, right-handed."""

_JOINED = [
    [tuple(sorted((one, other))) for other in others]
    for one, others in enumerate(NEIGHBORS.tolist())
]
SIDES = np.array(sorted({pair for pairs in _JOINED for pair in pairs}))
"""The two corners of each of the twelve sides, shape (12, 2)."""

SIDE_OF = np.array([[SIDES.tolist().index(list(pair)) for pair in pairs] for pairs in _JOINED])
"""Side from each corner to each of its neighbors, shape (8, 3)."""

SIGNS = np.where(SIDES[SIDE_OF, 0] == np.arange(8)[:, None], 1.0, -1.0)
"""Whether it leads there, 1, or back, -1, shape (8, 3)."""

FACES = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
"""Corners of the six faces, counter-clockwise seen from outside."""

HEXAHEDRON_BYTES = 2048
"""What a hexahedron takes where it is measured."""


@dataclass(frozen=True, eq=False)
class Corners(Frozen):
    """The corners of k hexahedra, coordinates first."""

    units: Floats
    """Unit vectors along the sides, shape (3, 12, k)."""
    sizes: Floats
    """Lengths of the sides, shape (12, k), mm."""
    jacobians: Floats
    """Scaled Jacobians, the determinants of the unit vectors from corners, shape (8, k)."""

    @staticmethod
    def of(points: Points, hexahedra: Ints) -> Corners:
        """Return the corners of `hexahedra` (k, 8)."""
        at = points.T[:, hexahedra.T]  # (3, 8, k)
        units = at[:, SIDES[:, 1]] - at[:, SIDES[:, 0]]
        sizes = np.sqrt(np.maximum(np.einsum("x...,x...->...", units, units), 1e-300))
        units /= sizes
        a, b, c = (units[:, SIDE_OF[:, side]] for side in range(3))  # (3, 8, k) each
        jacobians = np.einsum("x...,x...->...", a, cross(b, c))
        jacobians *= SIGNS.prod(axis=1)[:, None]
        return Corners(units, sizes, jacobians)


def cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of vectors whose coordinates come first, (3, ...)."""
    products = np.empty_like(a)
    for axis in range(3):
        np.multiply(a[axis - 2], b[axis - 1], out=products[axis])
        products[axis] -= a[axis - 1] * b[axis - 2]
    return products


def scaled_jacobians(points: Points, hexahedra: Ints) -> Floats:
    """Return the least scaled Jacobian over the corners of each hexahedron, (k,), in -1..1.

    At a corner it is the determinant of the unit vectors along its three sides.

    References
    ----------
    Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comput. 23, 2001.
    """
    least = np.empty(len(hexahedra))
    for block in blocks(len(hexahedra), HEXAHEDRON_BYTES, CACHE):
        least[block] = Corners.of(points, hexahedra[block]).jacobians.min(axis=0)
    return least


def hexahedron_volumes(points: Points, hexahedra: Ints) -> Floats:
    """Return the volume of each trilinear hexahedron, exact, (k,), mm³.

    References
    ----------
    Grandy, Efficient computation of volume of hexahedral cells, LLNL UCRL-ID-128886, 1997.
    """
    volumes = np.empty(len(hexahedra))
    for block in blocks(len(hexahedra), HEXAHEDRON_BYTES):
        x = np.moveaxis(points[hexahedra[block]], 1, 0)  # (8, c, 3)
        total = triple(x[6] - x[1] + x[7] - x[0], x[6] - x[3], x[2] - x[0])
        total += triple(x[7] - x[0], x[6] - x[3] + x[5] - x[0], x[6] - x[4])
        total += triple(x[6] - x[1], x[5] - x[0], x[6] - x[4] + x[2] - x[0])
        volumes[block] = total / 12.0
    return volumes


def boundary_faces(hexahedra: Ints) -> Ints:
    """Return the quads that belong to one hexahedron only, counter-clockwise from outside, (f, 4).

    A mesh with a face of three hexahedra or more does not conform.
    """
    faces = hexahedra[:, FACES].reshape(-1, 4)
    low, second, third, high = np.sort(faces, axis=1).T
    count = int(high.max(initial=0)) + 1
    keys = second * count + low, high * count + third
    order = np.lexsort(keys)
    changed = np.ones(len(faces), dtype=np.bool_)
    changed[1:] = np.any([np.diff(key[order]) != 0 for key in keys], axis=0)
    start = np.flatnonzero(changed)
    size = np.diff(np.append(start, len(faces)))
    kept: Ints = faces[order[start[size == 1]]]
    return kept


def enclosed_volume(points: Points, quads: Ints) -> float:
    """Return the volume inside closed bilinear quads, mm³, exact."""
    a, b, c, d = np.moveaxis(points[quads], 1, 0)
    # A bilinear patch encloses the mean of its two triangulations.
    both = triple(a, b, c) + triple(a, c, d) + triple(a, b, d) + triple(b, c, d)
    return float(both.sum() / 12.0)
