"""Triangles of nodes are as near to their blends at the tips of narrow forks as elsewhere."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts, tile
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.blending.nearest import nearest_on_blends
from scaffold_cad.struts.meshes.fineness import Fineness
from scaffold_cad.struts.meshes.surface import triangulated
from tests.skeletons import BCC_STAR, TRIPOD

NEAR = 5.5
"""How far triangles of blends may be from them, over the same of polygons."""


def fork(angle: float, turn: float = 0.0, length: float = 30.0) -> Skeleton:
    """Two struts of radius 1 mm that leave a node at an angle, degrees."""
    at = np.radians([turn, turn + angle])
    tips = length * np.stack([np.cos(at), np.sin(at), 0 * at], axis=1)
    return Skeleton(np.vstack([np.zeros(3), tips]), [[0, 1], [0, 2]], 1.0)


@pytest.mark.parametrize(
    ("angle", "sides"),
    [(20, 8), (20, 32), (30, 16), (45, 8), (45, 32), (60, 16), (90, 8), (90, 32)],
)
def test_triangles_are_near_to_blends(angle: float, sides: int) -> None:
    struts = round_struts(fork(angle))
    made = triangulated(struts, sides)
    triangles = made.mesh.triangles[: len(made.node)]
    corners = made.mesh.vertices[triangles]  # (t, 3, 3)
    points = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1)])
    (group,) = struts.blended
    on, _ = nearest_on_blends(group.shapes, np.zeros(len(points), dtype=np.intp), points)
    far = np.linalg.norm(on - points, axis=1).max()
    assert far < NEAR * (1 - np.cos(np.pi / sides))


def test_only_nodes_that_need_it_have_more_samples() -> None:
    for skeleton in (TRIPOD, BCC_STAR, fork(90)):
        found = Fineness.of(round_struts(skeleton), 16)
        assert (found.steps.max(), found.levels.max()) == (4, 4)
    narrow = Fineness.of(round_struts(fork(30)), 16)
    assert (narrow.steps[0], narrow.levels[0]) > (4, 4)
    inner = round_struts(tile("bcc", 10.0, 3, radius=0.7))
    found = Fineness.of(inner, 32)
    assert (found.steps[inner.runs.valency == 8] == 8).all()


@pytest.mark.parametrize("sides", [4, 8, 12, 16, 32])
@pytest.mark.parametrize("angle", [20, 30, 60])
def test_finer_nodes_are_joined_to_their_struts(angle: float, sides: int) -> None:
    mesh = round_mesh(round_struts(fork(angle)), sides)
    mesh.check_closed()
    assert len(mesh.vertices) - len(mesh.triangles) // 2 == 2  # Euler: a sphere
    assert len(self_intersections(mesh)) == 0
    sides_of = np.diff(mesh.vertices[mesh.triangles], axis=1)  # (t, 2, 3)
    assert np.linalg.norm(np.cross(sides_of[:, 0], sides_of[:, 1]), axis=1).min() > 0


@pytest.mark.parametrize("cell", ["sc", "bcc", "truncated_cube", "rhombic_dodecahedron"])
def test_nodes_with_four_sides_keep_triangles_and_volume(cell: str) -> None:
    struts = round_struts(tile(cell, 10.0, 1, radius=0.6))
    coarse, fine = round_mesh(struts, 4), round_mesh(struts, 32)
    made = triangulated(struts, 4).mesh
    np.testing.assert_array_equal(coarse.triangles, made.triangles)  # no field
    assert coarse.signed_volume == pytest.approx(fine.signed_volume, rel=2e-3)


def test_struts_like_others_are_sampled_as_these_are() -> None:
    first = round_struts(fork(30))
    wide = round_struts(fork(70), like=first)
    meshes = [triangulated(each, 16).mesh for each in (first, wide)]
    np.testing.assert_array_equal(meshes[0].triangles, meshes[1].triangles)
    assert len(triangulated(round_struts(fork(70)), 16).mesh.triangles) < len(meshes[1].triangles)


def test_equal_nodes_are_sampled_alike() -> None:
    turns = np.linspace(0, 300, 7)
    grids = [Fineness.of(round_struts(fork(33, turn)), 16) for turn in turns]
    assert len({(int(grid.steps[0]), int(grid.levels[0])) for grid in grids}) == 1


@pytest.mark.parametrize("wall", [0.2, 0.4])
def test_walls_at_tips_of_forks_do_not_cross_with_few_sides(
    wall: float, caplog: pytest.LogCaptureFixture
) -> None:
    mesh = round_mesh(round_struts(fork(30), wall=wall), 8)
    assert len(mesh.triangles) < 2000  # no field
    assert not caplog.records


def test_crowded_nodes_are_no_finer_than_their_share() -> None:
    # Struts shorter than thick, whose cones end before their collars: these have no radius.
    nodes = [[0, -1, 0.2], [0, 0, 0], [0.2, 0.9, 0.2], [0.2, 1.8, 0.2], [0.9, 0.2, 0]]
    edges = [[0, 1], [1, 2], [2, 3], [1, 4]]
    struts = round_struts(Skeleton(nodes, edges, [1.4, 2.0, 1.1, 0.2, 0.1]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = Fineness.of(struts, 16)
    assert struts.crowded[1]
    assert (found.steps[1], found.levels[1]) == (4, 4)
    round_mesh(struts, 16).check_closed()
