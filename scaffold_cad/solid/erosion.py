"""Solids without what is near their surface: walls where a moved surface does not do."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Ints, UnitVectors
from scaffold_cad.base.topology import neighbors
from scaffold_cad.base.vectors import angle_between, normalize, triple
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid import manifolds

if TYPE_CHECKING:
    from manifold3d import Manifold

BALL_SEGMENTS = 20
"""Sides of the great circles of the ball that is taken away at the ends of hollow edges."""

HOLLOW = 0.3
"""Least turn at a hollow edge between whose faces material is taken away, rad: less is 1 % off."""

HALVED = 2
"""How often the turn at a hollow edge is halved: what is between is 2 % off at right angles."""

SIMPLER = 0.03
"""How far a body may be simplified for an eroded wall, in thicknesses of the wall."""

EROSION_TIME = 0.0035
"""Time that a triangle takes in the erosion, s."""

MOST_TO_ERODE = 100_000
"""Most triangles that are eroded: some minutes."""

SOON = 1.0
"""What takes no longer needs no word, s."""

_log = logging.getLogger(__name__)


def eroded(manifold: Manifold, thickness: float) -> Manifold:
    """Return what lies at least `thickness` inside the surface, about; for any shape, but slow.

    What is taken away is the hull of each triangle and of what is the thickness away from its
    corners along the normals of all triangles there: so walls at faces are exact. Where faces
    meet at a hollow edge, it goes along ways between their normals too.

    Raises
    ------
    MeshError
        If it would take too long.
    """
    simpler = _simplified(manifold, thickness)
    mesh = manifolds.manifold_triangles(simpler)
    vertex, way = _ways(mesh)
    order = np.argsort(vertex, kind="stable")
    places = mesh.vertices[vertex[order]] + thickness * way[order]
    around = np.split(places, np.cumsum(np.bincount(vertex))[:-1])  # those of each vertex
    near = [np.concatenate([around[k] for k in corners]) for corners in mesh.triangles.tolist()]
    return simpler - manifolds.union([], near)


def _simplified(manifold: Manifold, thickness: float) -> Manifold:
    """Return a solid without triangles that its shape does not need; say how long they will take.

    Raises
    ------
    MeshError
        If there are too many left.
    """
    simpler = manifold.simplify(SIMPLER * thickness)
    count = simpler.num_tri()
    if count > MOST_TO_ERODE:
        raise MeshError(
            f"a wall of {thickness:g} mm in a curved body has {count} triangles to be made from; "
            f"need {MOST_TO_ERODE} or fewer (a coarser mesh of the body)"
        )
    seconds = count * EROSION_TIME
    level = logging.INFO if seconds > SOON else logging.DEBUG
    _log.log(
        level, "a wall of %g mm is made from %d triangles: some %.0f s", thickness, count, seconds
    )
    return simpler


def _ways(mesh: TriangleMesh) -> tuple[Ints, UnitVectors]:
    """Return the vertices that material is taken away from, (w,), and in which directions, (w, 3).

    They go into the solid along the normals at each vertex, where faces meet at a hollow edge also
    along those `_between` them and to all sides, and to six sides, so that neighbors overlap.
    """
    corners = mesh.vertices[mesh.triangles]
    ahead = np.roll(corners, -1, axis=1) - corners  # (t, 3, 3), along the sides
    own = normalize(np.cross(ahead[:, 1], ahead[:, 0]))[:, None].repeat(3, axis=1)
    beyond = own[neighbors(mesh.triangles, len(mesh.vertices)), 0]  # (t, 3, 3)
    is_hollow = (triple(own, beyond, ahead) < 0.0) & (angle_between(own, beyond) > HOLLOW)
    between = _between(own[is_hollow], beyond[is_hollow])  # (h, n, 3)
    start = mesh.triangles[is_hollow]  # the next triangle has the side's end
    everywhere, hollow = np.arange(len(mesh.vertices)), np.unique(start)
    ball, cross = (manifolds.ball_corners(segments) for segments in (BALL_SEGMENTS, 4))
    vertices = [
        mesh.triangles.reshape(-1),
        np.repeat(start, between.shape[1]),
        np.repeat(np.roll(mesh.triangles, -1, axis=1)[is_hollow], between.shape[1]),
        np.repeat(everywhere, len(cross)),
        np.repeat(hollow, len(ball)),
    ]
    ways = [
        own.reshape(-1, 3),
        between.reshape(-1, 3),
        between.reshape(-1, 3),
        np.tile(cross, (len(everywhere), 1)),
        np.tile(ball, (len(hollow), 1)),
    ]
    return np.concatenate(vertices), np.concatenate(ways)


def _between(first: UnitVectors, second: UnitVectors) -> UnitVectors:
    """Return directions between pairs of directions (h, 3), evenly, (h, n, 3)."""
    ways = np.stack([first, second], axis=1)
    for _ in range(HALVED):
        middle = normalize(ways[:, :-1] + ways[:, 1:])
        ways = np.insert(ways, range(1, ways.shape[1]), middle, axis=1)
    return ways[:, 1:-1]
