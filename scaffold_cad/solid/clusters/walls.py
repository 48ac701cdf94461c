"""Walls of hollow struts as thick as asked: the inside moves away from where the outside is near.

Both surfaces are cut from grids, and fillets between struts at narrow angles are not exactly
parallel, so walls are thin in places. There the vertices inside move away from the nearest place
outside, but for those whose triangles would then cross others.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Bools, Floats, Ints, Points
from scaffold_cad.base.positions import in_single_precision
from scaffold_cad.base.vectors import length, normalize, sums_by_row
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.nearest import NearestPlace
from scaffold_cad.mesh.trianglemesh import TriangleMesh

ENOUGH = 0.97
"""What is thinner than this part of the wall is thickened."""

ROUNDS = 6
"""Times that vertices move; each time other places may be the nearest ones."""

BETWEEN = np.array([[1, 1, 1], [0, 1.5, 1.5], [1.5, 0, 1.5], [1.5, 1.5, 0]]) / 3
"""Where triangles are looked at: in their middles and at those of their sides."""

LARGE = 4.0
"""Size of the pieces of triangles that nearest places are looked for in, in walls."""

NEAR = 2.0
"""How far from the inside triangles are looked at, in walls."""

TRIES = 6
"""Times that vertices whose triangles cross are put back."""

BACK = 0.4
"""What is left of their way each time."""


def thickened(
    mesh: TriangleMesh, outer: Ints, inner: Ints, fixed: Ints, wall: float, factor: float
) -> TriangleMesh:
    """Return hollow struts with walls that are hardly thinner than `wall` where they may move.

    Parameters
    ----------
    mesh : free of crossings
    outer, inner : numbers of its triangles outside, and of those inside, which share no vertex
    fixed : vertices that stay where they are
    factor : what lengths are multiplied with in a file, in whose 32-bit numbers triangles are
        looked at
    """
    moves = np.zeros(len(mesh.vertices), dtype=np.bool_)
    moves[mesh.triangles[inner]] = True
    moves[fixed] = False
    if not moves.any():
        return mesh
    corners = _pieces(mesh.vertices[mesh.triangles[outer]], mesh.vertices[moves], wall)
    outside = NearestPlace(
        TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    )
    way = _moved(mesh, mesh.triangles[inner], outside, moves, wall) - mesh.vertices
    moved = mesh.vertices[way.any(axis=1)]
    near = mesh.triangles[_near(mesh.vertices[mesh.triangles], moved, wall)]
    for _ in range(TRIES):
        vertices = in_single_precision(mesh.vertices + way, factor) / factor
        vertices = np.where(way.any(axis=1, keepdims=True), vertices, mesh.vertices)
        written = in_single_precision(vertices, factor)
        crossing = np.unique(self_intersections(TriangleMesh(written, near)))
        if len(crossing) == 0:
            return TriangleMesh(vertices, mesh.triangles)
        way[_beside(mesh, near[crossing])] *= BACK
    return mesh


def _pieces(corners: Floats, points: Points, wall: float) -> Floats:
    """Return what of triangles (t, 3, 3) is near some points, in pieces of about one size."""
    pieces = []
    most = max(LARGE * wall, float(np.median(_sides(corners).max(axis=1))))
    while len(corners):
        corners = corners[_near(corners, points, wall)]
        sides = _sides(corners)
        large: Bools = np.asarray(sides.max(axis=1) > most)
        pieces.append(corners[~large])
        corners, longest = corners[large], sides[large].argmax(axis=1)
        turn = (longest[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(corners, turn[..., None], axis=1), 1, 0)
        half = (a + b) / 2
        corners = np.concatenate([np.stack([a, half, c], axis=1), np.stack([half, b, c], axis=1)])
    return np.concatenate(pieces)


def _near(corners: Floats, points: Points, wall: float) -> Bools:
    """Return which triangles (t, 3, 3) may have one of some points within `NEAR` walls, (t,)."""
    if len(points) == 0:
        return np.zeros(len(corners), dtype=np.bool_)
    middle = corners.mean(axis=1)
    reach = length(corners - middle[:, None]).max(axis=1) + NEAR * wall
    far = cKDTree(points).query(middle, distance_upper_bound=float(reach.max(initial=0.0)))[0]
    return np.asarray(far < reach)


def _dents(vertices: Points, faces: Ints) -> Bools:
    """Return which triangles (t, 3) inside may be nearer to the outside than their corners, (t,).

    Seen from the wall these stand out: the normals of their corners lean toward their middles.
    """
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = sums_by_row(np.repeat(normal, 3, axis=0), faces.reshape(-1), len(vertices))
    lean = (normalize(sums)[faces] * (corners - corners.mean(axis=1, keepdims=True))).sum(axis=2)
    return np.asarray(lean.sum(axis=1) > 0)


def _sides(corners: Floats) -> Floats:
    """Return the lengths of the sides of triangles (t, 3, 3), from each corner to the next."""
    return length(np.roll(corners, -1, axis=1) - corners)


def _moved(
    mesh: TriangleMesh, inner: Ints, outside: NearestPlace, moves: Bools, wall: float
) -> Points:
    """Return the vertices (v, 3) with those inside that are too near to the outside moved away."""
    vertices = mesh.vertices.copy()
    looked = np.flatnonzero(moves)
    faces = inner[moves[inner].any(axis=1)]
    for _ in range(ROUNDS):
        away = np.zeros_like(vertices)
        away[looked] = _lacking(outside, vertices[looked], wall)
        dents = faces[_dents(vertices, faces)]
        for weights in BETWEEN:
            way = _lacking(outside, weights @ vertices[dents], wall)
            thin = np.flatnonzero(way.any(axis=1))
            for corner, weight in zip(dents[thin].T, weights, strict=True):
                larger = (weight > 0) & (length(way[thin]) > length(away[corner]))
                away[corner[larger]] = way[thin][larger]
        away[~moves] = 0.0
        some: Bools = np.asarray(away.any(axis=1))
        if not some.any():
            break
        vertices += away
        # Where a vertex moved the next ones may be too near.
        near = np.flatnonzero(some[faces].any(axis=1))
        faces = faces[near]
        looked = np.unique(faces)
        looked = looked[moves[looked]]
    return vertices


def _lacking(outside: NearestPlace, points: Points, wall: float) -> Floats:
    """Return how points that are too near to the outside are to move, (k, 3), mm."""
    way = points - outside.nearest(points)
    far = length(way)
    lacks: Bools = np.asarray((far < ENOUGH * wall) & (far > 0))
    share = np.where(lacks, wall / np.where(lacks, far, 1.0) - 1.0, 0.0)
    return np.asarray(share[:, None] * way)


def _beside(mesh: TriangleMesh, triangles: Ints) -> Bools:
    """Return the vertices of some triangles and those next to them, (v,)."""
    marks = np.zeros(len(mesh.vertices), dtype=np.bool_)
    marks[triangles] = True
    beside = np.flatnonzero(marks[mesh.triangles].any(axis=1))
    marks[mesh.triangles[beside]] = True
    return marks
