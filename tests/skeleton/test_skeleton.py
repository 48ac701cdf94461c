from __future__ import annotations

import pickle
import re
from collections.abc import Callable
from copy import copy, deepcopy
from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest
from build123d import Vector, Vertex
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton import Skeleton, check_skeleton
from scaffold_cad.skeleton.repair import Repairs
from tests.skeletons import (
    ELBOW,
    FIGURE_EIGHT,
    LOLLIPOP,
    NAMED,
    RING,
    STICK_FIGURE,
    STRAIGHT_THROUGH,
    STRUT,
    TETRAPOD,
    THETA,
    TREFOIL,
    TWO_STRUTS,
    polyline,
)
from tests.strategies import skeletons


def make(nodes: Any, edges: Any, radii: Any = 1.0) -> Skeleton:
    return Skeleton(np.array(nodes, float), np.array(edges), np.array(radii, float))


# Construction


def test_lists_are_taken_and_a_single_radius_stands_for_all() -> None:
    skeleton = Skeleton([[0, 0, 0], [1, 0, 0]], [[0, 1]], 2)
    assert skeleton.radii.tolist() == [2, 2]
    assert skeleton.nodes.dtype == np.float64


def test_points_of_build123d_and_whole_numbers_of_text_files_are_taken() -> None:
    edges = np.loadtxt(["0 1", "1 2"])
    skeleton = Skeleton([Vector(0, 0, 0), Vertex(1, 0, 0), (2, 1, 0)], edges, 1.0)
    assert skeleton.nodes.tolist() == [[0, 0, 0], [1, 0, 0], [2, 1, 0]]
    assert skeleton.edges.tolist() == [[0, 1], [1, 2]]
    assert skeleton.moved_by(Vector(1, 2, 3)).nodes[0].tolist() == [1, 2, 3]
    assert skeleton.mirrored(Vector(1, 0, 0)).nodes[1].tolist() == [-1, 0, 0]


def test_a_skeleton_is_printed_by_its_shapes() -> None:
    arrays = r"nodes=<5 × 3 float64>, edges=<4 × 2 int\d+>, radii=<5 float64>"
    expected = rf"Skeleton\({arrays}, edge_radii=<4 × 2 float64>\)"
    assert re.fullmatch(expected, repr(TETRAPOD))


def test_a_skeleton_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        STRUT.nodes = np.zeros((2, 3))  # type: ignore[misc]
    for name in ("nodes", "edges", "radii", "valency", "lengths", "directions"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(STICK_FIGURE, name)[0] = 0


@pytest.mark.parametrize("copied", [copy, deepcopy, lambda each: pickle.loads(pickle.dumps(each))])
def test_no_copy_of_a_skeleton_can_be_changed(copied: Callable[[Skeleton], Skeleton]) -> None:
    skeleton = STICK_FIGURE.moved(STICK_FIGURE.nodes)
    assert skeleton.valency[0] == 3
    other = copied(skeleton)
    for name in ("nodes", "edges", "radii", "valency", "lengths", "directions"):
        np.testing.assert_array_equal(getattr(other, name), getattr(skeleton, name))
        assert not getattr(other, name).flags.writeable


def test_arrays_of_the_caller_are_copied() -> None:
    nodes = np.array([[0.0, 0, 0], [1, 0, 0]])
    skeleton = make(nodes, [[0, 1]])
    nodes[0] = 5
    assert skeleton.nodes[0].tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("nodes", "edges", "radii", "message"),
    [
        ([[0, 0, 0], [np.nan, 0, 0]], [[0, 1]], 1, r"nodes\[1\] is \[nan, 0.0, 0.0\]; need fin"),
        ([[0, 0], [1, 0]], [[0, 1]], 1, r"nodes has shape \(2, 2\); need \(n, 3\)"),
        ([[0, 0, 0], [1, 0, 0]], [[0, 2]], 1, r"edges\[0\] joins nodes \[0, 2\]; need 0 to 1"),
        (
            [[0, 0, 0], [1, 0, 0]],
            [[0, 1]],
            [1, 0],
            r"node 1 at \[1, 0, 0\] mm has radius 0 mm; need",
        ),
        ([[0, 0, 0], [1, 0, 0]], [[0, 1]], [1], r"radii has shape \(1,\); need \(2,\), one per"),
        (
            [[0, 0, 0], [0, -1e30, 0]],
            [[0, 1]],
            1,
            r"node 1 is at \[0.0, -1e\+30, 0.0\] mm; need at",
        ),
        ([[0, 0, 0], [1, 0, 0]], [[0, 1]], [1, 1e30], r"node 1 has radius 1e\+30 mm; need at most"),
    ],
)
def test_what_is_no_graph_is_refused(nodes: Any, edges: Any, radii: Any, message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        make(nodes, edges, radii)


# What can be asked of it


def test_nodes_are_told_apart_by_valency() -> None:
    assert STICK_FIGURE.branch_points.tolist() == [0, 1]
    assert STICK_FIGURE.joints.tolist() == [3, 5, 7, 9]
    assert STICK_FIGURE.extremities.tolist() == [2, 4, 6, 8, 10]
    assert STICK_FIGURE.valency.tolist() == [3, 4, 1, 2, 1, 2, 1, 2, 1, 2, 1]


@pytest.mark.parametrize(
    ("name", "components", "loops"),
    [
        ("strut", 1, 0),
        ("two_struts", 2, 0),
        ("ring", 1, 1),
        ("lollipop", 1, 1),
        ("figure_eight", 1, 2),
        ("theta", 1, 2),
        ("k4", 1, 3),
        ("cube", 1, 5),
        ("stick_figure", 1, 0),
    ],
)
def test_components_and_loops_are_counted(name: str, components: int, loops: int) -> None:
    assert (NAMED[name].component_count, NAMED[name].loop_count) == (components, loops)


def test_a_skeleton_of_nothing_has_nothing() -> None:
    empty = make(np.zeros((0, 3)), np.zeros((0, 2), dtype=int), [])
    assert (empty.component_count, empty.loop_count) == (0, 0)
    assert empty.lengths.tolist() == []
    assert empty.directions.shape == (0, 3)


@given(skeletons())
def test_directions_and_lengths_lead_from_each_node_to_its_neighbors(skeleton: Skeleton) -> None:
    tails = skeleton.edges.reshape(-1)
    heads = tails[np.arange(len(tails)) ^ 1]
    reached = skeleton.nodes[tails] + skeleton.directions * np.repeat(skeleton.lengths, 2)[:, None]
    np.testing.assert_allclose(reached, skeleton.nodes[heads], atol=1e-12 * 100)
    np.testing.assert_allclose(np.linalg.norm(skeleton.directions, axis=1), 1.0)


# Changes


def test_moving_keeps_the_graph_and_the_radii() -> None:
    moved = STICK_FIGURE.moved(STICK_FIGURE.nodes + np.array([1, 2, 3]))
    np.testing.assert_array_equal(moved.edges, STICK_FIGURE.edges)
    np.testing.assert_array_equal(moved.radii, STICK_FIGURE.radii)
    assert moved.nodes[0].tolist() == [1, 2, 23]


def test_moving_needs_a_place_for_each_node() -> None:
    with pytest.raises(SkeletonError, match=r"edges\[0\] joins nodes \[0, 1\]; need 0 to 0"):
        STRUT.moved([[0, 0, 0]])


def test_radii_may_be_given_anew_one_or_all() -> None:
    assert STRUT.with_radii(3).radii.tolist() == [3, 3]
    assert STRUT.with_radii([3, 4]).radii.tolist() == [3, 4]
    along = STRUT.with_radii(lambda places: 1 + places[:, 0])
    assert along.radii.tolist() == (1 + STRUT.nodes[:, 0]).tolist()
    assert along.edge_radii.tolist() == along.radii[STRUT.edges].tolist()


def test_scaling_scales_positions_and_radii() -> None:
    scaled = ELBOW.scaled(2.5)
    assert scaled.nodes[2].tolist() == [25, 25, 0]
    assert scaled.radii.tolist() == [2.5, 2.5, 2.5]


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, np.inf])
def test_a_scale_that_is_none_is_refused(factor: float) -> None:
    with pytest.raises(OptionError, match=r"scale factor is \S+; need > 0"):
        STRUT.scaled(factor)


def test_a_scale_that_leads_out_of_range_is_refused() -> None:
    with pytest.raises(OptionError, match=r"scale factor is 1e\+308; need at most 1e\+12"):
        ELBOW.scaled(1e308)
    with pytest.raises(SkeletonError, match=r"node 1 is at .* need at most 1e\+12"):
        ELBOW.scaled(1e12)
    check_skeleton(ELBOW.scaled(1e11))


# Checking and cleaning


@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_named_skeletons_are_sound(skeleton: Skeleton) -> None:
    check_skeleton(skeleton)
    assert skeleton.cleaned().repairs.total == 0


@pytest.mark.parametrize(
    ("nodes", "edges", "message"),
    [
        (np.zeros((0, 3)), np.zeros((0, 2), dtype=int), "the skeleton has no edges; need at least"),
        ([[0, 0, 0]], np.zeros((0, 2), dtype=int), "the skeleton has no edges; need at least one"),
        (
            [[0, 0, 0], [1, 0, 0]],
            [[0, 1], [1, 1]],
            r"edge 1 joins node 1 at \[1, 0, 0\] mm to itself",
        ),
        ([[0, 0, 0], [1, 0, 0], [2, 2, 2]], [[0, 1]], r"node 2 at \[2, 2, 2\] mm has no edge"),
        (
            [[0, 0, 0], [1, 0, 0], [-0.0, 0, 0], [0, 1, 0]],
            [[0, 1], [2, 3]],
            r"nodes 0 and 2 are both at \[-?0, 0, 0\] mm; need distinct places",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [1, 1e-180, 0]],
            [[0, 1], [1, 2]],
            r"edge 1 near \[.*\] mm is 0 mm long; need at least 1e-100",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [2, 1, 0]],
            [[0, 1], [1, 2], [1, 0]],
            r"edges 0 and 2 near \[.*\] mm both join nodes \[1, 0\]; need each edge once",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [9, 1e-4, 0]],
            [[1, 0], [0, 2]],
            r"edges 0 and 1 leave node 0 at \[0, 0, 0\] mm in the same direction; need more",
        ),
    ],
)
def test_what_cannot_be_scaffolded_is_refused(nodes: Any, edges: Any, message: str) -> None:
    with pytest.raises(SkeletonError, match=message):
        check_skeleton(make(nodes, edges, np.ones(len(nodes))))


def test_the_message_says_how_to_repair_it() -> None:
    skeleton = make([[0, 0, 0], [1, 0, 0], [2, 2, 2]], [[0, 1]])
    with pytest.raises(SkeletonError, match=r"\(use Skeleton\.cleaned\(\) to repair it\)"):
        check_skeleton(skeleton)
    check_skeleton(skeleton.cleaned().skeleton)


def test_opposite_edges_are_sound() -> None:
    check_skeleton(STRAIGHT_THROUGH)


def test_cleaning_repairs_and_reports() -> None:
    skeleton = make(
        [[0, 0, 0], [10, 0, 0], [10, 0, 0.01], [20, 0, 5], [10, 9, 0], [5, 0, 0], [5, 5, 0]],
        [[0, 1], [2, 3], [1, 2], [6, 5]],
    )
    cleaning = skeleton.cleaned(weld_distance=0.1, split_contacts=True)
    assert cleaning.repairs == Repairs(
        nodes_welded=1, zero_length_edges=1, contacts_split=1, isolated_nodes=1
    )
    check_skeleton(cleaning.skeleton)
    assert len(cleaning.skeleton.edges) == 4


# Simplifying


def test_joints_on_a_line_go_and_the_corner_stays() -> None:
    fine = make(
        [[0, 0, 0], [5, 0, 0], [10, 0, 0], [10, 5, 0], [10, 10, 0]], polyline(5), np.full(5, 0.5)
    )
    thin = fine.simplified(0.01)
    assert thin.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0]]


def test_a_tolerance_keeps_more_or_less() -> None:
    turn = np.linspace(0, np.pi / 2, 100)
    arc = np.stack([50 * np.cos(turn), 50 * np.sin(turn), 0 * turn], axis=1)
    skeleton = make(arc, polyline(100), np.full(100, 0.1))
    counts = [len(skeleton.simplified(tolerance).nodes) for tolerance in (0.0, 0.01, 0.1, 1.0, 100)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] == 100
    assert counts[-1] == 2
    middle = skeleton.simplified(0.1).nodes
    between = (middle[:-1] + middle[1:]) / 2
    assert (50 - np.linalg.norm(between, axis=1)).max() <= 0.1


@pytest.mark.parametrize("skeleton", [RING, TREFOIL], ids=["ring", "trefoil"])
def test_a_ring_stays_a_ring(skeleton: Skeleton) -> None:
    thin = skeleton.simplified(1000.0)
    assert (len(thin.nodes), thin.loop_count) == (3, 1)


@pytest.mark.parametrize("skeleton", [LOLLIPOP, FIGURE_EIGHT, THETA, TWO_STRUTS])
def test_branches_are_not_merged_however_large_the_tolerance(skeleton: Skeleton) -> None:
    thin = skeleton.simplified(1000.0)
    check_skeleton(thin)
    assert thin.loop_count == skeleton.loop_count
    assert thin.component_count == skeleton.component_count


def test_of_parallel_branches_the_farthest_joint_stays() -> None:
    # The middle sample of the second branch lies on the first: it would not keep them apart.
    skeleton = make(
        [[0, 0, 0], [12, 0, 0], [3, 4, 0], [6, 0, 0], [9, -3, 0], [-5, 0, 5], [17, 0, 5]],
        [[0, 1], [0, 2], [2, 3], [3, 4], [4, 1], [5, 0], [1, 6]],
        np.full(7, 0.1),
    )
    thin = skeleton.simplified(1000.0)
    assert thin.nodes.tolist() == skeleton.nodes[[0, 1, 2, 5, 6]].tolist()
    assert thin.loop_count == 1


@given(skeletons(), st.floats(0.0, 3.0))
def test_ends_of_branches_loops_and_components_stay(skeleton: Skeleton, tolerance: float) -> None:
    thin = skeleton.with_radii(0.1).simplified(tolerance)
    check_skeleton(thin)
    ends = skeleton.nodes[skeleton.valency != 2]
    places = {tuple(row) for row in thin.nodes.tolist()}
    assert (
        {tuple(row) for row in ends.tolist()}
        <= places
        <= {tuple(row) for row in skeleton.nodes.tolist()}
    )
    assert thin.component_count == skeleton.component_count
    assert thin.loop_count == skeleton.loop_count


@pytest.mark.parametrize("tolerance", [-1.0, np.nan, np.inf])
def test_a_tolerance_that_is_none_is_refused(tolerance: float) -> None:
    with pytest.raises(OptionError, match=r"simplification tolerance is \S+ mm; need >= 0"):
        STRUT.simplified(tolerance)


@pytest.mark.parametrize(
    "change",
    [
        lambda s: s.moved(s.nodes + 1),
        lambda s: s.with_radii(3.0),
        lambda s: s.scaled(2.0),
        lambda s: s.cleaned().skeleton,
        lambda s: s.simplified(0.1),
    ],
)
def test_a_change_leaves_the_original_as_it_is(change: Callable[[Skeleton], Skeleton]) -> None:
    before = [array.copy() for array in (TREFOIL.nodes, TREFOIL.edges, TREFOIL.radii)]
    change(TREFOIL)
    for after, kept in zip((TREFOIL.nodes, TREFOIL.edges, TREFOIL.radii), before, strict=True):
        np.testing.assert_array_equal(after, kept)


def test_a_radius_below_the_rounding_of_coordinates_is_refused() -> None:
    far = Skeleton([[1e6, 0, 0], [1e6, 1, 0]], [[0, 1]], [1.0, 1e-4])
    with pytest.raises(
        SkeletonError, match=r"node 1 near \[.*\] mm has radius 0\.0001 mm; need 0\.001 mm or more"
    ):
        check_skeleton(far)
    check_skeleton(far.with_radii(1e-2))


def test_some_edges_make_a_skeleton_of_their_own() -> None:
    path = Skeleton([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], polyline(4), [1, 2, 3, 4])
    for chosen in ([1, 2], np.array([1, 2]), np.array([False, True, True])):
        part = path.with_edges(chosen)
        np.testing.assert_array_equal(part.nodes, path.nodes[1:])
        np.testing.assert_array_equal(part.edges, [[0, 1], [1, 2]])
        np.testing.assert_array_equal(part.radii, [2, 3, 4])


@pytest.mark.parametrize(
    ("chosen", "message"),
    [
        ([0, 2], r"edges\[1\] is 2; need 0 to 1"),
        ([-1], r"edges\[0\] is -1; need 0 to 1"),
        ([[0, 1]], r"edges has shape \(1, 2\); need \(k,\)"),
        ([True], r"edges has shape \(1,\); need \(2,\), a mark each"),
        ([0.5], "edges holds 0.5; need whole numbers"),
        (["0"], "edges holds '0'; need whole numbers"),
        ([0, [1]], r"edges is not an array of indices: row 1 is \[1\], and row 0 is 0"),
        ([[0, 1], [1, 10**30]], "edges holds 1000000000000000000000000000000; need whole"),
    ],
)
def test_edges_that_cannot_be_chosen_are_refused(chosen: Any, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        ELBOW.with_edges(chosen)


def test_a_half_edge_leaves_each_extremity() -> None:
    path = Skeleton([[0, 0, 0], [1, 0, 0], [2, 0, 0]], polyline(3), 1.0)
    np.testing.assert_array_equal(path.leaving_extremities, [0, 3])
