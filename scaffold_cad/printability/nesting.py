"""Which closed shells of a mesh lie inside which: voids, shells inside out, shells in shells."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints, Points
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.visibility import seen
from scaffold_cad.printability.triangletopology import TriangleTopology

TRIANGLE_BYTES = 1024
"""What a triangle takes where it is seen from a point."""


@dataclass(frozen=True, eq=False)
class Nesting:
    """What each closed shell is, by the shells around it."""

    voids: Ints
    """Shells that bound a hollow inside another."""
    void_volumes: Floats
    """The volume of each, mm³."""
    inverted: Ints
    """Shells inside out: their triangles look inwards though no solid is around them."""
    buried: Ints
    """Shells of solid within solid."""
    places: Points
    """A point of each shell of the mesh, shape (s, 3), mm."""


def nesting(surface: TriangleTopology) -> Nesting:
    """Return what each closed shell of a mesh is; open ones are passed over."""
    volumes = surface.shell_volumes
    closed = np.flatnonzero(np.isfinite(volumes))
    rows = surface.mesh.triangles[surface.triangles]
    corners = surface.mesh.vertices[rows]  # (s, 3, 3)
    order = np.argsort(surface.shell_of_triangle, kind="stable")
    bounds = np.searchsorted(surface.shell_of_triangle[order], np.arange(surface.shell_count + 1))
    of_shell = [corners[order[a:b]] for a, b in pairwise(bounds)]
    places = np.array([shell[0].mean(axis=0) for shell in of_shell]).reshape(-1, 3)
    around = np.zeros(surface.shell_count)
    for shell in closed:
        low, high = of_shell[shell].min(axis=(0, 1)), of_shell[shell].max(axis=(0, 1))
        held = np.flatnonzero(((places >= low) & (places <= high)).all(axis=1))
        held = held[held != shell]
        around[held] += winding_numbers(places[held], of_shell[shell])
    depth = np.zeros(surface.shell_count)
    depth[closed] = np.round(around[closed])
    solid, hollow = volumes > 0, volumes <= 0  # both False for nan
    voids = np.flatnonzero(hollow & (depth > 0))
    return Nesting(
        voids=voids,
        void_volumes=-volumes[voids],
        inverted=np.flatnonzero(hollow & (depth <= 0)),
        buried=np.flatnonzero(solid & (depth > 0)),
        places=places,
    )


def winding_numbers(points: Points, corners: Floats) -> Floats:
    """Return how often triangles (t, 3, 3) go around each of `points` (k, 3), shape (k,)."""
    total = np.zeros(len(points))
    for part in blocks(len(corners), len(points) * TRIANGLE_BYTES):
        spokes = corners[None, part] - points[:, None, None]  # (k, t', 3, 3)
        a, b, c = np.moveaxis(spokes, 2, 0)
        _, solid_angles = seen(a, b, c, rounding=0.0)
        total += solid_angles.sum(axis=1)
    return total / (4.0 * np.pi)
