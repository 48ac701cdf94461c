"""Collars at steps: struts with radii of their own keep them up to joints and extremities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.base.vectors import dot
from scaffold_cad.io import read_skeleton
from scaffold_cad.lattice import tile
from scaffold_cad.mechanics import hexahedra
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.scaffold import Scaffold, build_scaffold
from scaffold_cad.skeleton import Skeleton
from tests.scaffold.test_bevels import share_outside, triangles, zigzag
from tests.skeletons import polyline
from tests.solids import check_watertight

BENT = [[0, 0, 0], [12, 0, 0], [20, 8, 0], [20, 20, 4], [32, 20, 4]]
"""Nodes of four struts, the sharpest bend of 106° between them."""


def path(edge_radii: object, radii: object = None) -> Skeleton:
    return Skeleton(BENT, polyline(5), radii, edge_radii)


def random_path(seed: int) -> Skeleton:
    """Return eight struts that bend by up to 75°, each of a radius between 0.5 and 2 mm."""
    random = np.random.default_rng(seed)
    way, nodes = np.array([1.0, 0.0, 0.0]), [np.zeros(3)]
    for _ in range(8):
        nodes.append(nodes[-1] + random.uniform(8.0, 16.0) * way)
        across = np.cross(way, random.normal(size=3))
        turn = np.radians(random.uniform(0.0, 75.0))
        way = np.cos(turn) * way + np.sin(turn) * across / np.linalg.norm(across)
    return Skeleton(nodes, polyline(9), edge_radii=random.uniform(0.5, 2.0, 8))


def widths(scaffold: Scaffold, edge: int) -> np.ndarray:
    """Return the sides, seen along the strut, of the longest of a strut's sleeves, (2, 4), mm."""
    sleeves = np.flatnonzero(scaffold.refinement.edge_of_edge == edge)
    sleeve = sleeves[np.argmax(scaffold.refined.lengths[sleeves])]
    corners = scaffold.mesh.vertices[scaffold.sleeves[sleeve]]
    sides = np.roll(corners, -1, axis=1) - corners
    axis = np.broadcast_to(scaffold.refined.directions[2 * sleeve], sides.shape)
    return np.linalg.norm(sides - dot(sides, axis)[..., None] * axis, axis=2)


def check_whole(scaffold: Scaffold) -> None:
    assert scaffold.embedding().certified
    assert len(self_intersections(scaffold.mesh)) == 0
    check_watertight(triangles(scaffold))


@pytest.mark.parametrize("radii", [[2.0, 0.8, 1.6, 0.6], [1.0, 0.5, 1.0, 0.5]])
def test_struts_keep_their_section_up_to_a_step(radii: list[float]) -> None:
    scaffold = build_scaffold(path(radii), collars=True)
    check_whole(scaffold)
    # The thinner strut at each joint has a collar there.
    assert scaffold.refinement.collared.tolist() == [
        [False, False],
        [True, True],
        [False, False],
        [True, False],
    ]
    for edge, radius in enumerate(radii):
        np.testing.assert_allclose(widths(scaffold, edge), 2.0 * radius, rtol=1e-9)
    # The end of the thick strut sticks out of the thin one inside of the bend a little.
    assert share_outside(scaffold.skeleton, triangles(scaffold)) < 1e-3


def test_joints_whose_radii_agree_stay_as_they_are() -> None:
    tapered = path([[2.0, 1.5], [1.5, 1.5], [1.5, 0.5], [0.5, 0.5]])
    scaffold = build_scaffold(tapered, collars=True)
    assert not scaffold.refinement.collared.any()
    np.testing.assert_array_equal(scaffold.mesh.vertices, build_scaffold(tapered).mesh.vertices)


def test_nodes_thicker_than_all_their_struts_are_lumps_of_their_size() -> None:
    ball, strut = 2.0, 0.5
    line = Skeleton(
        [[0, 0, 0], [20, 0, 0], [40, 0, 0]], polyline(3), [strut, ball, ball], [strut, strut]
    )
    scaffold = build_scaffold(line, section="area", collars=True)
    check_whole(scaffold)
    assert scaffold.refinement.collared.tolist() == [[False, True], [True, True]]
    # A collar stands where the strut leaves the ball, and the piece before it is a frustum.
    reach = np.sqrt(ball**2 - strut**2) + 0.5 * strut
    frustum = np.pi * reach * (ball**2 + ball * strut + strut**2) / 3.0
    rest = np.pi * strut**2 * (40.0 - 3.0 * reach)
    assert scaffold.mesh.signed_volume == pytest.approx(3.0 * frustum + rest, rel=1e-9)


def test_a_strut_too_short_for_two_collars_gets_one_or_none() -> None:
    def collars(length: float) -> list[bool]:
        nodes = [[-9, 0, 0], [0, 0, 0], [length, 0, 0], [length + 9, 0, 0]]
        skeleton = Skeleton(nodes, polyline(4), edge_radii=[2.0, 1.0, 2.0])
        scaffold = build_scaffold(skeleton, collars=True)
        check_whole(scaffold)
        return scaffold.refinement.collared[1].tolist()

    assert [collars(length) for length in (9.0, 1.0, 0.2)] == [
        [True, True],
        [True, False],
        [False, False],
    ]


def test_steps_at_sharp_bends_are_bevels() -> None:
    skeleton = zigzag(20).with_edge_radii([0.8, 0.8, 0.3, 0.3])
    scaffold = build_scaffold(skeleton, collars=True)
    assert scaffold.refinement.beveled[1:3].all()
    plain = build_scaffold(skeleton)
    np.testing.assert_array_equal(scaffold.mesh.quads, plain.mesh.quads)


@pytest.mark.parametrize("seed", range(12))
def test_random_paths_are_embedded_and_no_thicker_than_their_struts(seed: int) -> None:
    skeleton = random_path(seed)
    scaffold = build_scaffold(skeleton, collars=True)
    check_whole(scaffold)
    assert share_outside(skeleton, triangles(scaffold)) < 1e-3
    squares = float((4.0 * skeleton.edge_radii[:, 0] ** 2) @ skeleton.lengths)
    assert scaffold.mesh.signed_volume == pytest.approx(squares, rel=0.06)
    assert build_scaffold(skeleton).mesh.signed_volume > 1.15 * squares


def test_moved_steps_keep_their_quads() -> None:
    sharp = [*BENT, [24, 20, 8]]  # a bevel beside the collars
    skeleton = Skeleton(sharp, polyline(6), edge_radii=[2.0, 0.8, 1.6, 0.6, 0.6])
    scaffold = build_scaffold(skeleton, collars=True)
    assert scaffold.refinement.beveled.any()
    assert (scaffold.refinement.collared & ~scaffold.refinement.beveled).any()
    again = build_scaffold(skeleton, like=scaffold)
    np.testing.assert_allclose(again.mesh.vertices, scaffold.mesh.vertices, atol=1e-12)
    alike = skeleton.with_edge_radii([1.0, 1.0, 2.0, 0.5, 0.5])
    moved = build_scaffold(alike, like=scaffold)
    assert moved.mesh.quads is scaffold.mesh.quads
    assert moved.embedding().certified
    np.testing.assert_array_equal(moved.refinement.beveled, scaffold.refinement.beveled)


def test_hexahedra_have_the_struts_radii_on_both_sides_of_a_step() -> None:
    line = Skeleton([[0, 0, 0], [20, 0, 0], [40, 0, 0]], polyline(3), edge_radii=[2.0, 1.0])
    solid = hexahedra(build_scaffold(line, collars=True))
    assert solid.inverted.sum() == 0
    cylinders = np.pi * (2.0**2 + 1.0**2) * 20.0
    step = np.pi * (2.0**2 + 2.0 * 1.0 + 1.0**2) * 0.5 / 3.0 - np.pi * 0.5  # 0.5 mm long
    assert solid.volumes.sum() == pytest.approx(cylinders + step, rel=0.02)


def test_how_much_wider_lattices_are_is_as_the_help_tells() -> None:
    lattice = tile("octet", 8.0, (3, 3, 2), radius=0.4)
    cylinders = np.pi * 0.4**2 * lattice.lengths.sum()
    wider = [
        build_scaffold(lattice, collars=collars).mesh.signed_volume / cylinders
        for collars in (False, True)
    ]
    assert wider == pytest.approx([1.23, 1.11], abs=0.005)


def test_trusses_of_several_sections_have_the_volume_of_their_members(shared_data: Path) -> None:
    truss = read_skeleton(shared_data / "reported" / "topopt_truss3d.json")
    scaffold = build_scaffold(truss, section="area", collars=True)
    check_whole(scaffold)
    members = float((np.pi * truss.edge_radii[:, 0] ** 2) @ truss.lengths)
    assert scaffold.mesh.signed_volume == pytest.approx(members, rel=0.01)


def test_collars_in_the_middle_of_short_room_stay_where_they_are() -> None:
    tips = [[20, 0.5, 0], [20, -0.5, 0.3], [20, 0, -0.6], [20, 3, 3]]
    fan = Skeleton([[0, 0, 0], *tips], [[0, k] for k in range(1, 5)], 1.0)
    scaffold = build_scaffold(fan, collars=True, fit="paper")
    assert scaffold.refinement.collared.any()
    again = build_scaffold(fan.moved_by([0, 0, 1e-3]), like=scaffold)
    assert np.abs(again.mesh.vertices - scaffold.mesh.vertices).max() < 0.1
