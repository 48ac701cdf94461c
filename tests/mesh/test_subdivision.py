"""Catmull-Clark subdivision and its limit."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings

from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.subdivision import catmull_clark, limit
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from tests.skeletons import TRIPOD, ZIGZAG
from tests.strategies import skeletons

BOX = QuadMesh(
    [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)
BOTTOM = np.array([[0, 2], [2, 6], [6, 4], [4, 0]])  # the sides of the box at z = -1


@settings(max_examples=15)
@given(skeletons())
def test_subdivision_keeps_a_closed_surface_of_the_same_genus(skeleton: Skeleton) -> None:
    mesh = build_scaffold(skeleton).mesh
    fine = catmull_clark(mesh, 2)
    fine.mesh.check_closed()
    assert len(fine.mesh.quads) == 16 * len(mesh.quads)
    assert fine.mesh.euler_characteristic == mesh.euler_characteristic


def test_a_vertex_a_middle_of_an_edge_and_of_a_quad_follow_the_rules() -> None:
    fine = catmull_clark(BOX, 1)
    assert fine.mesh.vertices[7] == pytest.approx([5 / 9] * 3)
    edge = np.flatnonzero((BOX.edges == [6, 7]).all(axis=1))[0]
    assert fine.mesh.vertices[8 + edge] == pytest.approx([0.75, 0.75, 0])
    assert fine.mesh.vertices[8 + 12 + 1] == pytest.approx([1, 0, 0])


def test_each_quad_knows_the_quad_that_it_is_a_part_of() -> None:
    fine = catmull_clark(BOX, 3)
    middle = fine.mesh.vertices[fine.mesh.quads].mean(axis=1)
    first = BOX.vertices[BOX.quads].mean(axis=1)
    nearest = np.argmax(middle @ first.T, axis=1)
    assert np.array_equal(fine.quad_of_quad, nearest)


def test_no_level_gives_the_mesh_itself() -> None:
    fine = catmull_clark(BOX, 0)
    assert np.array_equal(fine.mesh.quads, BOX.quads)
    assert np.array_equal(fine.mesh.vertices, BOX.vertices)


@settings(max_examples=10)
@given(skeletons(max_nodes=8))
def test_the_limit_of_a_vertex_is_the_same_at_every_level(skeleton: Skeleton) -> None:
    mesh = build_scaffold(skeleton).mesh
    coarse, fine = limit(mesh), limit(catmull_clark(mesh, 2).mesh)
    count = len(mesh.vertices)
    assert fine.points[:count] == pytest.approx(coarse.points, abs=1e-9)
    assert fine.normals[:count] == pytest.approx(coarse.normals, abs=1e-7)


def test_fine_meshes_tend_to_the_limit_and_its_normals() -> None:
    mesh = build_scaffold(TRIPOD, collars=True).mesh
    at_limit = limit(mesh)
    fine = catmull_clark(mesh, 6).mesh
    count = len(mesh.vertices)
    assert fine.vertices[:count] == pytest.approx(at_limit.points, abs=3e-3)
    corners = fine.vertices[fine.quads]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    at_corner = np.abs(np.einsum("ij,ikj->ik", normals, limit(fine).normals[fine.quads]))
    assert at_corner.min() > 0.98


def test_a_chain_of_creases_is_a_cubic_spline_in_its_plane() -> None:
    fine = catmull_clark(BOX, 5, creases=BOTTOM)
    points = limit(fine.mesh, fine.creases).points[np.unique(fine.creases)]
    assert points[:, 2] == pytest.approx(-1)
    radius = np.linalg.norm(points[:, :2], axis=1) / np.sqrt(2)
    assert (radius.min(), radius.max()) == pytest.approx((11 / 12 / np.sqrt(2), 2 / 3), abs=1e-6)


def test_a_vertex_where_three_creases_meet_stays() -> None:
    fine = catmull_clark(BOX, 3, creases=BOX.edges)
    assert fine.mesh.vertices[:8] == pytest.approx(BOX.vertices)
    assert limit(BOX, BOX.edges).points == pytest.approx(BOX.vertices)
    assert fine.mesh.signed_volume == pytest.approx(8)


def test_inputs_are_left_as_they_were() -> None:
    scaffold = build_scaffold(ZIGZAG)
    before = scaffold.mesh.vertices.copy()
    catmull_clark(scaffold.mesh, 2)
    assert np.array_equal(scaffold.mesh.vertices, before)


def test_bad_arguments_are_named() -> None:
    with pytest.raises(OptionError, match="levels is -1; need 0 or more"):
        catmull_clark(BOX, -1)
    with pytest.raises(MeshError, match=r"crease \[0, 7\] is not an edge of the mesh"):
        catmull_clark(BOX, 1, creases=np.array([[0, 2], [0, 7]]))
    with pytest.raises(MeshError, match="belongs to one quad only"):
        catmull_clark(QuadMesh(BOX.vertices, BOX.quads[:5]), 1)
    with pytest.raises(OptionError, match="got a list; need a QuadMesh"):
        limit([[0, 1]])  # type: ignore[arg-type]


@pytest.mark.parametrize("crease", [[0, 10], [-1, 2], [0, 7], [3, 3], [0, 8]])
def test_creases_that_are_no_edges_are_named(crease: list[int]) -> None:
    for made in (lambda: catmull_clark(BOX, 1, [[0, 1], crease]), lambda: limit(BOX, [crease])):
        with pytest.raises(
            MeshError, match=re.escape(f"crease {crease} is not an edge of the mesh")
        ):
            made()


def test_creases_are_pairs_of_vertices_in_any_kind_of_array() -> None:
    listed, same = catmull_clark(BOX, 2, BOTTOM.tolist()), catmull_clark(BOX, 2, BOTTOM)
    assert np.array_equal(listed.mesh.vertices, same.mesh.vertices)
    assert np.array_equal(limit(BOX, BOTTOM[:, ::-1]).points, limit(BOX, BOTTOM).points)
    assert len(catmull_clark(BOX, 1, []).creases) == 0
    with pytest.raises(MeshError, match=r"creases has shape \(2,\); need \(k, 2\)"):
        catmull_clark(BOX, 1, [0, 1])
    with pytest.raises(MeshError, match=r"creases has shape \(1, 3\); need \(k, 2\)"):
        limit(BOX, [[0, 1, 3]])
    with pytest.raises(MeshError, match=r"creases holds 0\.5; need whole numbers"):
        limit(BOX, [[0.5, 1]])
