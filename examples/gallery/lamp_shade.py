"""A lamp shade: the edges of a foam that covers a globe, as round struts.

The foam is that of Voronoi cells around random points, which move to the middle of their cells a
few times. Openings are left for the lamp at the top and its light at the bottom.
"""

import numpy as np
from manifold3d import Manifold
from scipy.spatial import SphericalVoronoi

from scaffold_cad import Skeleton, thicken, write
from scaffold_cad.base.vectors import normalize

CELLS, RADIUS, WIRE = 110, 60.0, 1.4
"""Cells on the whole globe, its radius, and that of the struts, mm."""


def shade() -> Skeleton:
    """Return the struts of the shade."""
    points = normalize(np.random.default_rng(5).normal(size=(CELLS, 3)))
    for _ in range(12):
        foam = SphericalVoronoi(points)
        points = normalize(np.array([foam.vertices[cell].mean(axis=0) for cell in foam.regions]))
    foam.sort_vertices_of_regions()
    height = foam.vertices[:, 2]
    kept = (height < 0.93) & (height > -0.72)
    cells = [cell for cell in foam.regions if kept[cell].all()]
    sides = [np.stack([cell, np.roll(cell, 1)], axis=1) for cell in cells]
    edges = np.unique(np.sort(np.concatenate(sides), axis=1), axis=0)
    globe = RADIUS * foam.vertices * [1.0, 1.0, 1.15]
    return Skeleton(globe, edges, np.array(WIRE)).cleaned().skeleton


def make() -> Manifold:
    """Return the shade as a solid."""
    return thicken(shade(), WIRE, sides=8)


if __name__ == "__main__":
    write(make(), "lamp_shade.stl")
