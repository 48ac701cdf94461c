"""Balls of other struts, moved: the triangles stay, and their points follow the struts' circles.

A point on a circle keeps its angle about the strut. The ball turns as a whole as far as it can;
what is left is done in small steps: each circle turns and grows, and a point inside of the ball's
face turns as the mean of those around it does, with mean value coordinates.

Mean value coordinates: Floater, "Mean value coordinates", Computer Aided Geometric Design 20, 2003.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from scaffold_cad.base.arrays import Floats, Ints, Triangles, UnitVectors
from scaffold_cad.base.vectors import best_turns, dot, length, normalize, rotated, triple
from scaffold_cad.struts.sharp.stars import SharpStars
from scaffold_cad.struts.sharp.triangles import ShapeTriangles, swelled

STEP = np.radians(5.0)
"""How far circles turn in a step at most."""


def moved(
    made: ShapeTriangles, before: SharpStars, after: SharpStars, sides: int
) -> ShapeTriangles | None:
    """Return the triangles of a ball with its points moved, or None where some would turn over.

    Parameters
    ----------
    before, after : one star each, of which every strut leaves its ball in a circle of its own
    sides : points of a ring
    """
    fixed, ball = made.on_edges, made.triangles[len(made.triangles) - made.on_ball :]
    points = normalize(made.points)
    none = np.zeros(fixed, dtype=np.intp)
    away = np.abs(points[:fixed] @ before.directions[0].T - before.leave[0])  # (fixed, N)
    strut = away.argmin(axis=1)
    around = before.angles(none, strut, points[:fixed])
    whole = best_turns((after.directions[0].T @ before.directions[0])[None])[0]
    frames = [np.stack([star.x[0], star.y[0], star.directions[0]], 1) for star in (before, after)]
    frames[0] = frames[0] @ whole.T  # (N, 3, 3), rows x, y and the direction
    turns = Rotation.from_matrix(frames[1].transpose(0, 2, 1) @ frames[0]).as_rotvec()[strut]
    points, frame = points @ whole.T, frames[0][strut]
    wide = [np.arccos(np.clip(star.leave[0, strut], -1.0, 1.0)) for star in (before, after)]
    growth = wide[1] - wide[0]
    count = int(np.ceil(max(length(turns).max(), np.abs(growth).max()) / STEP))
    for step in range(count):
        outward = np.cross(rotated(frame[:, 2], step / count * turns), points[:fixed])
        own = (turns + (growth / length(outward))[:, None] * outward) / count
        points[fixed:] = rotated(points[fixed:], _carried(points, ball, own))
        part = (step + 1) / count
        size = wide[0] + part * growth
        x, y, ahead = (rotated(frame[:, axis], part * turns) for axis in range(3))
        spoke = np.cos(around)[:, None] * x + np.sin(around)[:, None] * y
        points[:fixed] = np.cos(size)[:, None] * ahead + np.sin(size)[:, None] * spoke
    if len(ball) and triple(*np.moveaxis(points[ball], 1, 0)).min() <= 0:
        return None
    return ShapeTriangles(swelled(points, ball, fixed, sides), made.triangles, fixed, made.on_ball)


def _carried(points: UnitVectors, ball: Triangles, turns: Floats) -> Floats:
    """Return the turns of the points (p, 3) that are not on circles, (f, 3), by those of the first.

    Each is the mean of those of the points around it. Seen from a point, a neighbor at an arc of θ
    is at tan θ in the plane that touches the sphere there, and has the weight tan(φ/2) / tan θ for
    the angles φ of the triangles beside it.
    """
    fixed, count = len(turns), len(points) - len(turns)
    if count == 0:
        return np.zeros((0, 3))
    rows, columns, weights = [], [], []
    for corner in range(3):
        a, b, c = np.roll(ball, -corner, axis=1).T
        own = np.flatnonzero(a >= fixed)
        a, b, c = a[own], b[own], c[own]
        flat = [points[k] / dot(points[k], points[a])[:, None] - points[a] for k in (b, c)]
        far = [length(each) for each in flat]
        cosine = np.clip(dot(*flat) / (far[0] * far[1]), -1.0, 1.0)
        half = np.sqrt((1.0 - cosine) / np.maximum(1.0 + cosine, 1e-12))  # tan(φ/2)
        rows += [a - fixed, a - fixed]
        columns += [b, c]
        weights += [half / far[0], half / far[1]]
    table: tuple[Ints, Ints] = np.concatenate(rows), np.concatenate(columns)
    means = csr_array((np.concatenate(weights), table), shape=(count, len(points)))
    system: csr_array = csr_array(diags_array(means.sum(axis=1)) - means[:, fixed:])
    return np.asarray(spsolve(system.tocsc(), means[:, :fixed] @ turns)).reshape(count, 3)
