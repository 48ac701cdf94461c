"""Partitions for bends: nodes of two struts, whose sphere is cut into two half-spheres."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import UnitVectors
from scaffold_cad.base.vectors import angle_between, any_perpendicular, length, normalize
from scaffold_cad.partition import Partitions
from scaffold_cad.struts.blending.crotches import half_length

STRAIGHT = 1e-6
"""Below this length the sum of two unit vectors has no direction to rely on."""


def bend_partitions(directions: UnitVectors) -> Partitions:
    """Return the partitions of M bends: four vertices on the great circle midway between both.

    They need no evening: each arc looks like that of the other strut.

    Parameters
    ----------
    directions : (M, 2, 3) float64, unit vectors, different in each pair

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
    half = half_length(between)[:, None]
    ahead, aside = np.cos(half) * inner, np.sin(half) * side
    behind = np.stack([side - inner, -inner - side], axis=1) / np.sqrt(2)
    ends = np.stack([ahead - aside, ahead + aside], axis=1)
    vertices = np.concatenate([ends, behind], axis=1)  # (M, 4, 3)
    quads = np.broadcast_to(np.array([[0, 1, 2, 3], [3, 2, 1, 0]]), (len(directions), 2, 4))
    clearance = np.repeat(between[:, None] / 2, 2, axis=1)
    methods = np.full(len(directions), "dual", dtype="<U9")
    return Partitions(directions, vertices, quads.astype(np.intp), clearance, methods)
