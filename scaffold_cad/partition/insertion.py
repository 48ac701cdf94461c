"""The partition of the paper's Algorithm 1: directions inserted one by one.

Two directions share the sphere as hemispheres, each a quad with its corners on the great circle
between them. Every further direction falls into a quad, which a new vertex midway between the
quad's own direction and the new one, joined to two opposite corners, splits in two. No vertex is
moved afterwards. The result depends on the order of the directions and need not be valid: it
fails its certificate more often the more directions there are. It is kept for comparison.

References
----------
Panotopoulou et al., Scaffolding a Skeleton, 2018, Algorithm 1.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.vectors import any_perpendicular, dot, four_around, length, normalize
from scaffold_cad.partition.certificate import arc_normals

SPLITS = np.array(
    [
        [[0, 1, 2, 4], [2, 3, 0, 4]],
        [[2, 3, 0, 4], [0, 1, 2, 4]],
        [[1, 2, 3, 4], [3, 0, 1, 4]],
        [[3, 0, 1, 4], [1, 2, 3, 4]],
    ]
)
"""The four ways of splitting a quad 0, 1, 2, 3 by a vertex 4: corners of the old direction's
part and of the new one's."""


def insertion_partitions(stars: UnitVectors) -> tuple[UnitVectors, Ints]:
    """Return vertices (M, N + 2, 3) and quads (M, N, 4), valid or not.

    Parameters
    ----------
    stars : (M, N, 3) float64, unit vectors, distinct within each star
    """
    count, valency = stars.shape[:2]
    row = np.arange(count)
    vertices = np.zeros((count, valency + 2, 3))
    quads = np.zeros((count, valency, 4), dtype=np.intp)
    vertices[:, :4] = _hemisphere_corners(stars)
    quads[:, 0], quads[:, 1] = [0, 1, 2, 3], [3, 2, 1, 0]
    for new in range(2, valency):
        corners = vertices[row[:, None, None], quads[:, :new]]  # (M, new, 4, 3)
        inserted = stars[:, new]
        old = np.argmax(_margins(inserted[:, None], corners), axis=1)
        vertices[:, new + 2] = _midway(stars[row, old], inserted)
        pieces = np.column_stack([quads[row, old], np.full(count, new + 2)])[:, SPLITS]
        both = np.stack([stars[row, old], inserted], axis=1)  # (M, 2, 3)
        corners = vertices[row[:, None, None, None], pieces]  # (M, 4, 2, 4, 3)
        split = np.argmax(_margins(both[:, None], corners).min(axis=2), axis=1)
        quads[row, old], quads[:, new] = pieces[row, split, 0], pieces[row, split, 1]
    return vertices, quads


def _hemisphere_corners(stars: UnitVectors) -> UnitVectors:
    """Return four corners on the great circle between the first two directions, (M, 4, 3).

    They are counter-clockwise around the first; the third direction lies above one of them, so
    that the two beside that one are where it will be cut off.
    """
    axes = normalize(stars[:, 0] - stars[:, 1])
    above = stars[:, 2] - dot(stars[:, 2], axes)[:, None] * axes
    flat = length(above) < 1e-9
    east = normalize(np.where(flat[:, None], any_perpendicular(axes), above))
    north = np.cross(axes, east)
    return four_around(east, north)


def _midway(a: UnitVectors, b: UnitVectors) -> UnitVectors:
    """Return the middle of the arcs from `a` to `b`, of any arc between opposite ones."""
    opposite = length(a + b) < 1e-9
    return normalize(np.where(opposite[:, None], any_perpendicular(a), a + b))


def _margins(directions: UnitVectors, corners: UnitVectors) -> Floats:
    """Return the sine of the clearance of `directions` (..., 3) in `corners` (..., 4, 3)."""
    sines = dot(arc_normals(corners), directions[..., None, :])
    margins: Floats = np.nan_to_num(sines, nan=-1.0).min(axis=-1)
    return margins
