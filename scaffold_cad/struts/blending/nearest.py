"""Points of blends near others: where what moves beside a node's surface is put back on it."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points, UnitVectors
from scaffold_cad.base.blocks import CACHE, blocks
from scaffold_cad.base.vectors import dot, length, normalize
from scaffold_cad.struts.blending.blend import Solved

SAMPLES = 7
"""Places along a side of a patch from which the nearest one is taken to start with."""

CANDIDATES = 3
"""Patches that are looked at, from the one with the nearest sample on."""

ROUNDS = 12
"""Steps from there."""

PLACE_BYTES = 64
"""What each place takes beside a point while the nearest is found."""


def nearest_on_blends(shapes: Solved, which: Ints, points: Points) -> tuple[Points, UnitVectors]:
    """Return points on blends near others, and the normals there, outward, both (q, 3).

    They are on the surface to the last digits, and near as far as the steps come.

    Parameters
    ----------
    which : (q,) blend that each point is beside
    points : (q, 3) relative to the node, mm
    """
    found, normals = np.empty_like(points), np.empty_like(points)
    even = (np.arange(SAMPLES) + 0.5) / SAMPLES
    order = np.argsort(which, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(which[order])) + 1):
        if len(rows) == 0:
            continue
        control = shapes.control[which[rows[0]]]  # (4 N, n_u, n_v, 3)
        u, v = shapes.layout.u.values_at(even), shapes.layout.v.values_at(even)
        samples = np.einsum("ui,vj,pijx->puvx", u, v, control).reshape(-1, 3)
        for part in blocks(len(rows), len(samples) * PLACE_BYTES, CACHE):
            some = rows[part]
            gap = points[some][:, None] - samples
            square = np.einsum("qsx,qsx->qs", gap, gap).reshape(len(some), len(control), -1)
            least = np.full(len(some), np.inf)
            # The nearest sample may be on the patch beside that of the nearest point.
            for patch in np.argsort(square.min(axis=2), axis=1)[:, :CANDIDATES].T:
                place = square[np.arange(len(some)), patch].argmin(axis=1)
                at = even[np.stack(np.divmod(place, SAMPLES), axis=1)]
                on, normal = _approached(shapes, control[patch], at, points[some])
                far = length(on - points[some])
                nearer = far < least
                least = np.minimum(least, far)
                found[some[nearer]], normals[some[nearer]] = on[nearer], normal[nearer]
    return found, normals


def _approached(
    shapes: Solved, control: Floats, at: Floats, wanted: Points
) -> tuple[Points, UnitVectors]:
    """Return points of patches near `wanted` (q, 3), from parameters `at` (q, 2), and normals.

    Parameters
    ----------
    control : (q, n_u, n_v, 3) control points of each one's patch
    """
    for _ in range(ROUNDS):
        point, by_u, by_v = _placed(shapes, control, at)
        gap = wanted - point
        # Least squares in the tangent plane; parameters stay on the patch.
        a, b, c = dot(by_u, by_u), dot(by_u, by_v), dot(by_v, by_v)
        right_u, right_v = dot(by_u, gap), dot(by_v, gap)
        size = np.maximum(a * c - b * b, 1e-300)
        step = np.stack([c * right_u - b * right_v, a * right_v - b * right_u], axis=1)
        at = np.clip(at + np.clip(step / size[:, None], -0.2, 0.2), 0.0, 1.0)
    point, by_u, by_v = _placed(shapes, control, at)
    return point, normalize(np.cross(by_u, by_v))


def _placed(shapes: Solved, control: Floats, at: Floats) -> tuple[Points, Floats, Floats]:
    """Return points at parameters (q, 2) of patches, and their slopes by u and v, each (q, 3)."""
    u, v = shapes.layout.u, shapes.layout.v
    by_row = np.einsum("qj,qijx->qix", v.values_at(at[:, 1]), control)
    along = np.einsum("qj,qijx->qix", v.values_at(at[:, 1], 1), control)
    across, slope = u.values_at(at[:, 0]), u.values_at(at[:, 0], 1)
    return (
        np.einsum("qi,qix->qx", across, by_row),
        np.einsum("qi,qix->qx", slope, by_row),
        np.einsum("qi,qix->qx", across, along),
    )
