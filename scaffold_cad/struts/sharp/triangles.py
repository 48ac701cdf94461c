"""Sharp shapes as triangles: columns of struts between generators of rings, and the ball.

The points are on the surfaces themselves. A column of a strut lies between two generators, from
the edges at the node to the ring; the parts of the ball are the faces of the convex hull of their
outline and of points between. Both share the points of the edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scaffold_cad.base.arrays import Floats, Frozen, Points, Triangles
from scaffold_cad.base.vectors import dot, triple
from scaffold_cad.struts.bands import enlargement
from scaffold_cad.struts.sharp.earcut import ears
from scaffold_cad.struts.sharp.loops import Steps
from scaffold_cad.struts.sharp.nodes import BESIDE, CLEAR
from scaffold_cad.struts.sharp.sampled import CLOSE, SampledEdges, sampled
from scaffold_cad.struts.sharp.shapes import SharpShape
from scaffold_cad.struts.sharp.spherical import cut_out

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
        own = _columns(shape, edges, strut, sides, len(points))
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
    points = _swelled(points, ball, len(edges.points), float(enlargement(np.zeros(1), sides)[0]))
    return _compacted(points, triangles) if _closes(triangles, len(points)) else None


def _compacted(points: Points, triangles: Triangles) -> ShapeTriangles:
    """Return triangles without the points that none of them has."""
    own = triangles < len(points)
    kept = np.zeros(len(points), dtype=np.bool_)
    kept[triangles[own]] = True
    number = np.append(np.cumsum(kept) - 1, kept.sum() - len(points))
    moved = np.where(own, number[np.minimum(triangles, len(points))], triangles + number[-1])
    return ShapeTriangles(points[kept], moved)


def _closes(triangles: Triangles, count: int) -> bool:
    """Return whether each side, but for those of rings, is that of two triangles, both ways."""
    a, b = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    inner = (a < count) | (b < count)
    a, b = a[inner], b[inner]
    wide = int(triangles.max()) + 1
    ahead, back = np.sort(a * wide + b), np.sort(b * wide + a)
    return bool(np.array_equal(ahead, back) and (np.diff(ahead) > 0).all())


def _path(edges: SampledEdges, steps: Steps) -> list[int]:
    """Return the points along a loop."""
    found: list[int] = []
    for edge, way in steps:
        found += (edges.edges[edge] if way else edges.edges[edge][::-1])[:-1]
    return found


def _unrolled(shape: SharpShape, strut: int, points: Points) -> Floats:
    """Return angles in (−π, π] and heights of points (q, 3) on a strut, (q, 2)."""
    zero = np.zeros(len(points), dtype=np.intp)
    angle = shape.curves.stars.angles(zero, zero + strut, points)
    return np.stack([angle, points @ shape.curves.stars.directions[0, strut]], axis=1)


def _columns(
    shape: SharpShape, edges: SampledEdges, strut: int, sides: int, count: int
) -> list[tuple[int, int, int]] | None:
    """Return the triangles of a strut's face up to its ring, or None where columns do not close.

    Parameters
    ----------
    count : number of the first point of rings
    """
    first = count + sides * strut
    loops = [_path(edges, steps) for face, steps in shape.loops if face == strut]
    used = sorted({point for loop in loops for point in loop})
    flat = dict(
        zip(used, _unrolled(shape, strut, np.array([edges.points[k] for k in used])), strict=True)
    )
    size, slope = (
        float(each[0, strut]) for each in (shape.curves.stars.radii, shape.curves.stars.slopes)
    )
    top = CLEAR * max(float(shape.heights[strut]), 0.0) + BESIDE * size
    columns = [_Column() for _ in range(sides)]
    lines: list[list[int]] = [[] for _ in range(sides)]
    bridged: dict[int, list[list[int]]] = {}
    for loop in loops:
        if not any(strut in edges.on[point] for point in loop):
            _bridge(loop, flat, sides, bridged)
        elif not _cut_loop(loop, edges, strut, columns, lines, sides, flat):
            return None
    for line, points in enumerate(lines):
        points.sort(key=lambda point: flat[point][1])
        if len(points) % 2 == 0:
            return None
        steps = [*points, first + line]
        own_holes = bridged.get(line, [])
        for low, high in zip(steps[0::2], steps[1::2], strict=True):
            top_of = flat[high][1] if high in flat else np.inf
            holes = [loop for loop in own_holes if flat[low][1] < flat[loop[0]][1] < top_of]
            down = [point for loop in reversed(holes) for point in (*loop, loop[0])]
            if high in columns[line].links or low in columns[line - 1].links:
                return None
            columns[line].links[high] = [*down, low]  # on its left side
            columns[line - 1].links[low] = [*(loop[0] for loop in holes), high]  # on the right
    found: list[tuple[int, int, int]] = []
    for line, column in enumerate(columns):
        column.links[first + (line + 1) % sides] = [first + line]
        own = _column_triangles(column, flat, first, line, sides, top, size, slope)
        if own is None:
            return None
        found += own
    return found


class _Column:
    """What is around the polygons of a column: from each point on, the points up to the next."""

    def __init__(self) -> None:
        self.links: dict[int, list[int]] = {}


def _cut_loop(
    loop: list[int],
    edges: SampledEdges,
    strut: int,
    columns: list[_Column],
    lines: list[list[int]],
    sides: int,
    flat: dict[int, Floats],
) -> bool:
    """Cut a loop at generators and give its pieces to columns; return whether that can be done."""
    marks = [edges.on[point].get(strut, -1) for point in loop]
    cuts = [place for place, line in enumerate(marks) if line >= 0]
    if not cuts:
        return False
    for place, following in zip(cuts, [*cuts[1:], cuts[0] + len(loop)], strict=True):
        here, there = marks[place], marks[following % len(loop)]
        lines[here].append(loop[place])
        if (there - here) % sides == 1:
            column = here
        elif (here - there) % sides == 1:
            column = there
        elif here == there and len(cuts) > 1:
            column = -1
        else:
            return False
        path = [loop[k % len(loop)] for k in range(place + 1, following + 1)]
        if column < 0:  # back to the generator from which it came
            if len(path) < 2:
                return False
            angle = flat[path[len(path) // 2 - 1]][0] - here * 2 * np.pi / sides
            column = here if np.sin(angle) > 0 else (here - 1) % sides
        if loop[place] in columns[column].links:
            return False
        columns[column].links[loop[place]] = path
    return True


def _bridge(
    loop: list[int], flat: dict[int, Floats], sides: int, bridged: dict[int, list[list[int]]]
) -> None:
    """Add a hole that is within a column to the generator on its left, from its left end on."""
    step = 2 * np.pi / sides
    angles = np.unwrap([flat[point][0] for point in loop])
    first = int(np.argmin(angles))
    line = int(np.floor(angles[first] / step)) % sides
    there = bridged.setdefault(line, [])
    there.append(loop[first:] + loop[:first])
    there.sort(key=lambda points: float(flat[points[0]][1]))


def _column_triangles(
    column: _Column,
    flat: dict[int, Floats],
    first: int,
    line: int,
    sides: int,
    top: float,
    size: float,
    slope: float,
) -> list[tuple[int, int, int]] | None:
    """Return the triangles of the polygons of a column."""
    links, found = column.links, []
    step = 2 * np.pi / sides
    while links:
        start = next(iter(links))
        polygon, at = [], start
        while at in links:
            path = links.pop(at)
            polygon.append(at)
            polygon += path[:-1]
            at = path[-1]
        if at != start:
            return None
        corners = np.empty((len(polygon), 2))
        for row, point in enumerate(polygon):
            if point >= first:
                corners[row] = step * (point - first), top
            else:
                corners[row] = flat[point]
        corners[:, 0] -= (line + 0.5) * step
        cut = ears(_seen(corners, size, slope))
        if cut is None:
            return None
        found += [(polygon[a], polygon[b], polygon[c]) for a, b, c in cut]
    return found


def _seen(corners: Floats, size: float, slope: float) -> Floats:
    """Return points of a strut, given as angles and heights (q, 2), as the node sees them, (q, 2).

    Triangles that are counter-clockwise there are seen from inside of the solid as they should be.
    """
    angle, height = corners.T
    return np.stack([np.tan(angle), height / ((size + slope * height) * np.cos(angle))], axis=1)


def _island(
    shape: SharpShape, edges: SampledEdges, strut: int, steps: Steps
) -> list[tuple[int, int, int]] | None:
    """Return the triangles of a piece of a strut that is apart from the rest of it."""
    path = _path(edges, steps)
    corners = _unrolled(shape, strut, np.array([edges.points[k] for k in path]))
    corners[:, 0] = np.unwrap(corners[:, 0])
    corners[:, 0] -= (corners[:, 0].min() + corners[:, 0].max()) / 2
    stars = shape.curves.stars
    cut = ears(_seen(corners, float(stars.radii[0, strut]), float(stars.slopes[0, strut])))
    return None if cut is None else [(path[a], path[b], path[c]) for a, b, c in cut]


def _outline(shape: SharpShape, edges: SampledEdges) -> set[tuple[int, int]]:
    """Return the sides of the ball's faces, the ball to their left; cuts are not among them."""
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


def _swelled(points: Points, ball: Triangles, fixed: int, larger: float) -> Points:
    """Return points, those inside of the ball's faces moved for these to have its volume.

    Parameters
    ----------
    fixed : how many of the first points stay
    larger : by how much all lengths are larger in the end
    """
    if len(ball) == 0 or len(points) == fixed:
        return points
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
