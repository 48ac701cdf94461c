"""Closed surfaces of a few triangles each, all in arrays: whether they are whole."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Points
from scaffold_cad.base.vectors import triple
from scaffold_cad.base.visibility import seen
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh


def whole(shells: Points) -> Bools:
    """Return whether closed surfaces (k, t, 3, 3) face outwards and do not cross themselves."""
    count, size = shells.shape[:2]
    fine = triple(*(shells[:, :, corner] - shells[:, :1, 0] for corner in range(3))).sum(axis=1) > 0
    # Every shell has vertices of its own, numbered by position within the shell.
    points, number = np.unique(
        np.column_stack([np.repeat(np.arange(float(count)), 3 * size), shells.reshape(-1, 3)]),
        axis=0,
        return_inverse=True,
    )
    mesh = TriangleMesh(points[:, 1:], number.reshape(-1, 3))
    shell = np.repeat(np.arange(count), size)
    crossing = self_intersections(mesh, weld=False, parts=shell)
    fine[shell[crossing]] = False
    return np.asarray(fine)


def seen_once(shells: Points, rounding: float) -> Bools:
    """Return whether closed surfaces (k, t, 3, 3) are seen from 0, all of them and only once.

    Coordinates are off by up to `rounding`, mm.
    """
    positive, angle = seen(*_corners(shells), rounding)
    return np.asarray(positive.all(axis=1) & (np.abs(angle.sum(axis=1) - 4 * np.pi) < 1e-3))


def solid_angle(shells: Points) -> Floats:
    """Return the solid angle of surfaces (k, t, 3, 3) seen from 0, (k,)."""
    _, angle = seen(*_corners(shells), 0.0)
    total: Floats = angle.sum(axis=1)
    return total


def _corners(triangles: Points) -> tuple[Points, Points, Points]:
    """Return the corners of triangles (..., 3, 3), each (..., 3)."""
    return triangles[..., 0, :], triangles[..., 1, :], triangles[..., 2, :]
