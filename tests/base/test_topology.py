from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from scaffold_cad.base.arrays import Edges
from scaffold_cad.base.topology import chains, component_labels, incidence, neighbors, valencies
from scaffold_cad.skeleton import Skeleton
from tests.meshes import CUBE
from tests.skeletons import (
    FIGURE_EIGHT,
    K4,
    LOLLIPOP,
    NAMED,
    RING,
    STICK_FIGURE,
    THETA,
    TWO_STRUTS,
    polyline,
)
from tests.strategies import graphs

NO_EDGES = np.zeros((0, 2), dtype=np.intp)


def walked(edges: Edges, count: int) -> list[list[int]]:
    """Return the nodes that each chain passes."""
    found = chains(edges, count)
    tails = edges.reshape(-1)
    return [
        [*tails[row].tolist(), int(tails[row[-1] ^ 1])]
        for row in np.split(found.half_edges, found.offsets[1:-1])
    ]


def flooded(edges: Edges, count: int) -> list[int]:
    """Return the component of each node, found by flooding, numbered by their first node."""
    neighbors: list[list[int]] = [[] for _ in range(count)]
    for a, b in edges.tolist():
        neighbors[a].append(b)
        neighbors[b].append(a)
    label = [-1] * count
    for first in range(count):
        if label[first] >= 0:
            continue
        label[first] = max(label) + 1
        wave = [first]
        while wave:
            for node in neighbors[wave.pop()]:
                if label[node] < 0:
                    label[node] = label[first]
                    wave.append(node)
    return label


@given(graphs())
def test_valency_counts_the_half_edges_that_leave(graph: tuple[int, Edges]) -> None:
    count, edges = graph
    leaving = incidence(edges, count)
    tails = edges.reshape(-1)
    assert np.diff(leaving.offsets).tolist() == valencies(edges, count).tolist()
    for node in range(count):
        row = leaving.half_edges[leaving.offsets[node] : leaving.offsets[node + 1]]
        assert row.tolist() == np.flatnonzero(tails == node).tolist()


@given(graphs())
def test_nodes_of_one_valency_give_rows_of_half_edges(graph: tuple[int, Edges]) -> None:
    count, edges = graph
    leaving = incidence(edges, count)
    valency = valencies(edges, count)
    for n in set(valency.tolist()):
        nodes = np.flatnonzero(valency == n)
        rows = leaving.at_nodes(nodes, n)
        assert rows.shape == (len(nodes), n)
        assert (edges.reshape(-1)[rows] == nodes[:, None]).all()


@given(graphs())
def test_components_are_those_that_flooding_finds(graph: tuple[int, Edges]) -> None:
    count, edges = graph
    assert component_labels(edges, count).tolist() == flooded(edges, count)


def test_isolated_nodes_are_components() -> None:
    assert component_labels(np.array([[3, 1]]), 5).tolist() == [0, 1, 2, 1, 3]
    assert component_labels(NO_EDGES, 2).tolist() == [0, 1]
    assert component_labels(NO_EDGES, 0).tolist() == []


def test_a_self_loop_counts_twice() -> None:
    assert valencies(np.array([[0, 0], [0, 1]]), 3).tolist() == [3, 1, 0]


@given(graphs())
def test_chains_pass_each_edge_once_and_turn_only_at_joints(graph: tuple[int, Edges]) -> None:
    count, edges = graph
    found = chains(edges, count)
    valency = valencies(edges, count)
    tails = edges.reshape(-1)
    assert sorted((found.half_edges >> 1).tolist()) == list(range(len(edges)))
    rows = np.split(found.half_edges, found.offsets[1:-1])
    assert len(rows) == len(found.closed) == len(found.offsets) - 1
    for row, closed in zip(rows, found.closed.tolist(), strict=True):
        inner = tails[row[1:]]
        assert (tails[row[:-1] ^ 1] == inner).all()
        assert (valency[inner] == 2).all()
        first, last = int(tails[row[0]]), int(tails[row[-1] ^ 1])
        if closed:
            assert first == last
            assert valency[first] == 2
            assert row[0] == min(*row, *(row ^ 1))
        else:
            assert valency[first] != 2
            assert valency[last] != 2
            assert valency[first] >= 3 or valency[last] < 3
    starts = found.half_edges[found.offsets[:-1]].tolist()
    assert starts == sorted(starts)


@pytest.mark.parametrize(
    ("skeleton", "expected"),
    [
        (NAMED["strut"], [[0, 1]]),
        (NAMED["zigzag"], [[0, 1, 2, 3, 4, 5]]),
        (TWO_STRUTS, [[0, 1], [2, 3]]),
        (RING, [[*range(12), 0]]),
        (LOLLIPOP, [[0, 1, 2, 3, 0], [0, 4]]),
        (FIGURE_EIGHT, [[0, 1, 2, 3, 0], [0, 4, 5, 6, 0]]),
        (THETA, [[0, 1], [0, 2, 1], [0, 3, 1]]),
        (K4, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]),
        (STICK_FIGURE, [[0, 1], [1, 2], [1, 3, 4], [1, 5, 6], [0, 7, 8], [0, 9, 10]]),
    ],
)
def test_chains_of_named_skeletons(skeleton: Skeleton, expected: list[list[int]]) -> None:
    assert walked(skeleton.edges, len(skeleton.nodes)) == expected


def test_a_chain_starts_at_its_branch_point() -> None:
    edges = np.array([[4, 3], [3, 0], [0, 1], [2, 0]])
    assert walked(edges, 5) == [[0, 3, 4], [0, 1], [0, 2]]


def test_a_graph_without_edges_has_no_chains() -> None:
    found = chains(NO_EDGES, 3)
    assert found.half_edges.tolist() == []
    assert found.closed.tolist() == []


def test_long_chains_and_rings_are_walked_whole() -> None:
    count = 5000
    order = np.random.default_rng(3).permutation(count)
    assert walked(order[polyline(count)], count) in ([order.tolist()], [order[::-1].tolist()])
    ring = walked(order[polyline(count, closed=True)], count)
    assert len(ring) == 1
    assert ring[0] == [*order.tolist(), order[0]]


def test_two_nodes_joined_twice_are_a_ring() -> None:
    found = chains(np.array([[0, 1], [0, 1]]), 2)
    assert found.closed.tolist() == [True]
    assert found.half_edges.tolist() == [0, 3]


def test_neighbors_share_the_side() -> None:
    triangles = CUBE.triangles
    across = neighbors(triangles, 8)
    for triangle, corners in enumerate(triangles.tolist()):
        for side in range(3):
            shared = {corners[side], corners[(side + 1) % 3]}
            assert shared <= set(triangles[across[triangle, side]].tolist())
