"""Samples of nodes, moved aside where triangles between them do not face away from their node.

A surface that is star-shaped has samples that fold where it turns fast beside its node's view: in
narrow crotches, between few samples. A triangle (a, b, c) is seen where det(a, b, c) > 0, which is
linear in each of its corners: so each is moved straight to where the triangle is seen, all at once,
again and again (the relaxation method of Agmon, 1954, and Motzkin and Schoenberg, 1954), until all
are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Frozen, Ints
from scaffold_cad.base.blocks import CACHE, cut
from scaffold_cad.base.vectors import length, normalize, sums_by_row, triple

LEAST = 1e-8
"""Triangles are seen at sines of more than this."""

GOAL = 0.16
"""What triangles that were folded are moved to, over the sides of a ring: part of the square of
their longest side, as seen from the node."""

ROUNDS = 60
"""Times that samples are moved; nodes that are folded then are left as they were."""

TINY = 1e-12
"""Least square of the slope of a sine: where it is less all corners stay."""

TRIANGLE_BYTES = 512
"""What a triangle takes while that is done."""


@dataclass(frozen=True, eq=False)
class Faced(Frozen):
    """Samples of K nodes that were moved aside."""

    points: Floats
    """Relative to the nodes, shape (K, b, 3), mm."""
    aside: Floats
    """How far the one is that was moved furthest, shape (K,), mm."""


def faced(points: Floats, triangles: Ints, fixed: Ints, sides: int) -> Faced:
    """Return samples of nodes so that all triangles between them are seen from their node.

    Parameters
    ----------
    points : (K, b, 3) samples relative to their nodes, mm
    triangles : (K, t, 3) of samples, in 0..b-1
    fixed : (K, f) samples that stay
    sides : points of a ring
    """
    found = points.copy()
    for part in cut(np.arange(len(points)), triangles[0].size // 3 * TRIANGLE_BYTES, CACHE):
        folded = part[_are_folded(points[part], triangles[part])]
        if len(folded) == 0:
            continue
        moved = _relaxed(points[folded], triangles[folded], fixed[folded], GOAL / sides)
        seen = ~_are_folded(moved, triangles[folded])
        found[folded[seen]] = moved[seen]
    return Faced(found, length(found - points).max(axis=1))


def _are_folded(points: Floats, triangles: Ints) -> Bools:
    """Return whether nodes have triangles that are not seen, (K,)."""
    corners = normalize(points)[np.arange(len(points))[:, None, None], triangles]  # (K, t, 3, 3)
    a, b, c = np.moveaxis(corners, 2, 0)
    return np.asarray((triple(a, b, c) < LEAST).any(axis=1))


def _relaxed(points: Floats, triangles: Ints, fixed: Ints, goal: float) -> Floats:
    """Return the samples of nodes, moved until triangles are seen or for all rounds.

    Parameters
    ----------
    points, triangles, fixed : of F nodes, as for `faced`
    goal : part of the square of their longest side
    """
    count, block = points.shape[:2]
    first = block * np.arange(count)[:, None]
    corners = (triangles + first[..., None]).reshape(-1, 3)
    is_free = np.ones((count * block, 1), dtype=np.bool_)
    is_free[(fixed + first).reshape(-1)] = False
    moved = points.reshape(-1, 3).copy()
    was_folded = np.zeros(len(corners), dtype=np.bool_)
    for _ in range(ROUNDS):
        spokes = moved[corners]  # (F t, 3, 3)
        ways = normalize(spokes)
        sines = triple(ways[:, 0], ways[:, 1], ways[:, 2])
        wanted = goal * _longest(ways)
        was_folded |= sines < LEAST
        # Nodes are done one by one: what becomes of one does not depend on others.
        low = (was_folded & (sines < wanted / 2)).reshape(count, -1)
        if not low.any():
            break
        open_nodes = np.repeat(low.any(axis=1), triangles.shape[1])
        some = np.flatnonzero(open_nodes & was_folded & (sines < wanted))
        slopes = np.cross(np.roll(ways[some], -1, axis=1), np.roll(ways[some], -2, axis=1))
        slopes -= sines[some, None, None] * ways[some]
        slopes *= is_free[corners[some]] / length(spokes[some])[..., None]
        steps = (wanted - sines)[some] / np.maximum((slopes**2).sum(axis=(1, 2)), TINY)
        moved += sums_by_row(steps[:, None, None] * slopes, corners[some], len(moved))
    return moved.reshape(points.shape)


def _longest(ways: Floats) -> Floats:
    """Return the squares of the longest sides of triangles of unit vectors (k, 3, 3), (k,)."""
    sides = ways - np.roll(ways, 1, axis=1)
    longest: Floats = (sides**2).sum(axis=2).max(axis=1)
    return longest
