from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scaffold_cad.errors import MissingBackendError, OptionError, SkeletonError
from scaffold_cad.io import skeleton_from_networkx, skeleton_to_networkx
from scaffold_cad.skeleton import Skeleton
from tests.skeletons import CUBE, NAMED, STRUT

networkx = pytest.importorskip("networkx")


@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_a_skeleton_comes_back(skeleton: Skeleton) -> None:
    graph = skeleton_to_networkx(skeleton)
    back = skeleton_from_networkx(graph)
    np.testing.assert_array_equal(back.nodes, skeleton.nodes)
    np.testing.assert_array_equal(back.radii, skeleton.radii)
    assert {frozenset(e) for e in back.edges.tolist()} == {
        frozenset(e) for e in skeleton.edges.tolist()
    }
    assert networkx.number_connected_components(graph) == skeleton.component_count


def test_edges_have_their_lengths() -> None:
    assert skeleton_to_networkx(STRUT).edges[0, 1]["length"] == 10


def test_attributes_may_have_other_names() -> None:
    graph = skeleton_to_networkx(CUBE, position="xyz", radii="thickness")
    assert len(skeleton_from_networkx(graph, position="xyz", radii="thickness").edges) == 12


def test_names_directions_and_parallel_edges_do_no_harm() -> None:
    graph: Any = networkx.MultiDiGraph()
    graph.add_node("a", pos=(0, 0))
    graph.add_node(("b", 1), pos=[1, 0, 0.5])
    graph.add_edges_from([("a", ("b", 1)), (("b", 1), "a"), ("a", ("b", 1))])
    skeleton = skeleton_from_networkx(graph, 0.25)
    assert skeleton.nodes.tolist() == [[0, 0, 0], [1, 0, 0.5]]
    assert skeleton.edges.tolist() == [[0, 1]]
    assert skeleton.radii.tolist() == [0.25, 0.25]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"radius": 1}, "node 'a' has None as 'pos'; need"),
        ({"pos": 3, "radius": 1}, "node 'a' has 3 as 'pos'"),
        ({"pos": (1, 2, 3, 4), "radius": 1}, r"node 'a' has \(1, 2, 3, 4\) as 'pos'"),
        ({"pos": (0, 0, 0)}, "node 'a' has no 'radius'; need one, or radius= for all"),
        (
            {"pos": (0, 0, 0), "radius": -1},
            r"node 0 at \[0, 0, 0\] mm has radius -1 mm; need > 0",
        ),
        ({"pos": (0, 0, 0), "radius": "thick"}, "radii is not an array of numbers"),
    ],
)
def test_what_a_graph_lacks_is_named(data: dict[str, Any], message: str) -> None:
    graph = networkx.Graph()
    graph.add_node("a", **data)
    with pytest.raises(SkeletonError, match=message):
        skeleton_from_networkx(graph)


def test_one_name_for_two_attributes_is_refused() -> None:
    with pytest.raises(OptionError, match="position and radii are both 'x'"):
        skeleton_to_networkx(STRUT, position="x", radii="x")


def test_networkx_must_be_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scaffold_cad.base.backends.find_spec", lambda name: None)
    with pytest.raises(MissingBackendError, match="a networkx graph needs networkx"):
        skeleton_to_networkx(STRUT)


def test_what_is_no_graph_and_no_name_is_refused() -> None:
    with pytest.raises(OptionError, match=r"got a list; need a networkx Graph"):
        skeleton_from_networkx([(0, 1)], 1.0)
    with pytest.raises(OptionError, match=r"position is \{0: .*; need the name of an attribute"):
        skeleton_from_networkx(networkx.path_graph(2), 1.0, position={0: (0, 0, 0)})
