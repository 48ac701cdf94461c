"""Columns of a strut: what lies between two generators, from the edges at the node to the ring.

Each loop of edges is cut where it goes from one column to the next.
"""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.struts.sharp.earcut import ears
from scaffold_cad.struts.sharp.loops import Steps
from scaffold_cad.struts.sharp.sampled import SampledEdges
from scaffold_cad.struts.sharp.shapes import SharpShape


def points_along(edges: SampledEdges, steps: Steps) -> list[int]:
    """Return the points along a loop."""
    found: list[int] = []
    for edge, way in steps:
        found += (edges.edges[edge] if way else edges.edges[edge][::-1])[:-1]
    return found


def unrolled(shape: SharpShape, strut: int, points: Points) -> Floats:
    """Return angles in (−π, π] and heights of points (q, 3) on a strut, (q, 2)."""
    zero = np.zeros(len(points), dtype=np.intp)
    angle = shape.curves.stars.angles(zero, zero + strut, points)
    return np.stack([angle, points @ shape.curves.stars.directions[0, strut]], axis=1)


def strut_triangles(
    shape: SharpShape, edges: SampledEdges, strut: int, sides: int, count: int
) -> list[tuple[int, int, int]] | None:
    """Return the triangles of a strut's face up to its ring, or None where columns do not close.

    Parameters
    ----------
    count : number of the first point of rings
    """
    first = count + sides * strut
    loops = [points_along(edges, steps) for face, steps in shape.loops if face == strut]
    used = sorted({point for loop in loops for point in loop})
    flat = dict(
        zip(used, unrolled(shape, strut, np.array([edges.points[k] for k in used])), strict=True)
    )
    size, slope = (
        float(each[0, strut]) for each in (shape.curves.stars.radii, shape.curves.stars.slopes)
    )
    top = float(shape.collars[strut])
    columns = [_Column() for _ in range(sides)]
    lines: list[list[int]] = [[] for _ in range(sides)]
    bridged: dict[int, list[list[int]]] = {}
    for loop in loops:
        lines_of = [edges.on[point].get(strut, -1) for point in loop]
        own: int | None = _leftmost(loop, flat, sides)
        if max(lines_of) >= 0:
            own = _cut_loop(loop, lines_of, columns, lines, sides, flat)
        if own is None:
            return None
        if own >= 0:
            _bridge(loop, flat, own, bridged)
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
        made = _column_triangles(column, flat, first, line, sides, top, size, slope)
        if made is None:
            return None
        found += made
    return found


class _Column:
    """What is around the polygons of a column: from each point on, the points up to the next."""

    def __init__(self) -> None:
        self.links: dict[int, list[int]] = {}


def _cut_loop(
    loop: list[int],
    lines_of: list[int],
    columns: list[_Column],
    lines: list[list[int]],
    sides: int,
    flat: dict[int, Floats],
) -> int | None:
    """Cut a loop where it goes from column to column, and give its pieces to them.

    A loop that only touches a generator, or runs along it, goes on in its column.

    Parameters
    ----------
    lines_of : generator on which each point of the loop is, -1 for none

    Returns
    -------
    -1, or the column in which the whole loop is; None if columns do not follow each other
    """
    count = len(loop)
    cuts = [place for place, line in enumerate(lines_of) if line >= 0]
    pieces = []  # places where they begin and end, and their columns
    for start, end in zip(cuts, [*cuts[1:], cuts[0] + count], strict=True):
        here, there = lines_of[start], lines_of[end % count]
        path = [loop[place % count] for place in range(start + 1, end)]
        column = _column_between(here, there, path, sides, flat)
        if column is None:
            return None
        if path or here != there:  # else along a generator
            pieces.append((start, end, column))
    if not pieces:
        return None
    crossings = []  # places where columns change, and the column that begins there
    for (_, end, before), (start, _, after) in zip(pieces, [*pieces[1:], pieces[0]], strict=True):
        if before != after:
            line = lines_of[end % count]
            shared = range(end, end + (start - end) % count + 1)
            # To the right of the way is what the loop bounds, so that it is above if that leads on.
            pick = max if after == line else min
            place = pick(shared, key=lambda place: flat[loop[place % count]][1])
            crossings.append((place % count, after))
            lines[line].append(loop[place % count])
    if not crossings:
        return pieces[0][2]
    for (start, column), (end, _) in zip(crossings, [*crossings[1:], crossings[0]], strict=True):
        span = (end - start - 1) % count + 1
        if loop[start] in columns[column].links:
            return None
        path = [loop[(start + step) % count] for step in range(1, span + 1)]
        columns[column].links[loop[start]] = path
    return -1


def _leftmost(loop: list[int], flat: dict[int, Floats], sides: int) -> int:
    """Return the column of the left end of a loop."""
    angles = np.unwrap([flat[point][0] for point in loop])
    return int(np.floor(angles.min() * sides / (2 * np.pi))) % sides


def _column_between(
    here: int, there: int, path: list[int], sides: int, flat: dict[int, Floats]
) -> int | None:
    """Return the column of a path from one generator to another, 0 if there is no path."""
    if (there - here) % sides == 1:
        return here
    if (here - there) % sides == 1:
        return there
    if here != there:
        return None
    turns = [np.sin(flat[point][0] - here * 2 * np.pi / sides) for point in path]
    return here if max(turns, default=0.0, key=abs) >= 0 else (here - 1) % sides


def _bridge(
    loop: list[int], flat: dict[int, Floats], line: int, bridged: dict[int, list[list[int]]]
) -> None:
    """Add a hole that is within a column to the generator on its left, from its left end on."""
    angles = np.unwrap([flat[point][0] for point in loop])
    first = int(np.argmin(angles))
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
        cut = ears(seen(corners, size, slope))
        if cut is None:
            return None
        found += [(polygon[a], polygon[b], polygon[c]) for a, b, c in cut]
    return found


def seen(corners: Floats, size: float, slope: float) -> Floats:
    """Return points of a strut, given as angles and heights (q, 2), as the node sees them, (q, 2).

    Triangles that are counter-clockwise there are seen from inside of the solid as they should be.
    """
    angle, height = corners.T
    return np.stack([np.tan(angle), height / ((size + slope * height) * np.cos(angle))], axis=1)
