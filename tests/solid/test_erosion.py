"""What is inside walls of any shape, where moving the surface does not do."""

from __future__ import annotations

import re

import manifold3d
import numpy as np
import pytest
import trimesh

from scaffold_cad.base.vectors import length
from scaffold_cad.errors import MeshError
from scaffold_cad.mesh.insets import inset
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.erosion import eroded
from scaffold_cad.solid.manifolds import manifold_triangles, to_manifold
from scaffold_cad.solid.skins import inside_of
from tests.meshes import CUBE


def as_mesh(mesh: trimesh.Trimesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.faces)


@pytest.mark.parametrize("seed", range(6))
def test_walls_of_convex_bodies_are_exact_at_each_face(seed: int) -> None:
    points = np.random.default_rng(seed).normal(size=(40 if seed > 3 else 14, 3))
    body = trimesh.convex.convex_hull(9.0 * points)
    inner = inside_of(as_mesh(body), to_manifold(as_mesh(body)), 0.8)
    places = manifold_triangles(inner).vertices
    depth = np.einsum("tpj,tj->tp", body.triangles[:, :1] - places, body.face_normals)
    assert depth.min() == pytest.approx(0.8, abs=1e-6)


def test_moved_surfaces_that_leave_too_thin_a_wall_are_not_taken() -> None:
    body = trimesh.convex.convex_hull(9.0 * np.random.default_rng(1).normal(size=(40, 3)))
    assert inset(as_mesh(body), 1.0) is None  # vertices with five and more faces
    assert inset(as_mesh(trimesh.creation.icosphere(3, 15.0)), 1.0) is not None


def test_walls_at_hollow_edges_are_as_thick_as_asked() -> None:
    tilted = manifold3d.Manifold.cube((8, 8, 60), True).rotate((20, 30, 40))
    body = manifold3d.Manifold.cube((30, 24, 20), True) - tilted
    inner = manifold_triangles(eroded(body + tilted.scale((0.4, 0.4, 1.2)), 1.0))
    surface = manifold_triangles(body + tilted.scale((0.4, 0.4, 1.2)))
    judge = trimesh.Trimesh(surface.vertices, surface.triangles)
    _, distance, _ = trimesh.proximity.closest_point_naive(judge, inner.vertices)
    assert 0.97 < distance.min() < 1.0 + 1e-9


def test_fine_bodies_are_simplified_for_an_even_wall(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    fine = manifold3d.Manifold.sphere(10.0, 300)
    inner = manifold_triangles(eroded(fine, 4.0))
    inner.check_closed()
    assert 5.6 < length(inner.vertices).min() < length(inner.vertices).max() < 6.4
    (record,) = caplog.records
    message = r"a wall of 4 mm is made from (\d+) triangles: some \d+ s"
    found = re.fullmatch(message, record.getMessage())
    assert found
    assert int(found[1]) < 0.2 * fine.num_tri()


def test_walls_that_would_take_hours_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.solid.erosion.MOST_TO_ERODE", 10)
    with pytest.raises(MeshError, match=r"a wall of 0.1 mm .* 12 triangles .*; need 10 or fewer"):
        eroded(to_manifold(CUBE), 0.1)
