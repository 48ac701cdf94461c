"""Convex bodies around struts and stubs, and whether they keep apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.arrays import Bools, Edges, Floats, Ints, Points
from scaffold_cad.base.blocks import cut
from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.base.vectors import normalize
from scaffold_cad.base.visibility import MARGIN

PAIR_BYTES = 6400
"""What a pair of bodies takes where it is looked at."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """Convex bodies around segments, padded to the same number of points and planes."""

    points: Points
    """Corners, some repeated, shape (k, 10, 3)."""
    normals: Floats
    """Normals of faces, not of length 1, some 0, shape (k, 8, 3)."""
    axis: Points
    """Ends of the segment inside, shape (k, 2, 3)."""
    ends: Edges
    """Nodes of the skeleton that the strut or stub belongs to; bodies of one node keep apart
    by its cones, shape (k, 2)."""
    owner: Ints
    """Edge of the skeleton, shape (k,)."""
    node: Ints
    """Branch point of a stub, -1 for a tube, shape (k,)."""

    def only(self, rows: Bools | Ints) -> Bodies:
        """Return some of the bodies."""
        return Bodies(
            self.points[rows],
            self.normals[rows],
            self.axis[rows],
            self.ends[rows],
            self.owner[rows],
            self.node[rows],
        )


def conflicting(bodies: Bodies, rounding: float, among: Bools | None = None) -> Edges:
    """Return pairs of bodies without a common node that no plane tried keeps apart, (k, 2).

    Coordinates are off by up to `rounding`, mm. With `among`, only pairs in which one body is
    marked.
    """
    low, high = bodies.points.min(axis=1) - rounding, bodies.points.max(axis=1) + rounding
    found = [np.zeros((0, 2), dtype=np.intp)]
    if among is not None and not among.any():
        return found[0]
    for first, second in overlapping_boxes(low, high):
        a, b = bodies.ends[first], bodies.ends[second]
        apart = (a[:, :, None] != b[:, None, :]).all(axis=(1, 2))
        if among is not None:
            apart &= among[first] | among[second]
        pairs = np.stack([first[apart], second[apart]], axis=1)
        found += [part[_meet(bodies, part, rounding)] for part in cut(pairs, PAIR_BYTES)]
    return np.concatenate(found)


def _meet(bodies: Bodies, pairs: Edges, rounding: float) -> Bools:
    """Return whether no plane tried separates each pair of bodies, (k,).

    Tried are the plane across the shortest way between the axes and the planes of the faces.
    """
    i, j = pairs.T
    near, far = nearest_on_segments(
        *np.moveaxis(bodies.axis[i], 1, 0), *np.moveaxis(bodies.axis[j], 1, 0)
    )
    meet = _overlap(bodies, i, j, (far - near)[:, None, :], rounding)
    rest = np.flatnonzero(meet)
    i, j = i[rest], j[rest]
    planes = np.concatenate([bodies.normals[i], bodies.normals[j]], axis=1)
    meet[rest] = _overlap(bodies, i, j, planes, rounding)
    return meet


def _overlap(bodies: Bodies, i: Ints, j: Ints, planes: Floats, rounding: float) -> Bools:
    """Return whether bodies overlap seen along each of `planes` (k, q, 3), (k,)."""
    directions = np.swapaxes(normalize(planes), 1, 2)  # (k, 3, q)
    a, b = bodies.points[i] @ directions, bodies.points[j] @ directions  # (k, 10, q)
    size = np.ptp(bodies.points[i], axis=1).max(axis=1, initial=0.0)
    margin = MARGIN * size + 2.0 * rounding
    gap = np.maximum(b.min(axis=1) - a.max(axis=1), a.min(axis=1) - b.max(axis=1))  # (k, q)
    return np.asarray((gap <= margin[:, None]).all(axis=1))
