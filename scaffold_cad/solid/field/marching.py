"""Marching tetrahedra: which edges of a tetrahedron the surface cuts, and in which order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from scaffold_cad.base.arrays import Bools, Ints

SIDES = np.array(list(combinations(range(4), 2)))
"""Corners of each edge of a tetrahedron, shape (6, 2)."""

_PLACES = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])  # positively oriented


def _edges_cut(mask: int) -> list[int]:
    """Return the edges cut where the corners in `mask` are inside, around, seen from outside."""
    signs = np.array([mask >> i & 1 for i in range(4)])
    edges = [e for e, (i, j) in enumerate(SIDES) if signs[i] != signs[j]]
    if not edges:
        return []
    if len(edges) == 4:  # neighbors around share a corner of the tetrahedron
        far = next(i for i in range(1, 4) if not set(SIDES[edges[0]]) & set(SIDES[edges[i]]))
        beside = [i for i in range(1, 4) if i != far]
        edges = [edges[i] for i in (0, beside[0], far, beside[1])]
    outward = _PLACES[signs == 0].mean(axis=0) - _PLACES[signs == 1].mean(axis=0)
    middles = _PLACES[SIDES[edges]].mean(axis=1)
    normal = np.cross(middles[1] - middles[0], middles[2] - middles[0])
    return edges if normal @ outward > 0 else edges[::-1]


CUTS = [_edges_cut(mask) for mask in range(16)]
"""Edges cut for each set of corners inside, counter-clockwise seen from outside."""


@dataclass(frozen=True, eq=False)
class Polygons:
    """Triangles and quads whose corners are numbers of edges."""

    triangles: Ints
    """Shape (t, 3)."""
    quads: Ints
    """Shape (q, 4)."""

    @staticmethod
    def joined(parts: Sequence[Polygons]) -> Polygons:
        """Return the polygons of all parts."""
        return Polygons(
            np.concatenate([np.zeros((0, 3), dtype=np.intp), *(p.triangles for p in parts)]),
            np.concatenate([np.zeros((0, 4), dtype=np.intp), *(p.quads for p in parts)]),
        )


def cut(inside: Sequence[Bools], edges: Sequence[Ints]) -> Polygons:
    """Return what cuts tetrahedra.

    Parameters
    ----------
    inside : 4 arrays (t,), whether each corner is inside; the corners are positively oriented
    edges : 6 arrays (t,), numbers of the edges, in the order of `SIDES`
    """
    mask = np.zeros(len(inside[0]), dtype=np.uint8)
    for i, marks in enumerate(inside):
        mask |= marks.astype(np.uint8) << np.uint8(i)
    rows = np.flatnonzero((mask > 0) & (mask < 15))
    rows = rows[np.argsort(mask[rows], kind="stable")]
    bounds = np.searchsorted(mask[rows], np.arange(17))
    found: dict[int, list[Ints]] = {3: [], 4: []}
    for number in range(1, 15):
        some = rows[bounds[number] : bounds[number + 1]]
        if len(some):
            corners = np.stack([edges[e][some] for e in CUTS[number]], axis=1)
            found[corners.shape[1]].append(corners)
    return Polygons(
        np.concatenate([np.zeros((0, 3), dtype=np.intp), *found[3]]),
        np.concatenate([np.zeros((0, 4), dtype=np.intp), *found[4]]),
    )
