from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton
from scaffold_cad.skeleton import Skeleton
from tests.io.test_reading import written
from tests.strategies import skeletons

NEURON = """\
# a soma of three samples, an axon and a tree apart
1 1 0 0 0 5 -1
2 1 0 5 0 5 1
3 1 0 -5 0 5 1
 4 2 10. 0 0 1.5 1

5 2 20 0 0 1 4   # tip
9 3 50 0 0 1 -1 an eighth word
7 3 60 0 1e1 1 9
"""


def swc_text(skeleton: Skeleton) -> str:
    """Return the spanning forest of a skeleton as SWC text."""
    parents = {}
    open_nodes: list[int] = []
    heads = skeleton.edges.reshape(-1)
    for root in range(len(skeleton.nodes)):
        if root in parents:
            continue
        parents[root] = -1
        open_nodes = [root]
        while open_nodes:
            node = open_nodes.pop()
            row = skeleton.incidence
            for half_edge in row.half_edges[row.offsets[node] : row.offsets[node + 1]].tolist():
                head = int(heads[half_edge ^ 1])
                if head not in parents:
                    parents[head] = node
                    open_nodes.append(head)
    lines = []
    for node in range(len(skeleton.nodes)):
        x, y, z = skeleton.nodes[node].tolist()
        parent = parents[node] + 1 if parents[node] >= 0 else -1
        lines.append(f"{node + 1} 0 {x!r} {y!r} {z!r} {skeleton.radii[node]!s} {parent}")
    return "\n".join(lines)


def test_samples_become_nodes_and_parents_edges(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "neuron.swc", NEURON))
    assert raw.nodes.tolist() == [
        [0, 0, 0],
        [0, 5, 0],
        [0, -5, 0],
        [10, 0, 0],
        [20, 0, 0],
        [50, 0, 0],
        [60, 0, 10],
    ]
    assert raw.edges.tolist() == [[0, 1], [0, 2], [0, 3], [3, 4], [5, 6]]
    assert raw.radii is not None
    assert raw.radii.tolist() == [5, 5, 5, 1.5, 1, 1, 1]


def test_several_trees_become_several_components(tmp_path: Path) -> None:
    assert read_skeleton(written(tmp_path, "neuron.swc", NEURON)).component_count == 2


def test_samples_may_come_in_any_order_and_with_any_numbers(tmp_path: Path) -> None:
    text = "70 3 2 0 0 1 30\n30 3 1 0 0 1 5000000001\n5000000001 1 0 0 0 1 -1\n"
    raw = read_raw(written(tmp_path, "shuffled.swc", text))
    assert raw.edges.tolist() == [[1, 0], [2, 1]]


def test_zero_length_edges_go_and_zero_radii_are_filled(tmp_path: Path) -> None:
    text = "1 1 0 0 0 2 -1\n2 3 0 0 0 1 1\n3 3 0 5 0 0 2\n4 3 4 5 0 0 3\n"
    skeleton = read_skeleton(written(tmp_path, "zero.swc", text))
    assert skeleton.nodes.tolist() == [[0, 0, 0], [0, 5, 0], [4, 5, 0]]
    assert skeleton.radii.tolist() == [2, 2, 2]  # of those welded the largest, then the nearest


@given(skeletons())
def test_writing_and_reading_gives_the_same_forest(
    tmp_path_factory: pytest.TempPathFactory, skeleton: Skeleton
) -> None:
    path = written(tmp_path_factory.mktemp("swc"), "forest.swc", swc_text(skeleton))
    read = read_skeleton(path, strict=True)
    np.testing.assert_array_equal(read.nodes, skeleton.nodes)
    np.testing.assert_array_equal(read.radii, skeleton.radii)
    assert read.loop_count == 0
    assert read.component_of_node.tolist() == skeleton.component_of_node.tolist()
    edges = {frozenset(pair) for pair in skeleton.edges.tolist()}
    assert {frozenset(pair) for pair in read.edges.tolist()} <= edges


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("2 3 1 0 0 1", r"bad\.swc, line 3: '2 3 1 0 0 1' is too short; need a sample: number, ty"),
        ("2 3 one 0 0 1 1", "line 3: 'one' is not a number; need a sample: number, type, x, y, z"),
        ("2 3 1,5 0 0 1 1", "line 3: '1,5' is not a number"),
        ("2 3 1_5 0 0 1 1", "line 3: '1_5' is not a number"),
        ("2.5 3 1 0 0 1 1", r"line 3: 2\.5 is not the number of a sample; need a whole number"),
        ("nan 3 1 0 0 1 1", "line 3: nan is not the number of a sample"),
        ("2 3 1 0 0 1 inf", "line 3: inf is not the number of a sample"),
        ("1e300 3 1 0 0 1 1", "line 3: 1e[+]300 is not the number of a sample"),
        ("1 3 1 0 0 1 1", "line 3: sample 1 is there already; need each number once"),
        ("2 3 1 0 0 1 7654321", "line 3: no sample is the parent 7654321; need -1 or a sample's"),
        ("2 3 1 0 0 1 0", "line 3: no sample is the parent 0; need"),
    ],
)
def test_errors_name_the_line_and_the_value(tmp_path: Path, line: str, message: str) -> None:
    path = written(tmp_path, "bad.swc", f"# header\n1 1 0 0 0 1 -1\n{line}\n")
    with pytest.raises(FormatError, match=message):
        read_skeleton(path)


def test_an_error_shows_no_more_than_the_beginning_of_a_long_line(tmp_path: Path) -> None:
    path = written(tmp_path, "long.swc", "1 " + "x" * 5000)
    with pytest.raises(FormatError, match=r"line 1: 'x{60,80}\.\.\.; need") as caught:
        read_skeleton(path)
    assert len(str(caught.value)) < 300


def test_a_file_of_comments_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"only\.swc holds no line but comments; need a sample"):
        read_skeleton(written(tmp_path, "only.swc", "# 1 1 0 0 0 1 -1\n"))


def test_a_lone_sample_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="has 1 node but no edges"):
        read_skeleton(written(tmp_path, "lone.swc", "1 1 0 0 0 1 -1\n"))
