"""Necks of closed surfaces: loops of three short edges that are no triangle.

Drawing such an edge together would pinch the surface, and rounding lets the sheets around it cross.
Unions leave necks of a few roundings where faces nearly meet in one point.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Bools
from scaffold_cad.base.topology import sides_of
from scaffold_cad.base.vectors import length
from scaffold_cad.mesh.trianglemesh import TriangleMesh

Loop: TypeAlias = tuple[int, int, int]
"""Three vertices, each joined to the next."""


def without_necks(mesh: TriangleMesh, longest: float, near: Bools) -> TriangleMesh:
    """Return a closed mesh cut along its necks, a triangle across both ends of each.

    Vertices of necks then are twice at their place. What both sides of a neck were joined by may be
    a handle, which goes, or all that joined two bodies, which are two then.

    Parameters
    ----------
    longest : edge of a neck, mm
    near : (v,) bool; only loops of these vertices are looked at
    """
    loops = _loops(mesh, longest, near)
    if not loops:
        return mesh
    wanted = np.zeros(len(mesh.vertices), dtype=np.bool_)
    wanted[np.unique(loops)] = True
    rows = np.flatnonzero(wanted[mesh.triangles].any(axis=1))
    fans: dict[int, dict[int, tuple[int, int]]] = {}
    for row, corners in zip(rows.tolist(), mesh.triangles[rows].tolist(), strict=True):
        for k, vertex in enumerate(corners):
            fans.setdefault(vertex, {})[corners[k - 2]] = row, corners[k - 1]
    triangles = mesh.triangles.copy()
    doubled: list[int] = []
    more: list[list[int]] = []
    for loop in loops:
        own = [len(mesh.vertices) + len(doubled) + k for k in range(3)]
        doubled += loop
        for k, vertex in enumerate(loop):
            for row in _turn(fans[vertex], loop[k - 2], loop[k - 1]):
                triangles[row][mesh.triangles[row] == vertex] = own[k]
        more += [list(loop), own[::-1]]
    return TriangleMesh(
        np.concatenate([mesh.vertices, mesh.vertices[doubled]]), np.concatenate([triangles, more])
    )


def _loops(mesh: TriangleMesh, longest: float, near: Bools) -> list[Loop]:
    """Return loops of three short edges that are no triangle, no vertex in two of them."""
    rows = mesh.triangles[near[mesh.triangles].any(axis=1)]
    ends = sides_of(rows)
    ends = ends[near[ends].all(axis=1) & (ends[:, 0] < ends[:, 1])]
    short = length(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]]) < longest
    after: dict[int, set[int]] = {}
    for a, b in np.unique(ends[short], axis=0).tolist():
        after.setdefault(a, set()).add(b)
    whole = {(a, b, c) for a, b, c in np.sort(rows, axis=1).tolist()}
    found: list[Loop] = []
    taken: set[int] = set()
    for a, following in after.items():
        for b in sorted(following):
            for c in sorted(following & after.get(b, set())):
                if (a, b, c) not in whole and not taken & {a, b, c}:
                    found.append((a, b, c))
                    taken |= {a, b, c}
    return found


def _turn(fan: dict[int, tuple[int, int]], first: int, last: int) -> Iterator[int]:
    """Yield the triangles around a vertex from one neighbor to another, counter-clockwise.

    Parameters
    ----------
    fan : the triangle after each neighbor, and the neighbor after that
    """
    while first != last:
        row, first = fan[first]
        yield row
