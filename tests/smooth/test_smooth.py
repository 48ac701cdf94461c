"""Catmull-Clark subdivision, its limit, and the radii of smooth solids."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.spatial import cKDTree

from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import MeshError, OptionError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.scaffold.stars import Section
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import (
    Caps,
    Subdivision,
    catmull_clark,
    control_mesh,
    limit,
    smooth_mesh,
)
from tests.skeletons import (
    CUBE,
    ELBOW,
    NAMED,
    RING,
    STRUT,
    TAPER,
    TETRAPOD,
    TRIPOD,
    TWO_STRUTS,
    ZIGZAG,
)
from tests.strategies import skeletons

BOX = QuadMesh(
    [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]],
)
BOTTOM = np.array([[0, 2], [2, 6], [6, 4], [4, 0]])  # the sides of the box at z = -1


def mid_strut_radii(scaffold: Scaffold, fine: Subdivision) -> list[Floats]:
    """Return how far each strut's section in the plane across its middle is from its centre."""
    skeleton, mesh = scaffold.skeleton, fine.mesh
    edge_of_side = np.repeat(scaffold.edge_of_quad[fine.quad_of_quad], 4)
    found = []
    for edge, (start, end) in enumerate(skeleton.nodes[skeleton.edges]):
        sides = mesh.vertices[mesh.half_edges[edge_of_side == edge]]  # (k, 2, 3)
        axis = (end - start) / np.linalg.norm(end - start)
        height = (sides - (start + end) / 2) @ axis
        sides, height = sides[height[:, 0] < 0], height[height[:, 0] < 0]
        sides, height = sides[height[:, 1] >= 0], height[height[:, 1] >= 0]
        share = (height[:, 0] / (height[:, 0] - height[:, 1]))[:, None]
        section = (1 - share) * sides[:, 0] + share * sides[:, 1]
        found.append(np.linalg.norm(section - section.mean(axis=0), axis=1))
    return found


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


@pytest.mark.parametrize("caps", ["round", "flat"])
@pytest.mark.parametrize("section", ["circumscribed", "round", "inscribed"])
def test_struts_have_the_asked_radius_in_their_middle(caps: Caps, section: Section) -> None:
    for skeleton in (STRUT, TAPER, TWO_STRUTS):
        scaffold = build_scaffold(skeleton, section=section)
        measured = mid_strut_radii(scaffold, smooth_mesh(scaffold, 4, caps))
        wanted = skeleton.radii[skeleton.edges].mean(axis=1)
        for radii, radius in zip(measured, wanted, strict=True):
            assert radii.mean() == pytest.approx(radius, rel=0.01)
            assert radii == pytest.approx(np.full(len(radii), radius), rel=0.02)


@pytest.mark.parametrize("name", sorted(set(NAMED) - {"ring", "trefoil", "theta", "k4"}))
@pytest.mark.parametrize("caps", ["round", "flat"])
def test_collared_struts_have_the_asked_radius_in_their_middle(name: str, caps: Caps) -> None:
    skeleton = NAMED[name].with_radii(NAMED[name].radii * 0.5)
    scaffold = build_scaffold(skeleton, collars=True)
    measured = mid_strut_radii(scaffold, smooth_mesh(scaffold, 4, caps))
    wanted = skeleton.radii[skeleton.edges].mean(axis=1)
    for radii, radius in zip(measured, wanted, strict=True):
        assert radii.mean() == pytest.approx(radius, rel=0.02)


def test_collared_struts_are_round() -> None:
    scaffold = build_scaffold(TETRAPOD.scaled(2.0).with_radii(1.0), collars=True)
    for radii in mid_strut_radii(scaffold, smooth_mesh(scaffold, 4, "flat")):
        assert radii == pytest.approx(np.ones(len(radii)), rel=0.02)


def test_the_radius_is_kept_on_rings() -> None:
    scaffold = build_scaffold(RING)
    points = smooth_mesh(scaffold, 4).mesh.vertices
    # The tube's axis is the B-spline of the ring's nodes, a circle but for 0.1 %.
    axis = np.hypot(points[:, 0], points[:, 1])
    around = np.hypot(axis - (axis.max() + axis.min()) / 2, points[:, 2])
    assert around == pytest.approx(np.ones(len(around)), rel=0.025)


def test_domes_reach_one_radius_beyond_the_node_and_are_round() -> None:
    points = smooth_mesh(build_scaffold(STRUT), 4, "round").mesh.vertices
    assert (points[:, 0].min(), points[:, 0].max()) == pytest.approx((-1, 11), abs=0.01)
    dome = points[points[:, 0] < 0]
    assert np.linalg.norm(dome, axis=1) == pytest.approx(np.ones(len(dome)), abs=0.05)


def test_flat_caps_lie_in_the_plane_of_their_node() -> None:
    scaffold = build_scaffold(TAPER)
    fine = smooth_mesh(scaffold, 3, "flat")
    is_cap = np.isin(fine.quad_of_quad, [4, 5])
    caps = fine.mesh.vertices[fine.mesh.quads[is_cap]]
    assert caps[:, :, 2] == pytest.approx(np.repeat(caps[:, :1, 2], 4, axis=1))
    assert sorted({round(z, 9) for z in caps[:, 0, 2]}) == pytest.approx([0, 10])
    cylinder = fine.mesh.vertices[np.abs(fine.mesh.vertices[:, 2]) < 1e-9]
    assert np.hypot(*cylinder.T[:2]).max() == pytest.approx(1, rel=0.02)


def test_domes_and_both_sides_of_bends_add_four_quads_each() -> None:
    tripod = build_scaffold(TRIPOD, collars=True)
    quads = len(tripod.mesh.quads)
    control = control_mesh(tripod)
    assert len(control.mesh.quads) == quads + 3 * 4
    assert np.array_equal(control.quad_of_quad[:quads], np.arange(quads))
    added = tripod.edge_of_quad[control.quad_of_quad[quads:]]
    assert np.bincount(added).tolist() == [4, 4, 4]
    assert len(control_mesh(tripod, "flat").mesh.quads) == quads
    assert len(control_mesh(build_scaffold(ELBOW, collars=True), "flat").mesh.quads) == 10 + 8
    assert len(control_mesh(build_scaffold(ELBOW), "flat").mesh.quads) == 10 + 8


def test_collared_struts_are_straight_up_to_a_bend() -> None:
    points = smooth_mesh(build_scaffold(ELBOW, collars=True), 3, "flat").mesh.vertices
    strut = points[points[:, 0] < 7]
    assert np.hypot(strut[:, 1], strut[:, 2]).max() == pytest.approx(1, rel=0.03)


def test_a_strut_too_short_for_sections_before_its_domes_gets_none() -> None:
    for length, sections in ((2.5, 2), (0.5, 0)):
        short = STRUT.scaled(length / 10).with_radii(1.0)
        control = control_mesh(build_scaffold(short))
        assert len(control.mesh.quads) == 6 + 4 * sections
        points = smooth_mesh(build_scaffold(short), 4).mesh.vertices
        ends = (points[:, 0].min(), points[:, 0].max())
        assert ends == pytest.approx((-1, length + 1), abs=0.02)


def test_short_struts_have_the_volume_of_their_capsule() -> None:
    for length in (1.5, 2.0, 2.5, 3.0, 4.0):
        short = STRUT.scaled(length / 10).with_radii(1.0)
        volume = smooth_mesh(build_scaffold(short), 4).mesh.signed_volume
        assert volume == pytest.approx(np.pi * (length + 4 / 3), rel=0.04)


def test_the_smooth_mesh_does_not_depend_on_the_scaffolds_section() -> None:
    meshes = [
        smooth_mesh(build_scaffold(ELBOW, section=section), 2).mesh.vertices
        for section in ("circumscribed", "inscribed", "round")
    ]
    assert meshes[1] == pytest.approx(meshes[0], abs=0.02)
    assert meshes[2] == pytest.approx(meshes[0], abs=0.02)


def test_smooth_meshes_follow_turns_and_scales() -> None:
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    moved = CUBE.moved(CUBE.nodes @ turn.T).scaled(3.0)
    here = smooth_mesh(build_scaffold(CUBE, collars=True), 1).mesh.vertices
    there = smooth_mesh(build_scaffold(moved, collars=True), 1).mesh.vertices
    distance, _ = cKDTree(there).query(3.0 * here @ turn.T)
    assert distance.max() < 1e-6


def test_the_best_round_is_kept_where_more_rounds_diverge(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    generator = np.random.default_rng(46)
    count = int(generator.integers(5, 12))
    nodes = generator.uniform(-10, 10, (count, 3)).round(2)
    edges = [[int(generator.integers(0, k)), k] for k in range(1, count)]
    tree = Skeleton(nodes, edges, generator.uniform(0.3, 1.2, count).round(2))
    scaffold = build_scaffold(tree)
    caplog.set_level("DEBUG", "scaffold_cad.smooth.control")
    many = control_mesh(scaffold).mesh.vertices
    assert "times what is acceptable after 12 rounds" in caplog.text
    monkeypatch.setattr("scaffold_cad.smooth.control.MOST_ROUNDS", 4)
    few = control_mesh(scaffold).mesh.vertices
    assert np.array_equal(many, few)  # the fifth and all later ones are worse
    monkeypatch.setattr("scaffold_cad.smooth.control.MOST_ROUNDS", 3)
    assert not np.array_equal(many, control_mesh(scaffold).mesh.vertices)


def test_inputs_are_left_as_they_were() -> None:
    scaffold: Scaffold = build_scaffold(ZIGZAG)
    before = scaffold.mesh.vertices.copy()
    smooth_mesh(scaffold, 2)
    assert np.array_equal(scaffold.mesh.vertices, before)


def test_bad_arguments_are_named() -> None:
    with pytest.raises(OptionError, match="levels is -1; need 0 or more"):
        catmull_clark(BOX, -1)
    with pytest.raises(OptionError, match="caps is 'pointed'; need one of round, flat"):
        control_mesh(build_scaffold(STRUT), "pointed")  # type: ignore[arg-type]
    with pytest.raises(MeshError, match=r"crease \[0, 7\] is no edge of the mesh"):
        catmull_clark(BOX, 1, creases=np.array([[0, 2], [0, 7]]))
    with pytest.raises(MeshError, match="belongs to one quad only"):
        catmull_clark(QuadMesh(BOX.vertices, BOX.quads[:5]), 1)
    with pytest.raises(OptionError, match="got a list; need a QuadMesh"):
        limit([[0, 1]])  # type: ignore[arg-type]


@pytest.mark.parametrize("crease", [[0, 10], [-1, 2], [0, 7], [3, 3], [0, 8]])
def test_creases_that_are_no_edges_are_named(crease: list[int]) -> None:
    for made in (lambda: catmull_clark(BOX, 1, [[0, 1], crease]), lambda: limit(BOX, [crease])):
        with pytest.raises(MeshError, match=re.escape(f"crease {crease} is no edge of the mesh")):
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
