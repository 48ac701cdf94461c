from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Edges, Floats, Points
from scaffold_cad.base.blocks import MEMORY
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.skeleton import Skeleton, check_skeleton, splitting
from scaffold_cad.skeleton.overlaps import overlapping_half_edges
from scaffold_cad.skeleton.repair import (
    RepairedGraph,
    Repairs,
    default_weld_distance,
    equal_positions,
    repaired,
)
from tests.skeletons import NAMED, polyline
from tests.strategies import skeletons

_STEP = st.integers(0, 3).map(float)
_PLACE = st.tuples(_STEP, _STEP, st.sampled_from([0.0, 0.0, 0.0, 1.0, np.nan]))
_RADIUS = st.sampled_from([1.0, 2.0, 3.0, 0.0, -1.0, np.nan, np.inf])


@st.composite
def faulty_graphs(draw: st.DrawFn) -> tuple[Points, Edges, Floats]:
    """Draw a graph with every fault: nodes in heaps and rows, without place or radius, ..."""
    places = draw(st.lists(_PLACE, min_size=2, max_size=12))
    index = st.integers(0, len(places) - 1)
    edges = draw(st.lists(st.tuples(index, index), min_size=1, max_size=16))
    radii = draw(st.lists(_RADIUS, min_size=len(places), max_size=len(places)))
    return np.array(places), np.array(edges), np.array(radii)


def mended(nodes: Any, edges: Any, radii: Any = 1.0, **options: Any) -> RepairedGraph:
    """Repair lists; a single radius stands for all."""
    nodes = np.array(nodes, dtype=np.float64)
    radii = np.broadcast_to(np.asarray(radii, dtype=np.float64), len(nodes)).copy()
    return repaired(nodes, np.array(edges, dtype=np.intp), radii, **options)


@given(faulty_graphs(), st.booleans())
def test_what_is_repaired_can_be_scaffolded_and_every_repair_is_counted(
    graph: tuple[Points, Edges, Floats], split_contacts: bool
) -> None:
    nodes, edges, radii = graph
    try:
        whole = repaired(nodes, edges, radii, split_contacts=split_contacts)
    except SkeletonError:  # no edge or no radius is left: other tests
        return
    check_skeleton(Skeleton(whole.nodes, whole.edges, whole.radii))
    done = whole.repairs
    assert len(nodes) - len(whole.nodes) == (
        done.nodes_without_position + done.nodes_welded + done.isolated_nodes
    )
    assert len(edges) - len(whole.edges) == (
        done.edges_without_position
        + done.zero_length_edges
        + done.duplicate_edges
        - done.contacts_split
    )
    assert {tuple(row) for row in whole.nodes.tolist()} <= {tuple(row) for row in nodes.tolist()}


@given(faulty_graphs())
def test_a_second_repair_finds_nothing(graph: tuple[Points, Edges, Floats]) -> None:
    nodes, edges, radii = graph
    try:
        once = repaired(nodes, edges, radii)
    except SkeletonError:
        return
    twice = repaired(once.nodes, once.edges, once.radii)
    assert twice.repairs == Repairs()
    np.testing.assert_array_equal(twice.edges, once.edges)


@given(skeletons())
def test_a_sound_skeleton_is_left_as_it_is(skeleton: Skeleton) -> None:
    whole = repaired(skeleton.nodes, skeleton.edges, skeleton.radii)
    assert whole.repairs.total == 0
    np.testing.assert_array_equal(whole.nodes, skeleton.nodes)
    np.testing.assert_array_equal(whole.edges, skeleton.edges)
    np.testing.assert_array_equal(whole.radii, skeleton.radii)


def test_the_input_is_untouched() -> None:
    nodes = np.array([[0.0, 0, 0], [9, 0, 0], [9, 0, 0], [5, 0, 0]])
    edges, radii = np.array([[0, 1], [0, 3], [2, 3]]), np.array([0.0, 2.0, 3.0, np.nan])
    before = nodes.copy(), edges.copy(), radii.copy()
    repaired(nodes, edges, radii, split_contacts=True)
    for after, kept in zip((nodes, edges, radii), before, strict=True):
        np.testing.assert_array_equal(after, kept)


# Welding


def test_nodes_at_one_place_become_the_first_with_the_largest_radius() -> None:
    nodes = [[9, 0, 0], [0, 0, 0], [9, 0, 0], [9, 9, 0], [9, -0.0, 0]]
    whole = mended(nodes, [[1, 2], [4, 3]], [1, 1, 3, 1, 2])
    assert whole.nodes.tolist() == [[9, 0, 0], [0, 0, 0], [9, 9, 0]]
    assert whole.edges.tolist() == [[1, 0], [0, 2]]
    assert whole.radii.tolist() == [3, 1, 1]
    assert whole.repairs == Repairs(nodes_welded=2)


def test_nodes_within_the_default_distance_are_welded_and_others_not() -> None:
    nodes = [[0, 0, 0], [1000, 0, 0], [1000, 0.9e-4, 0], [1000, 2.1e-4, 1e-4], [1000, 1000, 0]]
    whole = mended(nodes, [[0, 1], [2, 4], [3, 0]])
    assert whole.repairs.nodes_welded == 1
    assert default_weld_distance(np.array(nodes, dtype=float)) == pytest.approx(1.414e-4, rel=1e-3)
    assert default_weld_distance(np.zeros((0, 3))) == 0


def test_welding_goes_on_along_a_row_of_near_nodes() -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [10.1, 0, 0], [10.2, 0, 0], [20, 0, 0]]
    whole = mended(nodes, [[0, 1], [3, 4], [1, 2], [2, 3]], weld_distance=0.15)
    assert whole.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [20, 0, 0]]
    assert whole.repairs == Repairs(nodes_welded=2, zero_length_edges=2)


def test_a_weld_distance_of_zero_welds_equal_nodes_only() -> None:
    nodes = [[0, 0, 0], [1, 0, 0], [1, 0, 0], [1 + 1e-12, 1e-12, 0], [2, 1, 0]]
    whole = mended(nodes, [[0, 1], [2, 3], [3, 4]], weld_distance=0.0)
    assert whole.repairs.nodes_welded == 1


def test_nodes_too_close_for_their_direction_are_always_welded() -> None:
    whole = mended([[0, 0, 0], [1e-170, 0, 0], [0, 1e-90, 0]], [[0, 1], [1, 2]], weld_distance=0.0)
    assert whole.repairs == Repairs(nodes_welded=1, zero_length_edges=1)


def test_a_heap_of_equal_nodes_is_no_burden() -> None:
    count = 20_000  # as many pairs as its square would not fit in memory
    nodes = np.zeros((count, 3))
    nodes[-1] = 1.0
    edges = np.stack([np.arange(count - 1), np.full(count - 1, count - 1)], axis=1)
    whole = mended(nodes, edges)
    assert whole.repairs == Repairs(nodes_welded=count - 2, duplicate_edges=count - 2)


@pytest.mark.parametrize("distance", [-1.0, np.nan, np.inf])
def test_a_weld_distance_that_is_none_is_refused(distance: float) -> None:
    with pytest.raises(OptionError, match=r"weld distance is \S+ mm; need >= 0"):
        mended([[0, 0, 0], [1, 0, 0]], [[0, 1]], weld_distance=distance)


def test_equal_positions_are_numbered_by_their_first_point() -> None:
    points = np.array([[2.0, 0, 0], [0, 0, 0], [2, 0, 0], [1, 5, 0], [-0.0, 0, 0]])
    place, first = equal_positions(points)
    assert place.tolist() == [0, 1, 0, 2, 1]
    assert first.tolist() == [0, 1, 3]
    assert [array.tolist() for array in equal_positions(points[:0])] == [[], []]


# Nodes and edges that go


def test_nodes_without_a_place_go_with_their_edges() -> None:
    nodes = [[0, 0, 0], [np.nan, 0, 0], [5, 0, 0], [0, np.inf, 0]]
    whole = mended(nodes, [[0, 1], [2, 0], [3, 1]])
    assert whole.edges.tolist() == [[1, 0]]
    assert whole.repairs == Repairs(nodes_without_position=2, edges_without_position=2)


def test_self_loops_and_repeated_edges_go_whichever_way_they_run() -> None:
    nodes = [[0, 0, 0], [5, 0, 0], [5, 5, 0]]
    whole = mended(nodes, [[1, 1], [1, 0], [0, 1], [1, 2], [1, 0]])
    assert whole.edges.tolist() == [[1, 0], [1, 2]]
    assert whole.repairs == Repairs(zero_length_edges=1, duplicate_edges=2)


def test_isolated_nodes_go() -> None:
    whole = mended([[9, 9, 9], [0, 0, 0], [5, 5, 5], [5, 0, 0], [5, 5, 5]], [[1, 3], [2, 4]])
    assert whole.nodes.tolist() == [[0, 0, 0], [5, 0, 0]]
    assert whole.repairs == Repairs(nodes_welded=1, zero_length_edges=1, isolated_nodes=2)


@pytest.mark.parametrize("split_contacts", [False, True])
def test_a_graph_without_an_edge_is_refused(split_contacts: bool) -> None:
    for nodes, edges in [
        ([[0, 0, 0], [1, 0, 0]], np.zeros((0, 2))),
        ([[0, 0, 0], [0, 0, 0]], [[0, 1]]),
        ([[0, 0, 0], [np.nan, 0, 0]], [[0, 1]]),
        (np.zeros((0, 3)), np.zeros((0, 2))),
    ]:
        with pytest.raises(SkeletonError, match="has no edge longer than"):
            mended(nodes, edges, split_contacts=split_contacts)


# Radii


def test_radii_come_from_the_nearest_node_along_the_edges() -> None:
    # The way from 3 to 0 is 7 mm, that to 4 is 6 mm, though 0 is nearer as the crow flies.
    nodes = [[0, 0, 0], [3, 0, 0], [3, 3, 0], [2, 3, 0], [2, 9, 0], [4, 9, 0]]
    whole = mended(nodes, polyline(6), [5, 0, np.nan, -1, 2, np.inf])
    assert whole.radii.tolist() == [5, 5, 5, 2, 2, 2]
    assert whole.repairs == Repairs(radii_replaced=4)


def test_a_radius_goes_through_nodes_that_were_welded() -> None:
    nodes = [[0, 0, 0], [3, 0, 0], [3, 0, 0], [3, 4, 0]]
    whole = mended(nodes, [[0, 1], [2, 3]], [0, 0, 0.5, 0])
    assert whole.radii.tolist() == [0.5, 0.5, 0.5]
    assert whole.repairs == Repairs(radii_replaced=2, nodes_welded=1)


def test_each_component_needs_a_radius() -> None:
    nodes = [[0, 0, 0], [3, 0, 0], [0, 5, 0], [3, 5, 0]]
    for radii, lost in [
        ([1, 0, 0, np.nan], "2 at [0, 5, 0] mm"),
        ([1e-9] * 4, "0 at [0, 0, 0] mm"),
    ]:
        message = f"node {lost} and all that is joined to it have no radius above 5e-09 mm, the"
        with pytest.raises(SkeletonError, match=re.escape(message)):
            mended(nodes, [[0, 1], [2, 3]], radii)


def test_radii_of_edges_that_are_none_follow_the_nodes_and_are_counted() -> None:
    sizes = np.array([[1, -1], [np.nan, np.nan], [0, np.inf]])
    nodes = [[0, 0, 0], [3, 0, 0], [0, 5, 0], [0, 0, 5]]
    whole = mended(nodes, [[0, 1], [0, 2], [0, 3]], 2.0, edge_radii=sizes)
    assert whole.edge_radii.tolist() == [[1, 2], [2, 2], [2, 2]]
    assert str(whole.repairs) == "2 edge radii replaced"


def test_a_node_that_goes_needs_no_radius() -> None:
    whole = mended([[0, 0, 0], [3, 0, 0], [9, 9, 9]], [[0, 1]], [1, 1, 0])
    assert whole.repairs == Repairs(isolated_nodes=1)


# Contacts


def test_an_edge_is_split_at_the_nodes_on_it_if_asked() -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [7, 0, 0], [7, 5, 0], [2, 1e-9, 0], [2, -5, 0], [12, 0, 0]]
    edges = [[0, 1], [3, 2], [4, 5], [5, 6]]
    assert mended(nodes, edges).repairs == Repairs()
    whole = mended(nodes, edges, split_contacts=True)
    assert whole.edges.tolist() == [[0, 4], [4, 2], [2, 1], [3, 2], [4, 5], [5, 6]]
    assert whole.repairs == Repairs(contacts_split=2)


def test_a_node_beside_an_edge_is_no_contact() -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [5, 0.1, 0], [5, 5, 0], [-1, 0, 0], [-1, 5, 0]]
    edges = [[0, 1], [2, 3], [4, 5]]
    assert mended(nodes, edges, split_contacts=True).repairs == Repairs()
    assert mended(nodes, edges, split_contacts=True, weld_distance=0.2).repairs.contacts_split == 1


def test_parts_of_a_split_edge_that_were_there_are_repeats() -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [4, 0, 0]]
    whole = mended(nodes, [[0, 1], [0, 2]], split_contacts=True)
    assert whole.edges.tolist() == [[0, 2], [2, 1]]
    assert whole.repairs == Repairs(contacts_split=1, duplicate_edges=1)


def test_blocks_of_contacts_give_what_one_block_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(7)
    nodes = rng.integers(0, 5, (40, 3)) * [1, 1, 0]
    edges = rng.integers(0, 40, (60, 2))
    whole = mended(nodes, edges, split_contacts=True)
    assert whole.repairs.contacts_split > 10
    monkeypatch.setattr(splitting, "CONTACT_BYTES", MEMORY // 5)
    parts = mended(nodes, edges, split_contacts=True)
    np.testing.assert_array_equal(parts.edges, whole.edges)
    assert parts.repairs == whole.repairs


# Overlaps


def test_an_edge_along_a_shorter_one_goes_on_from_its_end() -> None:
    nodes = [[0, 0, 0], [10, 0, 0], [4, 0, 0], [0, 5, 0]]
    whole = mended(nodes, [[1, 0], [0, 2], [0, 3]])
    assert whole.edges.tolist() == [[1, 2], [0, 2], [0, 3]]
    assert whole.repairs == Repairs(overlapping_edges=1)


def test_a_path_that_turns_back_becomes_straight() -> None:
    whole = mended([[0, 0, 0], [10, 0, 0], [4, 0, 0]], [[0, 1], [1, 2]])
    assert sorted(map(sorted, whole.edges.tolist())) == [[0, 2], [1, 2]]
    assert whole.repairs == Repairs(overlapping_edges=1)


def test_a_path_that_turns_back_to_where_it_came_from_ends_there() -> None:
    whole = mended([[0, 0, 0], [10, 0, 0], [0, 0, 0]], [[0, 1], [1, 2]])
    assert whole.edges.tolist() == [[0, 1]]
    assert whole.repairs == Repairs(nodes_welded=1, duplicate_edges=1)


def test_two_edges_of_one_length_and_direction_become_a_short_and_a_long_one() -> None:
    whole = mended([[0, 0, 0], [10, 0, 0], [10, 1e-3, 0]], [[0, 1], [0, 2]])
    assert len(whole.edges) == 2
    assert whole.repairs == Repairs(overlapping_edges=1)
    check_skeleton(Skeleton(whole.nodes, whole.edges, whole.radii))


@given(
    st.permutations(range(9)), st.sets(st.tuples(st.integers(0, 8), st.integers(0, 8)), min_size=1)
)
def test_edges_along_a_line_become_pieces_without_overlap(
    places: list[int], pairs: set[tuple[int, int]]
) -> None:
    pairs = {(a, b) for a, b in pairs if a < b} or {(0, 1)}
    nodes = [[10.0 * place, 0, 0] for place in places]
    whole = mended(nodes, sorted(pairs))
    ends = np.sort(whole.nodes[whole.edges][:, :, 0], axis=1)
    covered = {x for a, b in ends.tolist() for x in range(int(a), int(b), 10)}
    before = set()
    for a, b in pairs:
        low, high = sorted((places[a], places[b]))
        before |= set(range(10 * low, 10 * high, 10))
    assert covered <= before
    leaving = overlapping_half_edges(whole.nodes, whole.edges)
    assert len(leaving) == 0


@pytest.mark.parametrize("valency", [2, 3, 4, 7, 63, 64, 65, 90])
def test_close_directions_are_found_at_nodes_of_any_valency(valency: int) -> None:
    rng = np.random.default_rng(valency)
    tips = rng.normal(size=(valency, 3))
    tips[-1] = 2.5 * tips[0] + 1e-5
    nodes = np.concatenate([[[0.0, 0, 0]], tips])
    edges = np.stack([np.zeros(valency, dtype=np.intp), np.arange(1, valency + 1)], axis=1)
    assert overlapping_half_edges(nodes, edges).tolist() == [[0, 2 * (valency - 1)]]
    assert overlapping_half_edges(nodes[:-1], edges[:-1]).tolist() == []


@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_named_skeletons_have_no_overlap(skeleton: Skeleton) -> None:
    assert overlapping_half_edges(skeleton.nodes, skeleton.edges).shape == (0, 2)


# The report


def test_the_report_says_what_was_done() -> None:
    repairs = Repairs(nodes_welded=3, duplicate_edges=1)
    assert str(repairs) == "3 nodes welded, 1 duplicate edge"
    assert repairs.total == 4
    assert str(Repairs()) == "nothing"
