"""Surfaces remeshed: even sides, closed, on the old surface, borders kept, cut into quads."""

from __future__ import annotations

import build123d as bd
import numpy as np
import pytest
import trimesh

from scaffold_cad.base.arrays import Edges
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.nearest import nearest_on_triangles
from scaffold_cad.mesh.remeshing import (
    quadrangulated,
    remeshed,
    three_quads_each,
)
from scaffold_cad.mesh.sharpedges import SharpEdges, sharp_edges
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.mesh.welding import welded
from scaffold_cad.products.surfaces import triangles_of


def as_mesh(mesh: trimesh.Trimesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.faces)


BALL = trimesh.creation.icosphere(3, 20.0)
RING = trimesh.creation.torus(20.0, 6.0, major_sections=60, minor_sections=24)
COARSE_BOX = trimesh.creation.box((30, 20, 10))


@pytest.mark.parametrize("mesh", [BALL, RING, COARSE_BOX], ids=["ball", "ring", "box"])
def test_sides_are_even_and_the_surface_stays_closed_and_in_place(mesh: trimesh.Trimesh) -> None:
    new = remeshed(as_mesh(mesh), 2.5).mesh
    new.check_closed()
    rows = new.triangles
    sides = np.linalg.norm(new.vertices[rows] - new.vertices[np.roll(rows, 1, axis=1)], axis=2)
    assert 0.8 < sides.mean() / 2.5 < 1.3
    assert sides.max() < 2.5 * sides.mean()
    assert new.signed_volume == pytest.approx(mesh.volume, rel=0.05)
    edges = len(rows) * 3 // 2
    assert len(new.vertices) - edges + len(rows) == mesh.euler_number
    corners = np.asarray(mesh.triangles)
    gaps = [
        np.linalg.norm(nearest_on_triangles(np.tile(one, (len(corners), 1)), corners) - one, axis=1)
        for one in new.vertices[::5]
    ]
    assert np.min(gaps, axis=1).max() < 0.02 * 2.5


def test_the_border_of_an_open_mesh_is_kept() -> None:
    sheet = trimesh.creation.box((30, 20, 10)).submesh([[0, 1, 2, 3]], append=True)
    open_mesh = remeshed(as_mesh(sheet), 3.0).mesh
    _, before = as_mesh(sheet).faulty_sides()
    _, after = open_mesh.faulty_sides()
    assert len(after) > len(before) > 0

    def total(mesh: TriangleMesh, sides: Edges) -> float:
        return float(np.linalg.norm(np.diff(mesh.vertices[sides], axis=1), axis=2).sum())

    assert total(open_mesh, after) == pytest.approx(total(as_mesh(sheet), before))


def test_triangles_are_cut_into_three_quads_that_share_sides() -> None:
    quads = three_quads_each(as_mesh(COARSE_BOX))
    quads.check_closed()
    assert len(quads.quads) == 3 * len(COARSE_BOX.faces)
    assert quads.signed_volume == pytest.approx(6000.0)
    even = quadrangulated(as_mesh(BALL), 2.0)
    even.check_closed()
    assert 0.6 < BALL.area / len(even.quads) / 4.0 < 1.7


def test_the_nearest_place_of_a_triangle_is_that_of_another_library() -> None:
    random = np.random.default_rng(0)
    corners, points = random.normal(size=(500, 3, 3)), random.normal(size=(500, 3))
    expected = trimesh.triangles.closest_point(corners, points)
    np.testing.assert_allclose(nearest_on_triangles(points, corners), expected, atol=1e-12)


def test_wrong_sizes_and_meshes_are_refused_by_name() -> None:
    with pytest.raises(OptionError, match="size of quads is 0 mm"):
        quadrangulated(as_mesh(BALL), 0.0)
    with pytest.raises(MeshError, match="more than 2000000; need larger ones"):
        remeshed(as_mesh(BALL), 1e-4)
    with pytest.raises(MeshError, match="has no area"):
        remeshed(TriangleMesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]), 1.0)
    fan = TriangleMesh(
        [[0, 0, 0], [0, 0, 9], [9, 0, 0], [0, 9, 0], [-9, 0, 0]],
        [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    )
    with pytest.raises(MeshError, match="more than two triangles"):
        remeshed(fan, 3.0)


@pytest.mark.parametrize("size", [2.0, 3.0, 4.0])
def test_few_quads_on_a_sphere_are_even(size: float) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=20)
    soup = np.float32(ball.triangles).reshape(-1, 3)  # as an STL file has it
    mesh = welded(TriangleMesh(soup, np.arange(len(soup)).reshape(-1, 3)))
    quads = quadrangulated(mesh, size)
    corners = quads.vertices[quads.quads]  # (f, 4, 3)
    ahead = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(ahead, -np.roll(ahead, 1, axis=1))
    normals /= np.linalg.norm(normals, axis=2)[:, :, None]
    outward = corners / np.linalg.norm(corners, axis=2)[:, :, None]
    assert (normals * outward).sum(axis=2).min() > 0.7


def test_a_mesh_of_many_triangles_becomes_one_of_few_on_its_surface() -> None:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=20)
    fine = TriangleMesh(ball.vertices, ball.faces)
    few = remeshed(fine, 6.0).mesh
    few.check_closed()
    assert len(few.triangles) < len(fine.triangles) / 50
    np.testing.assert_allclose(np.linalg.norm(few.vertices, axis=1), 20, atol=0.02)
    sheet = fine.triangles[fine.vertices[fine.triangles].mean(axis=1)[:, 2] > 0]
    cap = remeshed(TriangleMesh(ball.vertices, sheet), 6.0).mesh
    np.testing.assert_allclose(
        np.linalg.norm(cap.vertices[np.unique(cap.triangles)], axis=1), 20, atol=0.02
    )
    assert len(cap.faulty_sides()[1]) > 0


def test_a_fine_mesh_that_is_no_surface_is_refused_by_name() -> None:
    ball = trimesh.creation.icosphere(subdivisions=5, radius=20)
    fin = [*ball.faces[0][:2], len(ball.vertices)]
    corners = np.concatenate([ball.vertices, [[0, 0, 30]]])
    with pytest.raises(MeshError, match="an edge has more than two triangles"):
        quadrangulated(TriangleMesh(corners, [*ball.faces, fin]), 5.0)


@pytest.mark.parametrize("size", [2.0, 3.0, 4.0, 5.0])
def test_quads_of_a_box_keep_its_edges(size: float) -> None:
    box = trimesh.creation.box((30, 20, 30))
    quads = quadrangulated(TriangleMesh(box.vertices, box.faces), size)
    areas = TriangleMesh(quads.vertices, quads.triangles)
    areas.check_closed()
    assert areas.signed_volume == pytest.approx(box.volume, rel=1e-9)
    corners = quads.vertices[quads.quads]  # (f, 4, 3)
    flat = [np.ptp(corners[:, :, axis], axis=1) < 1e-6 for axis in range(3)]
    assert np.any(flat, axis=0).all()  # each quad is in one face


def test_quads_of_a_cylinder_keep_its_rims() -> None:
    rod = trimesh.creation.cylinder(10, 30, sections=64)
    quads = quadrangulated(TriangleMesh(rod.vertices, rod.faces), 2.0)
    mesh = TriangleMesh(quads.vertices, quads.triangles)
    mesh.check_closed()
    assert mesh.signed_volume == pytest.approx(rod.volume, rel=0.02)
    ends = quads.vertices[sharp_edges(mesh)]  # (k, 2, 3)
    np.testing.assert_allclose(np.abs(ends[:, :, 2]), 15, atol=1e-6)
    np.testing.assert_allclose(np.hypot(ends[..., 0], ends[..., 1]), 10, atol=0.02)


def test_edges_across_a_circle_are_not_halved_without_end() -> None:
    rod = trimesh.creation.cylinder(20, 40, sections=32)
    quads = quadrangulated(TriangleMesh(rod.vertices, rod.faces), 10.0)
    assert quads.euler_characteristic == 2


def test_runs_along_sharp_edges_go_from_vertex_to_next_vertex() -> None:
    rod = trimesh.creation.cylinder(10, 30, sections=64)
    sharp = SharpEdges(TriangleMesh(rod.vertices, rod.faces))
    coarse = trimesh.creation.cylinder(10, 30, sections=4)
    runs = sharp.runs(TriangleMesh(coarse.vertices, coarse.faces))
    assert len(runs.keys) == 8
    assert not runs.can_shrink.any()  # the rims would be no circles
    np.testing.assert_allclose(np.abs(runs.middles[:, 2]), 15)
    np.testing.assert_allclose(np.hypot(*runs.middles[:, :2].T), 10, rtol=2e-3)
    np.testing.assert_allclose(runs.lengths, 16 * 2 * 10 * np.sin(np.pi / 64))


@pytest.mark.parametrize("size", [1.0, 1.25, 1.5, 1.75, 2.5])
def test_quads_of_a_part_with_a_hole_keep_its_edges(size: float) -> None:
    block = bd.Box(20, 20, 10) - bd.Cylinder(4, 10)
    surface = triangles_of(block)
    quads = quadrangulated(surface, size)
    quads.check_closed()
    assert quads.euler_characteristic == 0
    corners = quads.vertices[quads.quads]  # (f, 4, 3)
    ahead = np.roll(corners, -1, axis=1) - corners
    turns = np.cross(ahead, -np.roll(ahead, 1, axis=1))  # (f, 4, 3)
    flat = np.ptp(corners[..., 2], axis=1) < 1e-6
    assert (turns[flat, :, 2] * corners[flat, :, 2] > 0).all()  # none is turned over
    at_rim = np.isclose(np.hypot(*quads.vertices[:, :2].T), 4, atol=0.02)
    on_rim = at_rim & np.isclose(np.abs(quads.vertices[:, 2]), 5)
    top = np.sort(np.arctan2(*quads.vertices[on_rim & (quads.vertices[:, 2] > 0), :2].T))
    assert np.diff(top, append=top[0] + 2 * np.pi).max() < 2 * size / 4
    np.testing.assert_allclose(quads.signed_volume, block.volume, rtol=0.02)
