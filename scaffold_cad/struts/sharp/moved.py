"""Sharp nodes of other struts, moved: the triangles stay, and their points follow the edges.

A point on an edge keeps its share of it from corner to corner, or, where the edge runs all around,
its angle about the strut on whose generators that is. Points inside of the ball's face follow those
around them: the node turns as a whole as far as it can; what is left is done in small steps, in
which each point of the outline goes the shortest way, and one inside turns as the mean of those
around it does, with mean value coordinates.

The surface is star-shaped around its node, so that it is whole where no triangle is turned over, as
the node sees it. Where one is, points slide along their edges.

Mean value coordinates: Floater, "Mean value coordinates", Computer Aided Geometric Design 20, 2003.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import spsolve

from scaffold_cad.base.arrays import Floats, Ints, Points, Triangles, UnitVectors
from scaffold_cad.base.vectors import dot, length, normalize, rotated, shortest_turns
from scaffold_cad.struts.sharp.shapes import SharpShape
from scaffold_cad.struts.sharp.sliding import OnStrands
from scaffold_cad.struts.sharp.strands import Matched, whole_turn
from scaffold_cad.struts.sharp.triangles import ShapeTriangles, ring_points, swelled

STEP = np.radians(5.0)
"""How far points of the ball's outline go in a step at most."""


def moved(
    made: ShapeTriangles, before: SharpShape, found: Matched, sides: int
) -> ShapeTriangles | None:
    """Return the triangles of a shape with its points moved, or None where some would turn over.

    Parameters
    ----------
    found : the strands of the shape that it becomes
    sides : points of a ring
    """
    after, strands = found.strands.shape, found.strands
    strand, ball = found.number[made.strand], made.triangles[len(made.triangles) - made.on_ball :]
    turned = made.points @ whole_turn(before, after).T
    points = _with_ball(turned, strands.points(strand, made.share), ball)
    every = np.concatenate([points, ring_points(after, sides)])
    share = OnStrands(strands, strand, every, made.triangles, made.areas).slid(made.share)
    if share is None:
        return None
    points[: len(strand)] = strands.points(strand, share)
    return replace(made, points=swelled(points, ball, len(strand), sides), strand=strand)


def _with_ball(points: Points, on_edges: Points, ball: Triangles) -> Points:
    """Return points of edges, and with them those inside of the ball's faces, on it.

    Parameters
    ----------
    points : (p, 3) where all were
    on_edges : (f, 3) where the first are
    ball : triangles of its faces
    """
    points, fixed = normalize(points), len(on_edges)
    turns = shortest_turns(points[:fixed], normalize(on_edges))
    count = int(np.ceil(length(turns).max() / STEP))
    for _ in range(count):
        points[fixed:] = rotated(points[fixed:], _carried(points, ball, turns / count))
        points[:fixed] = rotated(points[:fixed], turns / count)
    points[:fixed] = on_edges
    return points


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
