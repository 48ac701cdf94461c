"""Loops around the faces of a star, followed from edge to edge, and how they lie on struts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points, UnitVectors
from scaffold_cad.struts.sharp.curves import StarCurves

SEAMS = 64
"""Generators of a strut that its face's seam may lie on."""

Steps = tuple[tuple[int, bool], ...]
"""Edges, and whether a loop runs along them."""

Loop = tuple[int, Steps]
"""A loop, and its face."""


SHAKE = 0.4
"""Most that such a generator is beside the middle of its part of a turn, in such parts."""


@dataclass(frozen=True, eq=False)
class Ordered:
    """Loops by kind."""

    loops: tuple[Loop, ...]
    """Those around struts, in the order of these, then holes in them, then those of the ball."""
    islands: tuple[Loop, ...]
    """Those around pieces of struts that are apart from the rest."""


def loops_of(ends: Ints, sides: Ints) -> list[Loop] | None:
    """Return the loops of faces, or None where they do not close.

    Where a seam, with one face on both sides, meets a circle, a loop goes on along the other one.
    """
    follows: dict[tuple[int, int, bool], tuple[int, bool]] = {}
    for edge, ((start, end), (left, right)) in enumerate(
        zip(ends.tolist(), sides.tolist(), strict=True)
    ):
        for face, tail, way in ((left, start, True), (right, end, False)):
            if (face, tail, left == right) in follows:
                return None
            follows[face, tail, left == right] = edge, way
    tips, seam = ends.tolist(), (sides[:, 0] == sides[:, 1]).tolist()
    loops: list[Loop] = []
    used: set[tuple[int, int, bool]] = set()
    for first in follows:
        loop, at = [], first
        while at in follows and at not in used:
            used.add(at)
            edge, way = follows[at]
            loop.append((edge, way))
            face, tip = at[0], tips[edge][1 if way else 0]
            turned = face, tip, not seam[edge]
            at = turned if turned in follows else (face, tip, seam[edge])
        if at != first:
            return None
        if loop:
            loops.append((first[0], tuple(loop)))
    return loops


def ordered(curves: StarCurves, loops: list[Loop], points: Points, valency: int) -> Ordered | None:
    """Return the loops, those around struts first, or None where a strut has not just one."""
    around: dict[int, Loop] = {}
    rest: list[Loop] = []
    holes: list[tuple[int, Steps, Floats]] = []
    islands: list[tuple[int, Steps, Floats]] = []
    stars = curves.stars
    for face, steps in loops:
        if face >= valency:
            rest.append((face, steps))
            continue
        path = np.concatenate([points[edge][:: 1 if way else -1][:-1] for edge, way in steps])
        zero = np.zeros(len(path), dtype=np.intp)
        angle = stars.angles(zero, zero + face, path)
        turn = np.mod(np.roll(angle, -1) - angle + np.pi, 2 * np.pi) - np.pi
        turns = round(float(turn.sum()) / (2 * np.pi))
        if turns == 1 and face not in around:
            around[face] = face, steps
        elif turns == 0:
            flat = np.stack([np.unwrap(angle), path @ stars.directions[0, face]], axis=1)
            (islands if area(flat) > 0 else holes).append((face, steps, flat))
        else:
            return None
    if len(around) < valency or any(_holds(one, hole) for one in islands for hole in holes):
        return None
    loops = [
        *(around[strut] for strut in range(valency)),
        *((face, steps) for face, steps, _ in holes),
    ]
    return Ordered((*loops, *rest), tuple((face, steps) for face, steps, _ in islands))


def _holds(island: tuple[int, Steps, Floats], hole: tuple[int, Steps, Floats]) -> bool:
    """Return whether a hole may be in an island of the same strut."""
    if island[0] != hole[0]:
        return False
    shift = 2 * np.pi * np.round((island[2][0, 0] - hole[2][0, 0]) / (2 * np.pi))
    return is_inside(island[2], hole[2][0] + [shift, 0.0])


def area(polygon: Floats) -> float:
    """Return the area of a polygon (q, 2), negative if it is clockwise."""
    x, y = polygon.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def is_inside(polygon: Floats, point: Floats) -> bool:
    """Return whether a point (2,) is in a polygon (q, 2)."""
    x, y = polygon.T
    far_x, far_y = np.roll(x, -1), np.roll(y, -1)
    crosses = (y > point[1]) != (far_y > point[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = x + (point[1] - y) / (far_y - y) * (far_x - x)
    return bool((crosses & (at > point[0])).sum() % 2)


def seam_angles(directions: UnitVectors) -> Floats:
    """Return the angles of the generators on which seams may lie, (..., SEAMS), rad.

    They are near the middles of equal parts of a turn, at an offset that depends on the direction
    (..., 3), so that seams of two struts hardly ever meet an edge of theirs in one place. It is
    odd: seen from the other end of a strut the angles are the same ones, in the other order.
    """
    offset = SHAKE * np.sin(directions @ np.array([12.9898, 78.233, 37.719]))
    return np.asarray(2 * np.pi * (np.arange(SEAMS) + 0.5 + offset[..., None]) / SEAMS)


def clearance(curves: StarCurves, points: Points, sides: Ints, strut: int) -> Floats:
    """Return how far generators of a strut are from its vertices, (SEAMS,), see `SharpShape`."""
    own = points[(sides == strut).any(axis=1)]
    number = np.zeros(own.shape[0] * own.shape[1], dtype=np.intp)
    angle = curves.stars.angles(number, number + strut, own.reshape(-1, 3)).reshape(own.shape[:2])
    angle = np.unwrap(angle, axis=1)
    at = seam_angles(curves.stars.directions[0, strut])
    turns = np.floor((angle[:, :, None] - at) / (2 * np.pi))
    met = np.abs(np.diff(turns, axis=1)).sum(axis=(0, 1))
    away = np.mod(angle[:, [0, -1]].reshape(-1, 1) - at + np.pi, 2 * np.pi) - np.pi
    return np.where(met == 1, np.abs(away).min(axis=0), 0.0)
