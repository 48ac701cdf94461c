"""Checks of solids by libraries that had no part in making them."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from trimesh import Trimesh

from scaffold_cad.intersections import self_intersections
from scaffold_cad.manifolds import manifold_triangles
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.trianglemesh import TriangleMesh


def check_solid_of(skeleton: Skeleton, manifold: Any) -> None:
    """Assert that a manifold3d solid is whole, does not cross itself, and holds the skeleton."""
    assert manifold.status().name == "NoError"
    mesh = manifold_triangles(manifold)
    check_watertight(mesh)
    assert len(self_intersections(mesh)) == 0
    assert len(manifold.decompose()) <= skeleton.component_count
    assert skeleton.component_count == 1 or len(manifold.decompose()) >= 1
    middles = skeleton.nodes[skeleton.edges].mean(axis=1)
    outside = np.flatnonzero(~contains(mesh, middles))
    assert len(outside) == 0, f"the middles of edges {outside[:5]} are outside"


def check_watertight(mesh: TriangleMesh) -> None:
    """Assert what trimesh asks of a solid."""
    read = Trimesh(mesh.vertices, mesh.triangles, process=False)
    assert read.is_watertight
    assert read.is_winding_consistent
    assert read.volume > 0


def contains(mesh: TriangleMesh, points: np.ndarray) -> np.ndarray:
    """Return whether each point is inside, by its winding number, (k,).

    The solid angle of all triangles seen from the point: van Oosterom and Strackee, 1983.
    """
    inside = np.empty(len(points), dtype=np.bool_)
    corners = mesh.vertices[mesh.triangles]  # (t, 3, 3)
    for k, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        volume = np.einsum("ij,ij->i", np.cross(a, b), c)
        cosine = (
            la * lb * lc
            + np.einsum("ij,ij->i", a, b) * lc
            + np.einsum("ij,ij->i", b, c) * la
            + np.einsum("ij,ij->i", c, a) * lb
        )
        inside[k] = np.arctan2(volume, cosine).sum() > np.pi
    return inside


def distance_to_axes(skeleton: Skeleton, points: np.ndarray, samples: int = 200) -> np.ndarray:
    """Return the distance of points to the nearest of many samples of the edges, (k,)."""
    share = np.linspace(0, 1, samples)[None, :, None]
    start, end = (skeleton.nodes[skeleton.edges[:, side]][:, None] for side in (0, 1))
    return cKDTree(((1 - share) * start + share * end).reshape(-1, 3)).query(points)[0]
