"""Solids without what is near their surface: walls where a moved surface does not do."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import UnitVectors
from scaffold_cad.base.topology import neighbors
from scaffold_cad.base.vectors import angle_between, normalize, triple
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid import manifolds

if TYPE_CHECKING:
    from manifold3d import Manifold

BALL_SEGMENTS = 12
"""Sides of the great circles of the ball that is taken away at corners."""

HOLLOW = 0.25
"""Least turn at a hollow edge between whose faces material is taken away, rad: less is 1 % off."""

HALVED = 3
"""How often the turn at a hollow edge is halved: what is between is 2 % off at most."""

SIMPLER = 0.02
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

    What is taken away is the hull of each triangle moved by the thickness: along its own normal,
    so that walls at faces are exact, along ways between it and those beyond its hollow edges, and
    to all sides by a ball inscribed in the true one.

    Raises
    ------
    MeshError
        If it would take too long.
    """
    simpler = _simplified(manifold, thickness)
    mesh = manifolds.manifold_triangles(simpler)
    ball = manifolds.ball_corners(BALL_SEGMENTS)
    near = [
        (triangle[:, None] + thickness * np.concatenate([ball, inwards])).reshape(-1, 3)
        for triangle, inwards in zip(mesh.vertices[mesh.triangles], _inwards(mesh), strict=True)
    ]
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


def _inwards(mesh: TriangleMesh) -> UnitVectors:
    """Return the way into the solid at each triangle and at its hollow edges, (t, 24, 3).

    Beyond other edges a triangle goes its own way.
    """
    corners = mesh.vertices[mesh.triangles]
    ahead = np.roll(corners, -1, axis=1) - corners  # (t, 3, 3), along the sides
    own = normalize(np.cross(ahead[:, 1], ahead[:, 0]))[:, None].repeat(3, axis=1)
    beyond = own[neighbors(mesh.triangles, len(mesh.vertices)), 0]  # (t, 3, 3)
    is_hollow = triple(own, beyond, ahead) < 0.0
    is_hollow &= angle_between(own, beyond) > HOLLOW
    ways = np.stack([own, np.where(is_hollow[..., None], beyond, own)], axis=2)
    for _ in range(HALVED):
        middle = normalize(ways[:, :, :-1] + ways[:, :, 1:])
        ways = np.insert(ways, range(1, ways.shape[2]), middle, axis=2)
    return ways[:, :, :-1].reshape(len(ways), -1, 3)
