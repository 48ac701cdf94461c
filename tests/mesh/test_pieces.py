"""Pieces of closed meshes: bodies, voids, and voids that hold bodies."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.mesh.pieces import pieces_of, without_voids
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from tests.crossings import check_as_written
from tests.meshes import CUBE


def nested(*sizes: float) -> TriangleMesh:
    """Return cubes around one center, each the void of the one before or a body in it."""
    count = len(CUBE.vertices)
    center = CUBE.vertices.mean(axis=0)
    points = [size * (CUBE.vertices - center) for size in sizes]
    faces = [
        k * count + (CUBE.triangles if k % 2 == 0 else CUBE.triangles[:, ::-1])
        for k in range(len(sizes))
    ]
    return TriangleMesh(np.concatenate(points), np.concatenate(faces))


def test_an_enclosed_void_is_filled_and_measured() -> None:
    whole = CUBE.signed_volume
    mesh, voids = without_voids(nested(3.0, 2.0))
    assert voids == pytest.approx([8 * whole])
    assert mesh.signed_volume == pytest.approx(27 * whole)
    assert len(mesh.vertices) == len(CUBE.vertices)


def test_a_void_that_holds_a_body_stays() -> None:
    mesh, voids = without_voids(nested(3.0, 2.0, 1.0))
    assert voids == []
    assert len(pieces_of(mesh).volumes) == 3


def test_bodies_around_no_strut_are_crumbs() -> None:
    crumb = CUBE.vertices * 0.1 + 50.0
    count = len(CUBE.vertices)
    faces = [CUBE.triangles, CUBE.triangles[:, ::-1] + count, CUBE.triangles + 2 * count]
    points = [CUBE.vertices, CUBE.vertices * 0.1 + CUBE.vertices.mean(axis=0) / 2, crumb]
    mesh = TriangleMesh(np.concatenate(points), np.concatenate(faces))
    middle = CUBE.vertices.mean(axis=0)
    found, voids = without_voids(mesh, middle[None])
    assert len(pieces_of(found).volumes) == len(voids) == 1
    assert found.signed_volume == pytest.approx(CUBE.signed_volume)
    middles = np.stack([middle, crumb.mean(axis=0)])
    assert len(pieces_of(without_voids(mesh, middles)[0]).volumes) == 2


def test_the_sharp_rim_of_a_wide_cone_leaves_no_crumbs() -> None:
    nodes = [[-25.7669227, -2.0321539, 15.2294466], [-26.5406216, -3.4452543, 13.5545427],
             [1.2829020, 7.0938152, 29.1209881]]  # fmt: skip
    cone = Skeleton(nodes, [[0, 1], [1, 2]], [5.0, 0.005, 1.8461152])
    mesh = round_mesh(round_struts(cone))
    check_as_written(mesh)
    assert len(pieces_of(mesh).volumes) == 1


def test_round_struts_that_overlap_enclose_no_void() -> None:
    # Struts along the edges of a cube whose faces they close, and whose middle they leave open.
    corners = 10.0 * np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)])
    faces = [[1, 1, 0], [1, 1, 2], [1, 0, 1], [1, 2, 1], [0, 1, 1], [2, 1, 1]]
    nodes = np.concatenate([corners, 5.0 * np.array(faces)])
    edges = [
        [corner, 8 + face]
        for face in range(6)
        for corner in range(8)
        if np.linalg.norm(nodes[corner] - nodes[8 + face]) < 7.2
    ]
    mesh = round_mesh(round_struts(Skeleton(nodes, edges, 3.0)))
    check_as_written(mesh)
    assert (pieces_of(mesh).volumes > 0).all()
    assert mesh.signed_volume > 10.0**3
