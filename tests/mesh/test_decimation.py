"""Fewer triangles: near the surface, closed, free of crossings, its border as it was."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.arrays import Edges
from scaffold_cad.mesh import decimation
from scaffold_cad.mesh.decimation import decimated
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh, compacted
from scaffold_cad.solid.field import field_solid, field_struts

CROSS = [[[0, 0, 0], [20, 0, 0]], [[10, -8, 0.5], [10, 8, 0.5]]]
NONE = np.zeros(0, dtype=np.intp)


def even(mesh: TriangleMesh, tolerance: float) -> np.ndarray:
    return np.full(len(mesh.vertices), tolerance)


@pytest.fixture(scope="module")
def cross() -> TriangleMesh:
    return field_solid(field_struts(CROSS, 1.0)).mesh


@pytest.mark.parametrize(("tolerance", "part"), [(0.005, 0.6), (0.02, 0.2), (0.1, 0.1)])
def test_few_triangles_are_left_and_the_volume_stays(
    cross: TriangleMesh, tolerance: float, part: float
) -> None:
    found = decimated(cross, even(cross, tolerance), NONE)
    found.check_closed()
    assert len(found.triangles) < part * len(cross.triangles)
    assert len(self_intersections(found)) == 0
    assert found.signed_volume == pytest.approx(cross.signed_volume, rel=1.5 * tolerance)


def test_surfaces_stay_near_where_they_were(cross: TriangleMesh) -> None:
    found = decimated(cross, even(cross, 0.02), NONE)
    middles = found.vertices[found.triangles].mean(axis=1)
    ends = (np.abs(middles[:, 0] - 10) < 9) & (np.abs(middles[:, 0] - 10) > 3)
    radius = np.hypot(middles[ends, 1], middles[ends, 2])
    assert np.abs(radius - 1.0).max() < 0.08
    assert np.sqrt(np.mean((radius - 1.0) ** 2)) < 0.04


def test_borders_and_vertices_that_are_fixed_stay(cross: TriangleMesh) -> None:
    kept = (cross.vertices[cross.triangles][:, :, 0] < 15).all(axis=1)
    mesh = compacted(cross.vertices, cross.triangles[kept])
    border = np.unique(mesh.faulty_sides()[1])
    fixed = np.arange(0, len(mesh.vertices), 97)
    found = decimated(mesh, even(mesh, 0.05), fixed)
    assert len(found.triangles) < 0.3 * len(mesh.triangles)
    own = set(map(tuple, found.vertices.round(9).tolist()))
    stay = np.union1d(border, fixed)
    assert set(map(tuple, mesh.vertices[stay].round(9).tolist())) <= own
    assert len(found.faulty_sides()[1]) == len(mesh.faulty_sides()[1])


def test_pieces_that_would_cross_are_done_again_and_no_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    struts = [[[0, 0, 0], [12, 0, 0]], [[0, -1, 2.03], [12, 1, 2.03]], [[0, 19, 0], [12, 19, 0]]]
    mesh = field_solid(field_struts(struts, 1.0, blend=0.005)).mesh
    counts = []

    def counted(mesh: TriangleMesh) -> Edges:
        found = self_intersections(mesh)
        counts.append(len(found))
        return found

    monkeypatch.setattr(decimation, "self_intersections", counted)
    found = decimated(mesh, even(mesh, 0.1), NONE)
    assert counts[0] > 0
    assert counts[-1] == 0
    monkeypatch.setattr(decimation, "self_intersections", lambda mesh: np.zeros((0, 2), np.intp))
    once = decimated(mesh, even(mesh, 0.1), NONE)
    found.check_closed()
    assert len(found.triangles) < 0.2 * len(mesh.triangles)
    alone, before = (
        np.sort(some.vertices[some.vertices[:, 1] > 10], axis=0) for some in (found, once)
    )
    np.testing.assert_allclose(alone, before, atol=1e-12)


def test_tolerances_grow_where_there_are_too_many_triangles(cross: TriangleMesh) -> None:
    usual = decimated(cross, even(cross, 0.01), NONE)
    fewer = decimated(cross, even(cross, 0.01), NONE, (100, 100))
    coarse = decimated(cross, even(cross, 4 * 0.01), NONE)
    assert len(fewer.triangles) < 0.5 * len(usual.triangles)
    assert len(fewer.triangles) > 0.5 * len(coarse.triangles)
    enough = decimated(cross, even(cross, 0.01), NONE, (len(usual.triangles), 100))
    assert len(coarse.triangles) < len(enough.triangles) < len(usual.triangles)


def test_the_same_mesh_gives_the_same_triangles(cross: TriangleMesh) -> None:
    once, again = (decimated(cross, even(cross, 0.02), NONE) for _ in range(2))
    np.testing.assert_array_equal(once.vertices, again.vertices)
    np.testing.assert_array_equal(once.triangles, again.triangles)


def test_planes_become_few_triangles_without_slivers() -> None:
    x, y = np.meshgrid(np.arange(21.0), np.arange(21.0), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    low = (np.arange(20)[:, None] * 21 + np.arange(20)).reshape(-1)
    triangles = np.concatenate(
        [np.stack([low, low + 21, low + 22], 1), np.stack([low, low + 22, low + 1], 1)]
    )
    mesh = TriangleMesh(points, triangles)
    found = decimated(mesh, even(mesh, 0.1), NONE)
    assert len(found.triangles) < 150  # its border has 80 vertices
    np.testing.assert_allclose(found.vertices[:, 2], 0.0, atol=1e-9)
    corners = found.vertices[found.triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    assert area.min() > 0
    assert area.sum() == pytest.approx(400.0)
