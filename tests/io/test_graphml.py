"""GraphML, GML and node-link JSON, with networkx as the judge."""

from __future__ import annotations

import json
from pathlib import Path

import networkx
import numpy as np
import pytest

from scaffold_cad import write
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton
from scaffold_cad.lattice import tile
from tests.io.test_members import sizes
from tests.io.test_reading import written


def test_a_skeleton_reads_back_exactly_and_networkx_reads_the_same(tmp_path: Path) -> None:
    lattice = tile("bcc", 10.0, 2, radius=lambda points: 0.3 + points[:, 2] / 30)
    path = tmp_path / "bcc.graphml"
    write(lattice, path)
    again = read_skeleton(path, strict=True)
    for name in ("nodes", "edges", "radii", "edge_radii"):
        np.testing.assert_array_equal(getattr(lattice, name), getattr(again, name))
    graph = networkx.read_graphml(path)
    places = [[data[axis] for axis in "xyz"] for _, data in graph.nodes(data=True)]
    np.testing.assert_array_equal(places, lattice.nodes)
    theirs = {frozenset((int(a), int(b))) for a, b in graph.edges}
    assert theirs == {frozenset(pair) for pair in lattice.edges.tolist()}


def path_graph() -> networkx.Graph:
    graph = networkx.Graph()
    for k, place in enumerate([(0, 0, 0), (10, 0, 0), (10, 10, 1.5)]):
        graph.add_node(f"n{k}", pos=list(place), radius=1.0 + k)
    graph.add_edges_from([("n0", "n1"), ("n1", "n2")])
    return graph


def test_what_networkx_writes_is_read(tmp_path: Path) -> None:
    graph = path_graph()
    networkx.write_gml(graph, tmp_path / "x.gml")
    (tmp_path / "x.json").write_text(json.dumps(networkx.node_link_data(graph, edges="links")))
    (tmp_path / "y.json").write_text(json.dumps(networkx.node_link_data(graph, edges="edges")))
    for _, data in graph.nodes(data=True):
        data["pos"] = str(tuple(data["pos"]))
    networkx.write_graphml(graph, tmp_path / "x.graphml")
    for name in ("x.gml", "x.json", "y.json", "x.graphml"):
        raw = read_raw(tmp_path / name)
        assert raw.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 1.5]]
        assert raw.edges.tolist() == [[0, 1], [1, 2]]
        assert sizes(raw).tolist() == [1, 2, 3]


GRAPHML = (
    '<graphml><key id="x" attr.name="x"/><key id="y" attr.name="y"/><graph>{}</graph></graphml>'
)
NODE = '<node id="a"><data key="x">0</data><data key="y">{}</data></node>'


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("x.graphml", GRAPHML.format(NODE.format("z")), "no position of node 'a'; need x, y and z"),
        ("x.graphml", GRAPHML.format(2 * NODE.format("1")), "node 'a' is there already"),
        (
            "x.graphml",
            GRAPHML.format(NODE.format("1") + '<edge source="a" target="b"/>'),
            "an edge has the end 'b'; need a node of the file",
        ),
        ("x.gml", "graph [ node [ id 1 x 0 y 0 ] ] ]", "line 1: ']'; need a key and its value"),
        ("x.gml", "graph [ node [ id 1 x 0 y 0 ]", "ends within a list; need the whole file"),
        ("x.gml", "graph [ node [ id 1 ] ]", "has no position of node '1'"),
        ("x.gml", "graph [ node [ id 1 graphics yes ] ]", "has no position of node '1'"),
        (
            "x.gml",
            "graph [ node [ id 1 graphics [ x 1 ] graphics [ y 1 ] ] ]",
            "no position of node",
        ),
        ("x.gml", "graph 3", r"has no graph \[ ... \]; need one"),
        ("x.gml", "graph [ " + 40 * "a [ ", "lists nested 32 deep; need fewer"),
        ("x.json", '{"nodes": [{"id": 1}], "links": []}', "no position of node 0; need x, y and"),
        ("x.json", '{"nodes": [{"id": 1}, 2], "edges": [3]}', "no position of node 0"),
        ("x.json", '{"nodes": [{"id": 1, "x": 0, "y": 0}]}', 'has no list "edges"; need one'),
        (
            "x.json",
            '{"nodes": [{"id": 1, "x": 0, "y": 0}], "links": [3]}',
            "has '3' as edge 0; need an object",
        ),
    ],
)
def test_errors_name_the_item(tmp_path: Path, name: str, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, name, text))


@pytest.mark.parametrize("owner", [' for="edge"', ' for="all"', ""])
def test_values_that_data_leaves_out_are_those_of_the_key(tmp_path: Path, owner: str) -> None:
    radius = f'<key id="r" attr.name="radius"{owner}><default>0.5</default></key>'
    nodes = (
        NODE.format(0) + NODE.format(9).replace('"a"', '"b"') + NODE.format(5).replace('"a"', '"c"')
    )
    edges = '<edge source="a" target="b"/><edge source="a" target="c"><data key="r">2</data></edge>'
    text = GRAPHML.format(nodes + edges).replace("<graph>", radius + "<graph>")
    raw = read_raw(written(tmp_path, "x.graphml", text))
    assert raw.edge_radii.tolist() == [[0.5, 0.5], [2, 2]]
