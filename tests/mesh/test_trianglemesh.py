"""TriangleMesh: its volume and its checks."""

from __future__ import annotations

import re

import numpy as np
import pytest

from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.trianglemesh import TriangleMesh, cone_volumes
from tests.meshes import CUBE, INSIDE_OUT_CUBE, TORUS

TETRAHEDRON = TriangleMesh(
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)


def test_volume_of_a_tetrahedron_is_a_sixth_of_the_box_around_it() -> None:
    assert TETRAHEDRON.signed_volume == pytest.approx(1 / 6, rel=1e-15)


@pytest.mark.parametrize(("mesh", "volume"), [(CUBE, 8), (INSIDE_OUT_CUBE, -8)])
def test_volume_has_the_sign_of_the_direction_of_the_triangles(mesh, volume) -> None:
    assert TriangleMesh(mesh.vertices, mesh.triangles).signed_volume == pytest.approx(volume)


def test_volume_is_kept_far_from_the_origin() -> None:
    mesh = TriangleMesh(TETRAHEDRON.vertices + 1e6, TETRAHEDRON.triangles)
    assert mesh.signed_volume == pytest.approx(1 / 6, rel=1e-9)


def test_nothing_has_no_volume() -> None:
    assert TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int)).signed_volume == 0
    assert cone_volumes(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp)).shape == (0,)


def test_arrays_are_read_only_copies() -> None:
    vertices = np.eye(3)
    mesh = TriangleMesh(vertices, [[0, 1, 2]])
    vertices[0, 0] = 7.0
    assert mesh.vertices[0, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        mesh.triangles[0, 0] = 1


@pytest.mark.parametrize("mesh", [CUBE, TORUS])
def test_triangles_of_a_closed_quad_mesh_are_closed(mesh) -> None:
    TriangleMesh(mesh.vertices, mesh.triangles).check_closed()


@pytest.mark.parametrize(
    ("triangles", "message"),
    [
        ([], "the mesh has no triangles; need at least 4"),
        ([[0, 2, 1], [0, 1, 3], [1, 2, 3]], "no triangle runs along the edge from vertex 2 to 0"),
        (
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]],
            "two triangles run along the edge from vertex 0 to 2; need one",
        ),
    ],
)
def test_what_is_not_closed_is_refused(triangles, message) -> None:
    with pytest.raises(MeshError, match=re.escape(message)):
        TriangleMesh(TETRAHEDRON.vertices, triangles).check_closed()


@pytest.mark.parametrize(
    ("triangles", "message"),
    [
        ([[0.5, 1.0, 2.0]], "triangles holds 0.5; need whole numbers"),
        ([[0, 1, 2, 3]], "triangles has shape (1, 4); need (n, 3)"),
        ([[0, 1, 2], [0, 1, 4]], "triangles[1] has vertices [0, 1, 4]; need 0 to 3"),
        ([[0, 1, 2], [0, 1]], "triangles is not an array of indices"),
        ([[0, -1, 2]], "triangles[0] has vertices [0, -1, 2]; need 0 to 3"),
    ],
)
def test_bad_triangles_are_refused(triangles, message) -> None:
    with pytest.raises(MeshError, match=re.escape(message)):
        TriangleMesh(TETRAHEDRON.vertices, triangles)
