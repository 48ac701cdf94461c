"""Bevels: struts keep their thickness at sharp bends, and gentle bends stay coarse."""

from __future__ import annotations

import logging

import numpy as np
import pytest

from scaffold_cad.base.vectors import dot
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.solid.manifolds import manifold_triangles
from tests.skeletons import polyline
from tests.solids import contains

SHARP = [35.0, 30.0, 20.0, 10.0]
"""Angles between the struts of zigzags that are too sharp for a miter, degrees."""


def zigzag(
    angle: float, lengths: object = 10.0, radii: object = 0.8, rise: float = 0.0
) -> Skeleton:
    """Return four struts that turn back and forth by `angle` (degrees), each a `rise` higher."""
    half = np.radians(angle) / 2
    sign = np.array([1.0, -1.0, 1.0, -1.0])
    ways = np.column_stack([sign * np.cos(half), np.full(4, np.sin(half)), np.full(4, rise)])
    steps = ways / np.linalg.norm(ways, axis=1)[:, None] * np.broadcast_to(lengths, 4)[:, None]
    return Skeleton(np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), polyline(5), radii)


def share_outside(skeleton: Skeleton, mesh: TriangleMesh) -> float:
    """Return how much of the round struts' volume lies outside of `mesh`, by points drawn in it."""
    random = np.random.default_rng(0)
    points = []
    for (a, b), radii in zip(skeleton.nodes[skeleton.edges], skeleton.edge_radii, strict=True):
        along = random.random(1500)
        size = (radii[0] + (radii[1] - radii[0]) * along) * np.sqrt(random.random(1500))
        turn = 2 * np.pi * random.random(1500)
        axis = (b - a) / np.linalg.norm(b - a)
        x = np.cross(axis, [0.36, 0.48, 0.8])
        x /= np.linalg.norm(x)
        around = np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * np.cross(axis, x)
        points.append(a + along[:, None] * (b - a) + size[:, None] * around)
    return float(1.0 - contains(mesh, np.concatenate(points)).mean())


def triangles(scaffold: Scaffold) -> TriangleMesh:
    return TriangleMesh(scaffold.mesh.vertices, scaffold.mesh.triangles)


@pytest.mark.parametrize("angle", SHARP)
@pytest.mark.parametrize("collars", [False, True])
def test_struts_keep_their_thickness_at_sharp_bends(angle: float, collars: bool) -> None:
    skeleton = zigzag(angle)
    scaffold = build_scaffold(skeleton, collars=collars)
    assert scaffold.embedding().certified
    assert len(self_intersections(scaffold.mesh)) == 0
    assert share_outside(skeleton, triangles(scaffold)) == 0.0
    # Two further sections at each of the three bends.
    assert len(scaffold.mesh.quads) == 4 * (4 + 6) + 2


@pytest.mark.parametrize("angle", SHARP)
def test_the_section_is_the_square_that_was_asked_for_all_along_the_strut(angle: float) -> None:
    scaffold = build_scaffold(zigzag(angle, rise=0.1))
    skeleton = scaffold.skeleton
    middle = np.flatnonzero((scaffold.refined.edges >= len(skeleton.nodes)).all(axis=1))
    assert len(middle) == 2
    for sleeve in middle.tolist():
        axis = scaffold.refined.directions[2 * sleeve]
        node = scaffold.refined.nodes[scaffold.refined.edges[sleeve, 0]]
        corners = scaffold.mesh.vertices[scaffold.sleeves[sleeve]] - node  # (2, 4, 3)
        across = corners - dot(corners, axis)[..., None] * axis
        np.testing.assert_allclose(across[0], across[1], atol=1e-9)
        sides = np.linalg.norm(np.roll(across[0], -1, axis=0) - across[0], axis=1)
        np.testing.assert_allclose(sides, 1.6, rtol=1e-9)


@pytest.mark.parametrize(
    "skeleton",
    [
        zigzag(20, lengths=[12.0, 9.0, 15.0, 11.0]),
        zigzag(20, rise=0.3),
        zigzag(30, radii=[0.5, 0.8, 0.4, 0.8, 0.5]),
        zigzag(20, radii=[0.5, 0.8, 0.4, 0.8, 0.5]),
    ],
)
def test_lengths_radii_and_planes_may_differ(skeleton: Skeleton) -> None:
    scaffold = build_scaffold(skeleton)
    assert scaffold.refinement.collared[1:3].all()
    assert scaffold.embedding().certified
    assert len(self_intersections(scaffold.mesh)) == 0
    assert share_outside(skeleton, triangles(scaffold)) < 1e-3


def test_struts_with_radii_of_their_own_keep_them() -> None:
    skeleton = zigzag(20).with_edge_radii([0.3, 0.8, 0.3, 0.8])
    scaffold = build_scaffold(skeleton)
    assert scaffold.embedding().certified
    # The end of the thick strut sticks out of the thin one's other side a little.
    assert share_outside(skeleton, triangles(scaffold)) < 0.03


@pytest.mark.parametrize("angle", [40.0, 60.0, 90.0])
def test_gentle_bends_have_one_section(angle: float) -> None:
    skeleton = zigzag(angle)
    scaffold = build_scaffold(skeleton)
    assert scaffold.refined is skeleton
    assert share_outside(skeleton, triangles(scaffold)) == 0.0


def test_sections_are_carried_along_bends_out_of_the_plane_without_a_twist() -> None:
    skeleton = zigzag(50, rise=0.4)
    scaffold = build_scaffold(skeleton)
    # A miter keeps the volume of all straight struts.
    assert scaffold.mesh.signed_volume == pytest.approx(1.6**2 * 40, rel=1e-9)


def test_the_papers_fit_has_one_section_at_every_bend() -> None:
    assert len(build_scaffold(zigzag(20), fit="paper").mesh.quads) == 18


def test_bends_without_room_are_told_of_and_united(caplog: pytest.LogCaptureFixture) -> None:
    skeleton = zigzag(20, lengths=[10.0, 3.0, 10.0, 10.0])
    with caplog.at_level(logging.WARNING, logger="scaffold_cad"):
        scaffold = build_scaffold(skeleton)
    (record,) = caplog.records
    assert "2 joints bend too sharply for the length of the struts" in record.getMessage()
    assert (
        "[9.84808, 1.73648, 0] mm, where struts of 10 and 3 mm meet at 20°" in record.getMessage()
    )
    assert scaffold.thinned.tolist() == [1, 2]
    assert scaffold.embedding().left_out.tolist() == [0, 1, 2]
    solid = manifold_triangles(to_solid(scaffold))
    assert share_outside(skeleton, solid) < 1e-3


def test_moved_bends_keep_their_quads() -> None:
    scaffold = build_scaffold(zigzag(20))
    for angle in (30.0, 120.0, 5.0):
        moved = build_scaffold(zigzag(angle), like=scaffold)
        assert moved.mesh.quads is scaffold.mesh.quads
        assert np.isfinite(moved.mesh.vertices).all()
        assert moved.embedding().certified == (angle > 10)
    gentle = build_scaffold(zigzag(60))
    bent = build_scaffold(zigzag(20), like=gentle)
    assert bent.mesh.quads is gentle.mesh.quads
    assert bent.thinned.tolist() == [1, 2, 3]


def test_a_ring_with_sharp_bends_closes() -> None:
    nodes = [[0, 0, 0], [20, 3, 0], [0, 6, 0], [20, 9, 3], [0, 4.5, 9]]
    skeleton = Skeleton(nodes, polyline(5, closed=True), 0.5)
    scaffold = build_scaffold(skeleton)
    scaffold.mesh.check_closed()
    assert len(scaffold.mesh.quads) == 4 * (5 + scaffold.refinement.collared.sum())
    assert scaffold.refinement.collared.any()
    assert scaffold.embedding().certified
    assert share_outside(skeleton, triangles(scaffold)) < 0.01
