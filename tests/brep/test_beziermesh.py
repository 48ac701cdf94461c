"""BezierMesh: patches that share their boundaries."""

from __future__ import annotations

import re

import numpy as np
import pytest

from scaffold_cad.brep.beziermesh import BezierMesh, side_indices
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.quadmesh import QuadMesh
from tests.meshes import (
    CUBE,
    DART_PRISM,
    TORUS,
    TWISTED_TUBE,
    ball,
    elevated,
    pillow,
    twisted_tube_volume,
)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_raising_the_degree_changes_neither_corners_nor_volume(degree) -> None:
    patches = BezierMesh(TORUS.quads, elevated(TORUS, degree))
    assert patches.degree == degree
    np.testing.assert_allclose(patches.mesh.vertices, TORUS.vertices, atol=1e-14)
    assert patches.signed_volume == pytest.approx(TORUS.signed_volume, rel=1e-12)


def test_bilinear_patches_have_the_volume_known_for_a_twisted_tube() -> None:
    patches = BezierMesh.bilinear(TWISTED_TUBE)
    assert patches.signed_volume == pytest.approx(twisted_tube_volume(4), rel=1e-14)


@pytest.mark.parametrize("height", [0.0, 0.5, 3.0])
def test_a_face_gains_the_mean_of_the_middle_bernstein_polynomial(height) -> None:
    assert pillow(height).signed_volume == pytest.approx(8 + 6 * 4 / 9 * height, rel=1e-14)


def test_no_patches_have_no_volume() -> None:
    empty = BezierMesh(np.zeros((0, 4), dtype=int), np.zeros((0, 3, 3, 3)))
    assert empty.signed_volume == 0


def test_bilinear_keeps_the_mesh() -> None:
    patches = BezierMesh.bilinear(CUBE)
    assert patches.mesh is CUBE
    np.testing.assert_array_equal(patches.control_points, elevated(CUBE, 1))


def test_a_vertex_that_no_quad_uses_is_at_the_origin() -> None:
    mesh = QuadMesh(np.concatenate([[[9, 9, 9]], CUBE.vertices]), CUBE.quads + 1)
    patches = BezierMesh(mesh.quads, elevated(mesh, 2))
    np.testing.assert_array_equal(patches.mesh.vertices[0], [0, 0, 0])


@pytest.mark.parametrize("degree", [1, 3, 4])
def test_edges_run_from_lower_to_higher_vertex(degree) -> None:
    patches = ball(degree)
    rows = patches.edge_control_points
    assert rows.shape == (12, degree + 1, 3)
    ends = patches.mesh.vertices[patches.mesh.edges]
    np.testing.assert_allclose(rows[:, [0, -1]], ends, atol=1e-14)


def test_sides_run_around_a_patch() -> None:
    assert side_indices(2).tolist() == [[0, 3, 6], [6, 7, 8], [8, 5, 2], [2, 1, 0]]


def test_flat_quads_have_outward_normals_and_others_none() -> None:
    middles = CUBE.vertices[CUBE.quads].mean(axis=1)
    np.testing.assert_allclose(BezierMesh.bilinear(CUBE).plane_normals, middles, atol=1e-15)
    assert not BezierMesh.bilinear(TORUS).plane_normals.any()
    normals = BezierMesh.bilinear(TWISTED_TUBE).plane_normals
    np.testing.assert_allclose(normals[-2:], [[0, 0, -1], [0, 0, 1]], atol=1e-15)
    assert not normals[:-2].any()


def test_a_flat_quad_need_not_be_convex() -> None:
    normals = BezierMesh.bilinear(DART_PRISM).plane_normals
    np.testing.assert_allclose(normals[:2], [[0, 0, -1], [0, 0, 1]], atol=1e-15)


def test_patches_of_a_higher_degree_are_on_their_plane_too() -> None:
    flat = BezierMesh.bilinear(CUBE).plane_normals
    np.testing.assert_allclose(pillow(0.0).plane_normals, flat, atol=1e-15)
    assert not pillow(0.1).plane_normals.any()


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ((6, 2, 3, 3), "control_points has shape (6, 2, 3, 3); need (f, d + 1, d + 1, 3)"),
        ((6, 2, 2), "control_points has shape (6, 2, 2); need (f, d + 1, d + 1, 3)"),
        ((6, 1, 1, 3), "the patches have degree 0; need 1 or more"),
        ((5, 2, 2, 3), "5 patches given for 6 quads; need one each"),
    ],
)
def test_control_points_of_the_wrong_shape_are_refused(shape, message) -> None:
    with pytest.raises(MeshError, match=re.escape(message)):
        BezierMesh(CUBE.quads, np.zeros(shape))


def test_control_points_that_are_not_finite_are_refused() -> None:
    points = elevated(CUBE, 2)
    points[3, 1, 1, 0] = np.nan
    with pytest.raises(MeshError, match="patch 3 has control points that are not finite numbers"):
        BezierMesh(CUBE.quads, points)


def test_a_gap_between_patches_is_refused() -> None:
    points = elevated(CUBE, 2)
    points[4, 1, 0] += [0, 0, 1e-6]
    message = "is 1e-06 mm off its neighbor along the edge from vertex"
    with pytest.raises(MeshError, match=message):
        BezierMesh(CUBE.quads, points)


def test_a_gap_at_a_vertex_that_joins_no_edges_is_refused() -> None:
    quads = np.concatenate([CUBE.quads, np.where(CUBE.quads == 0, 7, CUBE.quads + 8)])
    points = np.concatenate([elevated(CUBE, 1), elevated(CUBE, 1) + 2.5])
    with pytest.raises(MeshError, match="mm off its neighbor"):
        BezierMesh(quads, points)
