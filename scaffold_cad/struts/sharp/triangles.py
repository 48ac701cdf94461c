"""Sharp shapes as triangles: columns of struts between generators of rings, and the ball.

The points are on the surfaces themselves. A column of a strut lies between two generators, from
the edges at the node to the ring; the parts of the ball are the faces of the convex hull of their
outline and of points between. Both share the points of the edges.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, Triangles
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import dot, normalize, triple
from scaffold_cad.struts.meshes.bands import enlargement
from scaffold_cad.struts.sharp.columns import points_along, seen, strut_triangles, unrolled
from scaffold_cad.struts.sharp.earcut import ears
from scaffold_cad.struts.sharp.loops import Steps
from scaffold_cad.struts.sharp.sampled import CLOSE, SampledEdges, sampled
from scaffold_cad.struts.sharp.shapes import SharpShape
from scaffold_cad.struts.sharp.spherical import cut_out
from scaffold_cad.struts.sharp.strands import strands_of

SPACING = 0.75
"""Least distance of points inside of the ball's face from its outline, in sides of the ball."""

MOST_STEP = np.pi / 8
"""Greatest angle between these, as the node sees them: with fewer of them the ball is too small."""

SWELL = (0.9, 1.1)
"""How far out these are at least and at most, in radii of the ball, for its faces to have its
volume."""


@dataclass(frozen=True, eq=False)
class ShapeTriangles(Frozen):
    """The surface of a sharp node up to the rings of its struts."""

    points: Points
    """Relative to the node, in radii of the ball, shape (p, 3)."""
    triangles: Triangles
    """Corners; p + sides * i + k is point k of the ring of strut i, shape (t, 3)."""
    strand: Ints
    """On which of the shape's `Strands` the first points are, shape (f,); all others are inside of
    the ball's faces."""
    share: Floats
    """Where on them, from 0 to 1, shape (f,)."""
    on_ball: int
    """How many triangles are of the ball; they come last."""
    areas: Floats
    """Areas of the triangles when they were made, from `seen_areas`, shape (t,)."""


def triangles_of(shape: SharpShape, sides: int) -> ShapeTriangles | None:
    """Return the triangles of a shape, or None where they do not close.

    Parameters
    ----------
    sides : points of a ring
    """
    for close in (CLOSE, 0.0):
        edges = sampled(shape, sides, close)
        made = _made(shape, edges, sides)
        if made is not None:
            return made
    return None


def _made(shape: SharpShape, edges: SampledEdges, sides: int) -> ShapeTriangles | None:
    fill = _fill(shape, edges, sides)
    points = np.concatenate([np.array(edges.points), fill])
    found: list[tuple[int, int, int]] = []
    for strut in range(shape.valency):
        own = strut_triangles(shape, edges, strut, sides, len(points))
        if own is None:
            return None
        found += own
    for face, steps in shape.islands:
        own = _island(shape, edges, face, steps)
        if own is None:
            return None
        found += own
    ball = _ball(shape, edges, points)
    if ball is None:
        return None
    triangles = np.concatenate([np.array(found, dtype=np.intp).reshape(-1, 3), ball])
    if not _closes(triangles, len(points)):
        return None
    points = swelled(points, ball, len(edges.points), sides)
    edge, angle = np.array(edges.at).reshape(-1, 2).T
    strand, share = strands_of(shape).placed(edge.astype(np.intp), angle)
    areas = seen_areas(np.concatenate([points, ring_points(shape, sides)]), triangles)
    return _compacted(ShapeTriangles(points, triangles, strand, share, len(ball), areas))


def _compacted(made: ShapeTriangles) -> ShapeTriangles:
    """Return triangles without the points that none of them has."""
    triangles, count = made.triangles, len(made.points)
    own = triangles < count
    kept = np.zeros(count, dtype=np.bool_)
    kept[triangles[own]] = True
    number = np.append(np.cumsum(kept) - 1, kept.sum() - count)
    renumbered = np.where(own, number[np.minimum(triangles, count)], triangles + number[-1])
    on_edges = kept[: len(made.strand)]
    strand, share = made.strand[on_edges], made.share[on_edges]
    return replace(made, points=made.points[kept], triangles=renumbered, strand=strand, share=share)


def seen_areas(points: Points, triangles: Triangles) -> Floats:
    """Return twice the areas of triangles (t, 3) as seen from the origin, negative turned over."""
    return triple(*np.moveaxis(normalize(points)[triangles], 1, 0))


def ring_points(shape: SharpShape, sides: int) -> Points:
    """Return the points of the rings of a shape, (N * sides, 3), in radii of the ball."""
    stars, angle = shape.curves.stars, 2 * np.pi / sides * np.arange(sides)[:, None]
    top = shape.collars
    size = enlargement(np.zeros(1), sides)[0] * (stars.radii[0] + stars.slopes[0] * top)
    spokes = np.cos(angle) * stars.x[0, :, None] + np.sin(angle) * stars.y[0, :, None]
    rings = top[:, None, None] * stars.directions[0, :, None] + size[:, None, None] * spokes
    return np.asarray(rings.reshape(-1, 3))


def _closes(triangles: Triangles, count: int) -> bool:
    """Return whether each side, but for those of rings, is that of two triangles, both ways."""
    a, b = sides_of(triangles).T
    inner = (a < count) | (b < count)
    a, b = a[inner], b[inner]
    wide = int(triangles.max()) + 1
    ahead, back = np.sort(a * wide + b), np.sort(b * wide + a)
    return bool(np.array_equal(ahead, back) and (np.diff(ahead) > 0).all())


def _island(
    shape: SharpShape, edges: SampledEdges, strut: int, steps: Steps
) -> list[tuple[int, int, int]] | None:
    """Return the triangles of a piece of a strut that is apart from the rest of it."""
    path = points_along(edges, steps)
    corners = unrolled(shape, strut, np.array([edges.points[k] for k in path]))
    corners[:, 0] = np.unwrap(corners[:, 0])
    corners[:, 0] -= (corners[:, 0].min() + corners[:, 0].max()) / 2
    stars = shape.curves.stars
    cut = ears(seen(corners, float(stars.radii[0, strut]), float(stars.slopes[0, strut])))
    return None if cut is None else [(path[a], path[b], path[c]) for a, b, c in cut]


def _outline(shape: SharpShape, edges: SampledEdges) -> set[tuple[int, int]]:
    """Return the sides of the ball's faces, the ball to their left; seams are not among them."""
    found = set()
    for (left, right), path in zip(shape.sides.tolist(), edges.edges, strict=True):
        if (left >= shape.valency) == (right >= shape.valency):
            continue
        way = path if left >= shape.valency else path[::-1]
        found |= set(pairwise(way))
    return found


def _fill(shape: SharpShape, edges: SampledEdges, sides: int) -> Points:
    """Return points inside of the faces of the ball, (f, 3)."""
    outline = _outline(shape, edges)
    if not outline:
        return np.zeros((0, 3))
    around = np.array([edges.points[k] for k in sorted({a for a, _ in outline})])
    step = min(2 * np.pi / sides, MOST_STEP)
    count = int(4 * np.pi / (step**2 * 0.87))
    turn = np.arange(count) + 0.5
    height = 1.0 - 2.0 * turn / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * turn
    wide = np.sqrt(1.0 - height**2)
    points = np.stack([wide * np.cos(angle), wide * np.sin(angle), height], axis=1)
    stars = shape.curves.stars
    free = (stars.leave[0] - points @ stars.directions[0].T).min(axis=1) > 0
    points = points[free]
    near = np.linalg.norm(points[:, None] - around, axis=2).min(axis=1)
    return np.asarray(points[near > SPACING * step])


def _ball(shape: SharpShape, edges: SampledEdges, points: Points) -> Triangles | None:
    """Return the triangles of the ball's faces, or None where they do not have its outline."""
    outline = _outline(shape, edges)
    if not outline:
        return np.zeros((0, 3), dtype=np.intp)
    own = sorted({a for a, _ in outline}) + list(range(len(edges.points), len(points)))
    number = {point: k for k, point in enumerate(own)}
    made = cut_out(points[own], {(number[a], number[b]) for a, b in outline})
    if made is not None:
        return np.array(own)[made]
    loops, found = _outline_loops(outline), []
    for loop in loops:
        cut = ears(_stereographic(points[loop]))
        if cut is None or len(loops) > 1:
            return None
        found += [(loop[a], loop[b], loop[c]) for a, b, c in cut]
    return np.array(found, dtype=np.intp)


def swelled(points: Points, ball: Triangles, fixed: int, sides: int) -> Points:
    """Return points, those inside of the ball's faces moved for these to have its volume.

    Parameters
    ----------
    ball : triangles of these faces
    fixed : how many of the first points stay
    sides : of polygons, whose enlargement all lengths get in the end
    """
    if len(ball) == 0 or len(points) == fixed:
        return points
    larger = float(enlargement(np.zeros(1), sides)[0])
    a, b, c = np.moveaxis(points[ball], 1, 0)  # (t, 3) each
    volume = triple(a, b, c)
    angles = 1.0 + dot(a, b) + dot(b, c) + dot(c, a)
    wanted = 2.0 * np.arctan2(volume, angles).sum() / larger**3  # of three times the volume
    moved = (ball >= fixed).sum(axis=1)
    factors = np.linspace(*SWELL, 64)
    made = (volume[:, None] / 2.0 * factors ** moved[:, None]).sum(axis=0)
    found = points.copy()
    found[fixed:] *= np.interp(wanted, made, factors)
    return found


def _outline_loops(outline: set[tuple[int, int]]) -> list[list[int]]:
    """Return the points around each piece of the ball."""
    follows = dict(sorted(outline))
    loops = []
    while follows:
        start, at = next(iter(follows.items()))
        del follows[start]
        loop = [start]
        while at != start and at in follows:
            loop.append(at)
            at = follows.pop(at)
        loops.append(loop)
    return loops


def _stereographic(points: Points) -> Floats:
    """Return points of a sphere in the plane, seen from opposite their middle, (n, 2)."""
    middle = points.mean(axis=0)
    middle = middle / np.linalg.norm(middle)
    x = np.cross(middle, np.eye(3)[np.argmin(np.abs(middle))])
    x = x / np.linalg.norm(x)
    y = np.cross(middle, x)
    scale = 1.0 / (1.0 + points @ middle)
    return np.stack([points @ x * scale, points @ y * scale], axis=1)
