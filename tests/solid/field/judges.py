"""Judges of field solids that share no code with them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.field import FieldStruts
from tests.crossings import check_as_written


def check_exact(mesh: TriangleMesh) -> None:
    """Assert that 32 bits hold a surface as it is, whole, with no two vertices at one place."""
    places = mesh.vertices.astype(np.float32)
    assert (places == mesh.vertices).all()
    assert len(np.unique(places, axis=0)) == len(places)
    check_as_written(mesh)


def manifold_vertices(mesh: TriangleMesh) -> bool:
    """Return whether the triangles around each vertex are one fan, by trimesh."""
    trimesh = pytest.importorskip("trimesh")
    read = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    ring = np.roll(read.faces, -1, axis=1), np.roll(read.faces, 1, axis=1)
    after = dict(zip(zip(read.faces.ravel(), ring[0].ravel(), strict=True), ring[1].ravel(),
                     strict=True))  # fmt: skip
    around: dict[int, list[int]] = {}
    for vertex, neighbor in after:
        around.setdefault(vertex, []).append(neighbor)
    for vertex, neighbors in around.items():
        at, steps = neighbors[0], 0
        while steps == 0 or at != neighbors[0]:
            at, steps = after[vertex, at], steps + 1
        if steps != len(neighbors):
            return False
    return True


def thicknesses(mesh: TriangleMesh) -> Floats:
    """Return how far places of a hollow solid's insides are from its outsides, mm, (p,).

    The places are the corners and the middles of triangles inside.
    """
    whole = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    shells = whole.split(only_watertight=False)
    inside = trimesh.util.concatenate([shell for shell in shells if shell.volume < 0])
    outside = trimesh.util.concatenate([shell for shell in shells if shell.volume > 0])
    return distances(np.concatenate([inside.vertices, inside.triangles_center]), outside)


def distances(points: Points, surface: trimesh.Trimesh) -> Floats:
    """Return how far points (p, 3) are from the triangles near them, (p,).

    Triangles are looked for among those of about one size: of long ones the middles are far.
    """
    found = np.full(len(points), np.inf)
    size = np.linalg.norm(surface.triangles - surface.triangles_center[:, None], axis=2).max(axis=1)
    classes = np.round(np.log2(size / size.min()) / 2)
    for number in np.unique(classes):
        triangles = surface.triangles[classes == number]
        count = min(32, len(triangles))
        _, near = cKDTree(triangles.mean(axis=1)).query(points, count)
        for column in near.reshape(len(points), count).T:
            feet = trimesh.triangles.closest_point(triangles[column], points)
            found = np.minimum(found, np.linalg.norm(feet - points, axis=1))
    return found


def sampled_volume(struts: FieldStruts, count: int = 400_000) -> tuple[float, float]:
    """Return the volume of the union of round-ended cylinders and its standard error, mm³.

    It counts points at random that are within the radius of a segment: no cones, no flat ends.
    """
    assert (struts.radii[:, 0] == struts.radii[:, 1]).all()
    assert not struts.flat.any()
    low = (struts.ends - struts.radii[:, :, None]).min(axis=(0, 1))
    high = (struts.ends + struts.radii[:, :, None]).max(axis=(0, 1))
    points = np.random.default_rng(0).uniform(low, high, size=(count, 3))
    inside = np.zeros(count, dtype=np.bool_)
    for (start, end), (radius, _) in zip(struts.ends, struts.radii, strict=True):
        along = end - start
        t = np.clip((points - start) @ along / max(along @ along, 1e-300), 0, 1)
        inside |= ((points - start - t[:, None] * along) ** 2).sum(axis=1) < radius**2
    part, box = inside.mean(), np.prod(high - low)
    return float(part * box), float(box * np.sqrt(part * (1 - part) / count))
