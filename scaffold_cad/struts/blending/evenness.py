"""Moving the vertices of partitions until each quad looks like a square from its direction.

A patch runs from an arc of the partition to a quarter of the strut's collar. Where arcs are of
very different lengths, or do not face their quarters, the patches between fold. So the vertices
are drawn to where each of their quads would have them: at azimuths a right angle apart around
the direction, and at more equal angles from it. Arcs between struts that part late are then drawn
together, see `crotches`. The certificate of the partition is kept.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, UnitVectors
from scaffold_cad.base.frames import square_phases
from scaffold_cad.base.vectors import any_perpendicular, dot, normalize, triple
from scaffold_cad.partition.certificate import certify, corners_of
from scaffold_cad.struts.blending.crotches import with_short_arcs

STEPS = 40
SHARPNESS = 8.0
"""Of the soft maximum of cosines that tells which directions are near a vertex."""
STEP = 0.4
"""Part of the way to the wanted place that a vertex goes at once."""
HALVINGS = 6
"""How often a step that would cost the certificate is halved before it is left out."""
LEAST_SINE, KEPT = 0.2, 0.5
"""No step takes the least determinant below this, or below this part of what it was at first: a
vertex near a direction, or in line with two corners, makes folds."""


def even(
    directions: UnitVectors, vertices: UnitVectors, quads: Ints, openness: float
) -> UnitVectors:
    """Return more even vertices (M, N + 2, 3) of M partitions, each certified as it was.

    Parameters
    ----------
    directions : (M, N, 3) float64, unit vectors
    vertices : (M, N + 2, 3) float64, unit vectors
    quads : (M, N, 4) intp, vertices of the quad around each direction
    openness : weight of the pull away from near directions against that toward squares
    """
    frame_x = any_perpendicular(directions)
    frame_y = np.cross(directions, frame_x)
    current = np.array(vertices)
    bound = np.minimum(LEAST_SINE, KEPT * _least(directions, current, quads))
    for _ in range(STEPS):
        pull = _wanted(directions, frame_x, frame_y, current, quads) - current
        pull -= openness * _crowding(directions, current)
        step = np.full(len(current), STEP)
        open_rows = np.arange(len(current))
        for _ in range(HALVINGS):
            moved = normalize(current[open_rows] + step[open_rows, None, None] * pull[open_rows])
            found = _least(directions[open_rows], moved, quads[open_rows])
            kept = found > bound[open_rows]
            current[open_rows[kept]] = moved[kept]
            open_rows = open_rows[~kept]
            if len(open_rows) == 0:
                break
            step[open_rows] /= 2
    lost = ~certify(directions, current, quads).valid
    current[lost] = vertices[lost]
    return with_short_arcs(directions, current, quads)


def _crowding(directions: UnitVectors, vertices: UnitVectors) -> Floats:
    """Return which way each vertex comes nearer to the directions around it, (M, V, 3).

    It is the gradient of a soft maximum of their cosines. Toward near directions the surface lies
    far out, between struts that have not yet parted.
    """
    cosines = vertices @ directions.transpose(0, 2, 1)  # (M, V, N)
    weights = np.exp(SHARPNESS * (cosines - cosines.max(axis=2, keepdims=True)))
    weights /= weights.sum(axis=2, keepdims=True)
    mean = weights @ directions
    return np.asarray(mean - dot(mean, vertices)[..., None] * vertices)


def _wanted(
    directions: UnitVectors,
    frame_x: UnitVectors,
    frame_y: UnitVectors,
    vertices: UnitVectors,
    quads: Ints,
) -> UnitVectors:
    """Return where the quads around each vertex would have it, unit vectors, (M, V, 3)."""
    corners = corners_of(vertices, quads)  # (M, N, 4, 3)
    phase = square_phases(corners, frame_x, frame_y)[..., None] + np.arange(4) * (np.pi / 2)
    tilt = np.arccos(np.clip(dot(corners, directions[:, :, None]), -1, 1))  # (M, N, 4)
    tilt = (tilt + tilt.mean(axis=2, keepdims=True)) / 2
    across = (
        np.cos(phase)[..., None] * frame_x[:, :, None]
        + np.sin(phase)[..., None] * frame_y[:, :, None]
    )
    places = np.cos(tilt)[..., None] * directions[:, :, None] + np.sin(tilt)[..., None] * across
    count = vertices.shape[1]
    flat = (quads + count * np.arange(len(quads))[:, None, None]).reshape(-1)
    sums = [
        np.bincount(flat, places[..., k].reshape(-1), minlength=count * len(quads))
        for k in range(3)
    ]
    return normalize(np.stack(sums, axis=1)).reshape(vertices.shape)


def _least(directions: UnitVectors, vertices: UnitVectors, quads: Ints) -> Floats:
    """Return the least determinant of two following corners and the direction, (M,)."""
    corners = corners_of(vertices, quads)
    spanned = triple(corners, np.roll(corners, -1, axis=2), directions[:, :, None])
    least: Floats = spanned.min(axis=(1, 2))
    return least
