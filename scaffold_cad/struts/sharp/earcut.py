"""Small polygons cut into triangles by ears, those with the shortest diagonals first.

manifold3d's `triangulate` takes a fifth of the time, a hundredth of that of a node. But of 73 507
polygons of random nodes it cut 62 with flat or turned triangles, which 32-bit files do not hold;
here 43 of these have others, and the rest none, as they cross themselves.
"""

from __future__ import annotations

from scaffold_cad.base.arrays import Floats

LEAST = 1e-7
"""Least area of an ear, as a part of its sides' squares: three points on a line make none."""

Corner = tuple[float, float]


def ears(corners: Floats) -> list[tuple[int, int, int]] | None:
    """Return the triangles of a simple polygon (n, 2), counter-clockwise, or None if it has none.

    Examples
    --------
    >>> import numpy as np
    >>> ears(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]))
    [(3, 0, 1), (1, 2, 3)]
    """
    points: list[Corner] = [(x, y) for x, y in corners.tolist()]
    left = list(range(len(points)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        best, place = float("inf"), -1
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            size = _square(points[a], points[c])
            if size < best and _is_ear(points, left, a, b, c):
                best, place = size, k
        if place < 0:
            return None
        found.append((left[place - 1], left[place], left[(place + 1) % len(left)]))
        del left[place]
    a, b, c = left
    if not _is_ear(points, left, a, b, c):
        return None
    found.append((a, b, c))
    return found


def _is_ear(points: list[Corner], left: list[int], a: int, b: int, c: int) -> bool:
    p, q, r = points[a], points[b], points[c]
    least = LEAST * (_square(p, q) + _square(q, r) + _square(r, p))
    if _turn(p, q, r) <= least:
        return False
    for other in left:
        if other in (a, b, c):
            continue
        s = points[other]
        if s in (p, q, r):
            continue
        if min(_turn(p, q, s), _turn(q, r, s), _turn(r, p, s)) >= -least:
            return False
    return True


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _square(a: Corner, b: Corner) -> float:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2
