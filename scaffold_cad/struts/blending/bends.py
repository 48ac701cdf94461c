"""Partitions for bends: nodes of two struts, whose sphere is cut into two half-spheres."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, UnitVectors
from scaffold_cad.base.vectors import angle_between, any_perpendicular, length, normalize
from scaffold_cad.partition import Partitions
from scaffold_cad.struts.blending.crotches import half_length

QUARTER = np.pi / 2

STRAIGHT = 1e-6
"""Below this length the sum of two unit vectors has no direction to rely on."""


def bend_partitions(directions: UnitVectors, turns: Floats | None = None) -> Partitions:
    """Return the partitions of M bends: four vertices on the great circle midway between both.

    They need no evening: each arc looks like that of the other strut.

    Parameters
    ----------
    directions : (M, 2, 3) float64, unit vectors, different in each pair
    turns : (M,) by how much the vertices are turned about the first strut, rad; by whole quarters
        where arcs are not all of one length

    Examples
    --------
    >>> import numpy as np
    >>> elbow = bend_partitions(np.array([[[1.0, 0, 0], [0, 1, 0]]]))
    >>> elbow.vertices.shape, elbow.quads.tolist()
    ((1, 4, 3), [[[0, 1, 2, 3], [3, 2, 1, 0]]])
    """
    first, second = directions[:, 0], directions[:, 1]
    normal = normalize(first - second)
    inner = first + second
    inner -= (inner * normal).sum(axis=1, keepdims=True) * normal
    bent = length(inner)[:, None] > STRAIGHT
    inner = np.where(bent, normalize(inner), any_perpendicular(normal))
    side = np.cross(normal, inner)
    # Toward the inside of the bend lies the middle of an arc.
    between = angle_between(first, second)
    half = half_length(between)
    turns = np.zeros(len(half)) if turns is None else turns
    quarters = np.rint(turns / QUARTER)
    rest = np.where(half == QUARTER / 2, turns - quarters * QUARTER, 0.0)
    angles = np.stack([-half, half, 0 * half + 1.5 * QUARTER, 0 * half + 2.5 * QUARTER], axis=1)
    order = (np.arange(4) + quarters[:, None].astype(np.intp)) % 4
    angles = (np.take_along_axis(angles, order, axis=1) + rest[:, None])[..., None]  # (M, 4, 1)
    vertices = np.cos(angles) * inner[:, None] + np.sin(angles) * side[:, None]
    quads = np.broadcast_to(np.array([[0, 1, 2, 3], [3, 2, 1, 0]]), (len(directions), 2, 4))
    clearance = np.repeat(between[:, None] / 2, 2, axis=1)
    methods = np.full(len(directions), "dual", dtype="<U9")
    return Partitions(directions, vertices, quads.astype(np.intp), clearance, methods)
