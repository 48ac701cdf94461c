"""Triangles on a sphere: the hull of points, with given sides among them, cut out along these."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from scaffold_cad.base.arrays import Floats, Ints, Points, Triangles

FLAT = 1e-9
"""Thickness of points that are in a plane, in radii of the sphere."""

TRIES = 200
"""Sides that are exchanged for one that is missing, at most."""


def cut_out(points: Points, outline: set[tuple[int, int]]) -> Triangles | None:
    """Return the triangles left of `outline`, or None where there are none with its sides.

    Parameters
    ----------
    points : (n, 3) on the unit sphere, those inside of the outline among them
    outline : sides around what is wanted, which is to their left
    """
    across = _hull(points)
    if across is None:
        return None
    for a, b in sorted(outline):
        if (a, b) not in across and not _recovered(across, points, a, b):
            return None
    found: set[tuple[int, int, int]] = set()
    stack = [(a, b, across[a, b]) for a, b in outline]
    seen: set[tuple[int, int]] = set()
    while stack:
        a, b, c = stack.pop()
        if (a, b) in seen:
            continue
        seen |= {(a, b), (b, c), (c, a)}
        found.add((a, b, c))
        for p, q in ((a, b), (b, c), (c, a)):
            if (q, p) in outline:
                return None  # what is not wanted was reached
            if (p, q) not in outline and (q, p) not in seen:
                stack.append((q, p, across[q, p]))
    return np.array(sorted(found), dtype=np.intp)


def _hull(points: Points) -> dict[tuple[int, int], int] | None:
    """Return the third corner of the triangle to the left of each side of the hull."""
    if len(points) < 4 or np.ptp(_heights(points)) < FLAT:
        return None
    hull = ConvexHull(points)
    corners = points[hull.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("tx,tx->t", normal, hull.equations[:, :3]) < 0
    simplices = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    across: dict[tuple[int, int], int] = {}
    for a, b, c in simplices.tolist():
        across[a, b], across[b, c], across[c, a] = c, a, b
    return across if len(across) == 3 * len(simplices) else None


def _heights(points: Points) -> Floats:
    """Return how far points are from the plane that is nearest to them, (n,)."""
    from_middle = points - points.mean(axis=0)
    return np.asarray(from_middle @ np.linalg.svd(from_middle, full_matrices=False)[2][-1])


def _recovered(across: dict[tuple[int, int], int], points: Points, a: int, b: int) -> bool:
    """Exchange sides that cross a missing one for others; return whether it is there now."""
    waiting = _crossed(across, points, a, b)
    for _ in range(TRIES):
        if (a, b) in across:
            return True
        if not waiting:
            return False
        p, q = waiting.pop(0)
        r, s = across[p, q], across[q, p]
        if not _is_convex(points[[p, s, q, r]]):
            waiting.append((p, q))
            continue
        del across[p, q], across[q, p]
        for i, j, k in ((r, s, q), (s, r, p)):
            across[i, j], across[j, k], across[k, i] = k, i, j
        if len({a, b, r, s}) == 4 and _cross(points, a, b, np.array([[r, s]]))[0]:
            waiting.append((r, s))
    return (a, b) in across


def _crossed(
    across: dict[tuple[int, int], int], points: Points, a: int, b: int
) -> list[tuple[int, int]]:
    """Return the sides that cross the arc from a to b."""
    sides = np.array([side for side in sorted(across) if side[0] < side[1]])
    free = ((sides != a) & (sides != b)).all(axis=1)
    sides = sides[free]
    return [(p, q) for p, q in sides[_cross(points, a, b, sides)].tolist()]


def _cross(points: Points, a: int, b: int, sides: Ints) -> np.ndarray:
    """Return whether sides (n, 2) cross the arc from a to b, (n,)."""
    p, q = points[sides[:, 0]], points[sides[:, 1]]
    normal = np.cross(points[a], points[b])
    own = np.cross(p, q)
    found = (p @ normal) * (q @ normal) < 0
    found &= (own @ points[a]) * (own @ points[b]) < 0
    return np.asarray(found & ((p + q) @ (points[a] + points[b]) > 0))


def _is_convex(corners: Points) -> bool:
    """Return whether a polygon (4, 3) on the sphere turns to the left at each corner."""
    following, after = np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0)
    turn = np.einsum("cx,cx->c", np.cross(corners, following), after)
    return bool((turn > 1e-12).all())
