"""The frame of a geodesic dome: an icosahedron's faces cut in nine, pushed out onto a sphere."""

import numpy as np
from manifold3d import Manifold
from scipy.spatial import ConvexHull

from scaffold_cad import Skeleton, thicken, write
from scaffold_cad.base.vectors import normalize

RADIUS, WIRE, FREQUENCY = 50.0, 1.2, 3
"""Radius of the dome and of its struts, mm; struts along an edge of the icosahedron."""


def dome() -> Skeleton:
    """Return the struts of the upper part of the sphere."""
    turn = np.pi / 5 * np.arange(10)
    belt = np.stack([np.cos(turn), np.sin(turn), np.tile([0.5, -0.5], 5)], axis=1)
    corners = np.vstack([normalize(belt), [0, 0, 1], [0, 0, -1]])
    steps = range(FREQUENCY + 1)
    shares = np.array([(i, j, FREQUENCY - i - j) for i in steps for j in steps if i + j in steps])
    points = np.vstack([shares @ corners[face] for face in ConvexHull(corners).simplices])
    sphere = np.unique(normalize(points).round(9), axis=0)
    faces = ConvexHull(sphere).simplices
    edges = np.unique(np.sort(np.vstack([faces[:, [0, 1]], faces[:, 1:], faces[:, ::2]])), axis=0)
    upper = (sphere[:, 2] > -0.2)[edges].all(axis=1)
    return Skeleton(RADIUS * sphere, edges[upper], np.array(WIRE)).cleaned().skeleton


def make() -> Manifold:
    """Return the frame as a solid of round struts."""
    return thicken(dome(), WIRE, sides=8)


if __name__ == "__main__":
    write(make(), "geodesic_dome.stl")
