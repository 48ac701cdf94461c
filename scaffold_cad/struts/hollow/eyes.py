"""Insides of nodes that are star-shaped, but not around their node.

Where struts leave at narrow angles the inside begins further along them, and is not seen whole from
the node. It is as free of folds if it is seen whole from any other point: here from its *eye*, the
point that is furthest inside of all planes that touch it. Linear programming finds the eye from
samples; the proof around it is that around nodes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points, UnitVectors
from scaffold_cad.base.vectors import dot
from scaffold_cad.base.visibility import seen
from scaffold_cad.struts.blending.blend import Solved
from scaffold_cad.struts.blending.fitting import pieces_of_patches
from scaffold_cad.struts.blending.proof import prove_around
from scaffold_cad.struts.hollow.gaps import surface_samples

SAMPLES = 9
"""Samples of a patch in either direction, whose planes are looked at."""
CORNERS = 64
"""Corners of the polygons that stand for discs, for the sum of solid angles: 0 or 4 π or more."""


def seen_from_eyes(made: Solved, axes: UnitVectors, rows: Ints) -> Solved:
    """Return insides (U) with what is proved around the eyes of those in `rows` (k,).

    Parameters
    ----------
    axes : (U, N, 3) directions of the struts
    """
    if len(rows) == 0:
        return made
    some, along = made[rows], axes[rows]
    centers = some.collar_distances[..., None] * along  # (k, N, 3)
    samples = zip(*surface_samples(some, SAMPLES), centers, along, strict=True)
    eyes = np.array([_eye(*each) for each in samples])  # (k, 3)
    below = dot(centers - eyes[:, None], along)  # of the planes of the discs, (k, N)
    control = pieces_of_patches(some.control, some.layout) - eyes[:, None, None, None]
    proof = prove_around(control, _disc_angles(some, centers - eyes[:, None]))
    star, angle = made.is_star_shaped.copy(), made.solid_angle.copy()
    star[rows] = proof.is_star_shaped & (below > 0).all(axis=1)
    angle[rows] = proof.solid_angle
    return replace(made, is_star_shaped=star, solid_angle=angle)


def _eye(points: Points, normals: UnitVectors, centers: Points, axes: UnitVectors) -> Floats:
    """Return the point that is furthest inside of the planes of samples and of discs, (3,).

    It is the node, 0, where no point is inside of all of them.
    """
    from scipy.optimize import linprog  # slow to import, and few nodes need it

    upward = np.concatenate([normals, axes])
    heights = np.concatenate([dot(points, normals), dot(centers, axes)])
    found = linprog(
        [0.0, 0.0, 0.0, -1.0],  # the least depth grows
        A_ub=np.column_stack([upward, np.ones(len(upward))]),
        b_ub=heights,
        bounds=[(None, None)] * 3 + [(0.0, None)],
    )
    return np.zeros(3) if found.x is None else np.asarray(found.x[:3])


def _disc_angles(shapes: Solved, centers: Floats) -> Floats:
    """Return the solid angles (k,) of all discs of surfaces, seen from 0, sr.

    Parameters
    ----------
    centers : (k, N, 3) of the discs
    """
    turns = np.linspace(0.0, 2 * np.pi, CORNERS + 1)[:, None]
    x, y = (shapes.collar_corners[:, :, k, None] for k in (0, 1))  # (k, N, 1, 3)
    rim = np.cos(turns) * x + np.sin(turns) * y
    rim = centers[:, :, None] + shapes.collar_radii[..., None, None] * rim
    middle = np.broadcast_to(centers[:, :, None], rim[:, :, 1:].shape)
    _, angles = seen(middle, rim[:, :, :-1], rim[:, :, 1:], 0.0)
    return np.asarray(angles.sum(axis=(1, 2)))
