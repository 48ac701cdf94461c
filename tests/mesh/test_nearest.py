"""The nearest place of a surface, judged by looking at all triangles."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.arrays import Points
from scaffold_cad.mesh.nearest import NearestPlace, nearest_on_triangles
from scaffold_cad.mesh.trianglemesh import TriangleMesh


def patchy(random: np.random.Generator) -> TriangleMesh:
    """Return a plane of large triangles in which some are cut into hundreds of small ones."""
    grid = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0), [0.0]), axis=-1).reshape(-1, 3)
    quads = [[6 * i + j, 6 * i + j + 1, 6 * i + j + 7, 6 * i + j + 6]
             for i in range(5) for j in range(5)]  # fmt: skip
    corners = [grid[[q[0], q[1], q[2]]] for q in quads] + [grid[[q[0], q[2], q[3]]] for q in quads]
    small = random.uniform(1.0, 2.0, (400, 1, 3)) * [1, 1, 0] + random.normal(0, 0.02, (400, 3, 3))
    every = np.concatenate([np.array(corners), small])
    return TriangleMesh(every.reshape(-1, 3), np.arange(3 * len(every)).reshape(-1, 3))


def judged(mesh: TriangleMesh, points: Points) -> np.ndarray:
    corners = mesh.vertices[mesh.triangles]
    found = []
    for point in points:
        feet = nearest_on_triangles(np.tile(point, (len(corners), 1)), corners)
        found.append(np.linalg.norm(feet - point, axis=1))
    return np.min(found, axis=1)


@pytest.mark.parametrize("seed", range(3))
def test_large_triangles_among_many_small_ones_are_found(seed: int) -> None:
    random = np.random.default_rng(seed)
    mesh = patchy(random)
    points = random.uniform([0.5, 0.5, -0.3], [2.5, 2.5, 0.3], (300, 3))
    place = NearestPlace(mesh)
    far = np.linalg.norm(place.nearest(points) - points, axis=1)
    wanted = judged(mesh, points)
    # Small ones cross each other: the nearest of these may not be among those looked at.
    assert (far < wanted + 0.02).all()
    rows, places, _ = place.nearer(points, 0.2)
    assert set(np.flatnonzero(wanted < 0.18)) <= set(rows.tolist())
    assert (np.linalg.norm(places - points[rows], axis=1) < 0.2).all()
