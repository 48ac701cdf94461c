"""Checks of solids by libraries that had no part in making them."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation
from trimesh import Trimesh

from scaffold_cad.base.boxes import overlapping_boxes
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.manifolds import manifold_triangles
from tests.crossings import check_as_written


def check_solid_of(skeleton: Skeleton, manifold: Any) -> None:
    """Assert that a manifold3d solid is whole, does not cross itself, and holds the skeleton."""
    assert manifold.status().name == "NoError"
    mesh = manifold_triangles(manifold)
    check_watertight(mesh)
    check_as_written(mesh)
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

    The triangles above a point that face up count 1, those that face down -1: seen along a
    direction at random, so that hardly any point is exactly above an edge. Those that are nearly
    so are looked at from all sides.
    """
    turn = Rotation.random(random_state=0).as_matrix()
    corners, points = mesh.vertices[mesh.triangles] @ turn, points @ turn
    low, high = corners.min(axis=1), corners.max(axis=1)
    tops = np.column_stack([points[:, :2], np.full(len(points), high[:, 2].max(initial=0.0))])
    inside, unsure = np.zeros(len(points)), np.zeros(len(points), dtype=np.bool_)
    boxes = overlapping_boxes(np.concatenate([low, points]), np.concatenate([high, tops]))
    for triangle, point in boxes:  # the points come last
        point = point - len(corners)
        some = (triangle < len(corners)) & (point >= 0)
        triangle, point = triangle[some], point[some]
        rays = corners[triangle] - points[point, None]  # (p, 3, 3)
        flat = rays[:, :, :2]
        areas = np.linalg.det(np.stack([flat[:, [1, 2, 0]], flat[:, [2, 0, 1]]], axis=2))  # (p, 3)
        total, height = areas.sum(axis=1), (areas * rays[:, :, 2]).sum(axis=1)
        size = (np.abs(flat).max(axis=(1, 2)) + 1e-300) ** 2
        hit = (np.sign(areas) == np.sign(total)[:, None]).all(axis=1)
        above = height * np.sign(total) > 0
        np.add.at(inside, point[hit & above], np.sign(total[hit & above]))
        close = (np.abs(areas) < 1e-12 * size[:, None]).any(axis=1)
        close |= hit & (np.abs(height) < 1e-12 * size * np.abs(rays[:, :, 2]).max(axis=1))
        unsure[point[close]] = True
    found = inside > 0.5
    found[unsure] = [seen_from_all_sides(corners, point) for point in points[unsure]]
    return found


def seen_from_all_sides(corners: np.ndarray, point: np.ndarray) -> bool:
    """Return whether triangles (t, 3, 3) surround a point: their solid angle is 4 pi.

    van Oosterom, Strackee, The solid angle of a plane triangle, 1983.
    """
    a, b, c = np.moveaxis(corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("ij,ij->i", np.cross(a, b), c)
    cosine = (
        la * lb * lc
        + np.einsum("ij,ij->i", a, b) * lc
        + np.einsum("ij,ij->i", b, c) * la
        + np.einsum("ij,ij->i", c, a) * lb
    )
    return bool(np.arctan2(volume, cosine).sum() > np.pi)


def distance_to_axes(skeleton: Skeleton, points: np.ndarray, samples: int = 200) -> np.ndarray:
    """Return the distance of points to the nearest of many samples of the edges, (k,)."""
    share = np.linspace(0, 1, samples)[None, :, None]
    start, end = (skeleton.nodes[skeleton.edges[:, side]][:, None] for side in (0, 1))
    return cKDTree(((1 - share) * start + share * end).reshape(-1, 3)).query(points)[0]
