"""Triangle meshes with fewer triangles: edges drawn together where that moves the surface little.

Cheap edges first, more costly ones stage by stage. Where triangles cross at the end of a stage,
their vertices stay, and the connected pieces that they are of go through that stage again.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.mesh.contraction import Contractible, Contraction, planes_of
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh

SHARES = (1 / 16, 1 / 4, 1.0)
"""What of the tolerance, squared, may be used up: first by the edges that cost least."""

TRIES = 6
"""Times that a stage is done again, with more vertices that stay."""


def decimated(
    mesh: TriangleMesh, tolerance: Floats, fixed: Ints, most: tuple[int, ...] = ()
) -> TriangleMesh:
    """Return a mesh without crossings with fewer triangles, free of crossings too.

    Parameters
    ----------
    tolerance : (v,) how far the surface may move at each vertex, by the root of the mean, mm
    fixed : (k,) vertices that stay where they are, and keep their order
    most : triangles; where there are more than the first number tolerances double, where there are
        more than the second then they double again, and so on. What each ends with has no crossings
    """
    stays = np.zeros(len(mesh.vertices), dtype=np.bool_)
    stays[fixed] = True
    stays[mesh.faulty_sides()[1]] = True  # on a border
    # What is looked up together is then together in the cache.
    corners = np.ascontiguousarray(mesh.triangles[np.argsort(mesh.triangles[:, 0])].T)
    middle = mesh.vertices.mean(axis=0)
    points = mesh.vertices - middle
    found = Contractible(points, corners, stays, tolerance, planes_of(points, corners))
    found = _without_crossings(found, SHARES)
    for k, number in enumerate(most, start=1):
        if found.corners.shape[1] > number:
            found = _without_crossings(found, (4.0**k,))
    return TriangleMesh(found.points + middle, found.corners.T)


def _without_crossings(start: Contractible, shares: tuple[float, ...]) -> Contractible:
    """Return the mesh with edges drawn together that use up so much of the tolerance."""
    stays, work = start.stays, Contraction(start, start.stays)
    work.run(shares)
    for _ in range(TRIES):
        found = work.compacted(start.stays)
        crossing = np.unique(self_intersections(TriangleMesh(found.points, found.corners.T)))
        if len(crossing) == 0:
            return found
        of_crossing = np.zeros_like(stays)
        of_crossing[work.corners[:, crossing]] = True
        stays = stays | of_crossing[work.target]
        work = _again(start, work, of_crossing, stays, shares)
    return start


def _again(
    start: Contractible, done: Contraction, crossing: Bools, stays: Bools, shares: tuple[float, ...]
) -> Contraction:
    """Return a mesh whose pieces with vertices of triangles that cross, (v,), are done again."""
    piece = _pieces(start.corners, len(stays))
    crossed = np.zeros(len(stays), dtype=np.bool_)
    crossed[piece[crossing]] = True
    again = crossed[piece]  # (v,)
    work = Contraction(replace(start, corners=start.corners[:, again[start.corners[0]]]), stays)
    work.run(shares)
    for own, other in (
        (work.points, done.points),
        (work.planes, done.planes),
        (work.tolerance, done.tolerance),
        (work.target, done.target),
    ):
        own[~again] = other[~again]
    kept = done.corners[:, ~again[done.corners[0]]]
    work.corners = np.concatenate([work.corners, kept], axis=1)
    return work


def _pieces(corners: Ints, count: int) -> Ints:
    """Return the connected piece to which each of `count` vertices belongs, (v,)."""
    a, b, c = corners
    ends = np.append(a, b), np.append(b, c)
    links = coo_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(count, count))
    return connected_components(links, directed=False)[1].astype(np.intp)
