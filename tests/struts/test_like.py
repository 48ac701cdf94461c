"""Struts made like others keep their triangles, whatever moves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from scaffold_cad import RoundStruts, Skeleton, read_skeleton, round_struts, self_intersections
from scaffold_cad.errors import OptionError, PartitionError
from scaffold_cad.solid.clusters.fewest import fewest_sides
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.meshes.surface import sized_rings, triangulated
from scaffold_cad.struts.options import Joints
from tests.crossings import check_as_written
from tests.test_examples import EXAMPLES


def bent(degrees: float) -> Skeleton:
    angle = np.radians(degrees)
    tip = [20 + 20 * np.cos(angle), 20 * np.sin(angle), 0]
    return Skeleton([[0, 0, 0], [20, 0, 0], tip], [[0, 1], [1, 2]], 2.0)


def swaying(tree: Skeleton, phase: float) -> Skeleton:
    height = tree.nodes[:, 2] / np.ptp(tree.nodes[:, 2])
    sway = 0.06 * np.ptp(tree.nodes[:, 2]) * np.sin(phase) * height**2
    return tree.moved(tree.nodes + np.stack([sway, 0 * sway, 0 * sway], axis=1))


def check_same(first: RoundStruts, frames: list[RoundStruts]) -> None:
    start = triangulated(first, 12).mesh
    for struts in frames:
        assert len(struts.overlapping) == 0
        mesh = triangulated(struts, 12).mesh
        assert np.array_equal(mesh.triangles, start.triangles)
        mesh.check_closed()
        assert mesh.signed_volume == pytest.approx(start.signed_volume, rel=0.1)


def test_an_elbow_keeps_its_triangles_from_0_to_90_degrees() -> None:
    first = round_struts(bent(45))
    check_same(first, [round_struts(bent(turn), like=first) for turn in np.linspace(0.5, 90, 10)])


def test_a_swaying_tree_keeps_its_triangles() -> None:
    tree = read_skeleton(EXAMPLES / "skeletons" / "tree.json")
    tree = tree.with_radii(0.5 * tree.radii)
    first = round_struts(tree)
    frames = [round_struts(swaying(tree, phase), like=first) for phase in np.linspace(0, 6, 5)]
    check_same(first, frames)


def test_triangles_of_moved_blends_are_unfolded_and_stay() -> None:
    tips = [[12.7, -5.3, -3.1], [-12.1, 13, -1.3], [4.3, -10.6, 9], [-2.7, 19.2, -3.9]]
    moved = [[12.5, -5.8, -2.6], [-11.8, 12.6, -0.4], [3.7, -10, 10.2], [-2.3, 18.7, -3]]
    first, second = (
        Skeleton([[0, 0, 0], *ends], [[0, k + 1] for k in range(5)], 1.0)
        for ends in ([*tips, [-3.9, 4.8, 8.5]], [*moved, [-3.4, 4.5, 9.4]])
    )
    start = round_struts(first, blend=0.14)
    struts = round_struts(second, blend=0.14, like=start)
    mesh = round_mesh(struts, 12)
    assert np.array_equal(mesh.triangles, round_mesh(start, 12).triangles)
    check_as_written(mesh)


def test_another_graph_is_refused() -> None:
    with pytest.raises(OptionError, match="like has 2 edges, which are not the skeleton's 1; need"):
        round_struts(Skeleton([[0, 0, 0], [9, 0, 0]], [[0, 1]], 1.0), like=round_struts(bent(45)))


def test_other_ends_are_refused() -> None:
    with pytest.raises(OptionError, match="like has ends='flat' and wall=None; need the same"):
        round_struts(bent(50), ends="round", like=round_struts(bent(45)))


def test_a_joint_that_was_straight_is_refused_where_it_bends() -> None:
    with pytest.raises(OptionError, match="node 1 was a straight joint in like, and bends now"):
        round_struts(bent(45), like=round_struts(bent(0)))


def jib(degrees: float) -> Skeleton:
    """Return a space frame of two nodes, of which one strut of six is turned."""
    angle = np.radians(degrees)
    tip = np.array([40 * np.cos(angle), 40 * np.sin(angle), 0])
    ends = [[0, 20, 9], [0, -20, 9], [-20, 0, 0], [0, 0, -20]]
    edges = [[0, 1], [0, 2], [0, 3], [0, 4], [0, 5], [1, 6], [1, 7]]
    others = tip + np.array([[0, 0, 30], [9, -20, -20]])
    return Skeleton([[0, 0, 0], tip, *ends, *others], edges, 1.0)


def test_balls_keep_their_triangles_where_struts_turn() -> None:
    first = round_struts(jib(0), nodes="ball")
    frames = [round_struts(jib(turn), nodes="ball", like=first) for turn in (0, 10, 25)]
    check_same(first, frames)
    start = triangulated(first, 12).mesh
    np.testing.assert_allclose(triangulated(frames[0], 12).mesh.vertices, start.vertices, atol=1e-9)
    again = round_struts(jib(25), nodes="ball", like=frames[1])
    check_same(first, [again])
    free = triangulated(round_struts(jib(25), nodes="ball"), 12).mesh
    assert triangulated(again, 12).mesh.signed_volume == pytest.approx(free.signed_volume, rel=3e-3)


def test_hollow_balls_keep_their_triangles() -> None:
    first = round_struts(jib(0), nodes="ball", wall=0.4)
    check_same(first, [round_struts(jib(8), nodes="ball", wall=0.4, like=first)])


def test_a_node_that_turns_as_a_whole_turns_its_triangles() -> None:
    first = round_struts(jib(0), nodes="ball")
    turned = round_struts(jib(0).turned(1.3), nodes="ball", like=first)
    check_same(first, [turned])
    start, mesh = (triangulated(each, 12).mesh for each in (first, turned))
    assert mesh.signed_volume == pytest.approx(start.signed_volume, rel=1e-5)


def test_balls_whose_struts_turn_too_far_are_named() -> None:
    first = round_struts(jib(0), nodes="ball")
    far = round_struts(jib(0).mirrored([0, 1, 0]), nodes="ball", like=first)
    with pytest.raises(PartitionError, match=r"struts of node 1 at \[40, 0, 0\] mm turned too far"):
        triangulated(far, 12)


def branched(shift: float) -> Skeleton:
    """Return a tree of struts of five radii, with a ball at one node, whose nodes are shifted."""
    nodes = [[0, 0, 0], [25, 0, 3], [-20, 9, 0], [0, -22, 6], [38, 18, 0], [40, -15, 12]]
    ways = [[0, 0, 1], [1, -2, 0], [0, 1, 2], [2, 0, 1], [-1, 0, 2], [1, 1, 0]]
    edges = [[0, 1], [0, 2], [0, 3], [1, 4], [1, 5]]
    sizes = np.array([1.5, 1.2, 0.8, 0.9, 1.1])
    places = np.array(nodes) + shift * np.array(ways)
    return Skeleton(places, edges, [1.5, 2.2, 1.2, 0.8, 0.9, 1.1], sizes)


def thin_tee(shift: float) -> Skeleton:
    ends = [[0, 0, 0], [25, 0, 0], [-25, 0, 0], [4, 3 * shift, 20]]
    return Skeleton(ends, [[0, 1], [0, 2], [0, 3]], 1.5, edge_radii=[1.5, 1.5, 0.6])


@pytest.mark.parametrize("made", [branched, thin_tee, lambda shift: bent(60 + 9 * shift)])
def test_sharp_nodes_keep_their_triangles(made: Callable[[float], Skeleton]) -> None:
    first = round_struts(made(0.0), nodes="sharp")
    frames = [first]
    for shift in (0.0, 0.8, 1.6):
        frames.append(round_struts(made(shift), nodes="sharp", like=frames[-1]))
    check_same(first, frames)
    start = triangulated(first, 12).mesh
    np.testing.assert_allclose(triangulated(frames[1], 12).mesh.vertices, start.vertices, atol=1e-9)
    mesh = triangulated(frames[-1], 12).mesh
    check_as_written(mesh)
    free = triangulated(round_struts(made(1.6), nodes="sharp"), 12).mesh
    assert mesh.signed_volume == pytest.approx(free.signed_volume, rel=5e-4)


def test_points_slide_where_triangles_would_turn_over() -> None:
    def corner(tip: float) -> Skeleton:
        ends = [[0, 0, 0], [25, 0, 0], [0, 25, 0], [tip, 0, 25]]
        return Skeleton(ends, [[0, 1], [0, 2], [0, 3]], 1.5, edge_radii=[1.2, 0.9, 0.7])

    first = round_struts(corner(0), nodes="sharp")
    mesh = triangulated(round_struts(corner(-5), nodes="sharp", like=first), 12).mesh
    check_as_written(mesh)
    free = triangulated(round_struts(corner(-5), nodes="sharp"), 12).mesh
    assert mesh.signed_volume == pytest.approx(free.signed_volume, rel=5e-4)


def test_corners_of_four_edges_may_part_either_way() -> None:
    def crossing(shift: float) -> Skeleton:
        ends = [[0, 0, 0], [25, shift, 0], [-25, 0, shift], [0, 25, -shift], [shift, -25, 0]]
        return Skeleton(ends, [[0, 1], [0, 2], [0, 3], [0, 4]], 1.0)

    first = round_struts(crossing(0), nodes="sharp")
    one = round_struts(crossing(1), nodes="sharp", like=first)
    other = round_struts(crossing(-1), nodes="sharp", like=one)
    check_same(first, [one, other])
    mesh = triangulated(other, 12).mesh
    check_as_written(mesh)
    free = triangulated(round_struts(crossing(-1), nodes="sharp"), 12).mesh
    assert mesh.signed_volume == pytest.approx(free.signed_volume, rel=2e-4)


def test_sharp_nodes_that_meet_in_other_edges_are_named() -> None:
    first = round_struts(bent(80), nodes="sharp")
    with pytest.raises(PartitionError, match=r"node 1 at \[20, 0, 0\] mm meet in other edges than"):
        triangulated(round_struts(bent(100), nodes="sharp", like=first), 12)


def test_other_nodes_are_refused() -> None:
    with pytest.raises(OptionError, match="like has nodes='blend', not 'ball'; need the same"):
        round_struts(bent(50), nodes="ball", like=round_struts(bent(45)))


def test_struts_that_come_near_each_other_keep_the_sides_of_the_first() -> None:
    def pair(gap: float) -> Skeleton:
        ends = [[0, 0, 0], [20, 0, 0], [0, 2 + gap, 0], [20, 2 + gap, 0]]
        return Skeleton(ends, [[0, 1], [2, 3]], 1.0)

    near, far = round_struts(pair(0.05)), round_struts(pair(1.0))
    assert (fewest_sides(near, 16), fewest_sides(far, 16)) == (32, 16)
    assert fewest_sides(round_struts(pair(1.0), like=near), 16) == 32
    assert fewest_sides(round_struts(pair(0.05), like=far), 16) == 16


@pytest.mark.parametrize("joints", ["blend", "curve"])
def test_struts_beside_straight_joints_twist_no_more_than_in_the_first(joints: Joints) -> None:
    nodes = np.array([[0, 0, 0], [0, 0, 40], [0, 0, 70], [25, 0, 90], [-20, 15, 95], [-5, -25, 99]])
    edges = [[0, 1], [1, 2], [2, 3], [2, 4], [2, 5]]
    radii = np.array([[6, 5], [5, 5], [3, 2], [2, 2], [3, 3]])  # a cone ends at the joint
    tree = Skeleton(nodes, edges, 1.0).with_edge_radii(radii)
    first = round_struts(tree, joints=joints)
    shift = triangulated(first, 16).shift
    before = sized_rings(first, 16, shift).twist
    for way in ([0.03, 0, 0], [-0.03, -0.01, 0], [0, 0.05, 0.0]):
        swayed = tree.moved(nodes + nodes[:, 2:] * way)
        struts = round_struts(swayed, joints=joints, like=first)
        twist = sized_rings(struts, 16, shift).twist
        np.testing.assert_allclose(twist, before, atol=np.radians(3))
        assert len(self_intersections(triangulated(struts, 16).mesh)) == 0


def test_a_bend_between_branches_may_go_through_straight_to_the_other_side() -> None:
    def frame(aside: float) -> Skeleton:
        fork = np.array([[0, 0, 0], [-9, 0, 9], [-9, 0, -9], [0, -9, 0]])
        nodes = np.concatenate([fork, [[30, 0, aside]], [60, 0, 0] - fork])
        edges = [[0, 1], [0, 2], [0, 3], [0, 4], [4, 5], [5, 6], [5, 7], [5, 8]]
        return Skeleton(nodes, edges, 1.5)

    first = round_struts(frame(-4.0), joints="blend")
    shift = triangulated(first, 16).shift
    before = sized_rings(first, 16, shift).twist
    for aside in (-0.5, 0.5, 4.0):
        struts = round_struts(frame(aside), joints="blend", like=first)
        twist = sized_rings(struts, 16, shift).twist
        np.testing.assert_allclose(twist, before, atol=np.radians(10))


def test_struts_that_overlap_name_themselves_where_triangles_change(
    caplog: pytest.LogCaptureFixture,
) -> None:
    nodes = np.array([[-9, 0, 0], [9, 0, 0], [0, -9, 1.5], [0, 9, 1.5]], float)
    start = round_struts(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))
    moved = round_struts(Skeleton(nodes * [1, 1, 0.8], [[0, 1], [2, 3]], 1.0), like=start)
    one, other = (round_mesh(struts, 12).triangles for struts in (start, moved))
    assert not np.array_equal(one, other)
    (said,) = [line for line in caplog.messages if "`like`" in line]
    assert said.startswith("2 struts are crowded or overlap, whose triangles are not those of")
    caplog.clear()
    apart = round_struts(Skeleton(nodes * [1, 1, 2], [[0, 1], [2, 3]], 1.0))
    round_mesh(round_struts(Skeleton(nodes * [1, 1, 3], [[0, 1], [2, 3]], 1.0), like=apart), 12)
    assert not caplog.messages
