"""Hexahedra's quality: scaled Jacobians at corners, and volumes."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import dot, length, triple

NEIGHBORS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
"""The three corners joined to each corner of a hexahedron, right-handed."""

FACES = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
"""Corners of the six faces, counter-clockwise seen from outside."""

HEXAHEDRON_BYTES = 640
"""What a hexahedron takes where it is measured."""


def scaled_jacobians(points: Points, hexahedra: Ints) -> Floats:
    """Return the least scaled Jacobian over the corners of each hexahedron, (k,), in -1..1.

    At a corner it is the determinant of the unit vectors along its three sides.

    References
    ----------
    Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comput. 23, 2001.
    """
    least = np.empty(len(hexahedra))
    for block in blocks(len(hexahedra), HEXAHEDRON_BYTES):
        corners = points[hexahedra[block]]  # (c, 8, 3)
        worst = np.full(len(corners), np.inf)
        for corner, (a, b, c) in enumerate(NEIGHBORS.tolist()):
            sides = corners[:, [a, b, c]] - corners[:, corner, None]  # (c, 3, 3)
            sizes = np.maximum(length(sides).prod(axis=1), 1e-300)
            np.minimum(worst, triple(*np.moveaxis(sides, 1, 0)) / sizes, out=worst)
        least[block] = worst
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

    A face of three hexahedra or more is none of a mesh that conforms.
    """
    faces = hexahedra[:, FACES].reshape(-1, 4)
    key = np.sort(faces, axis=1)
    order = np.lexsort(key.T)
    changed = np.concatenate([[True], (np.diff(key[order], axis=0) != 0).any(axis=1)])
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


def shortest_side(points: Points, hexahedra: Ints) -> float:
    """Return the shortest side of all hexahedra, mm."""
    corners = points[hexahedra]
    return float(
        min(
            np.sqrt(dot(step, step)).min()
            for one, others in enumerate(NEIGHBORS.tolist())
            for step in [corners[:, other] - corners[:, one] for other in others if other > one]
        )
    )
