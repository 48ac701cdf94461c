from __future__ import annotations

from pathlib import Path

import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_with_repairs
from scaffold_cad.skeleton.repair import Repairs
from tests.io.test_reading import written


def test_removed_nodes_count_in_the_indices_and_are_dropped(tmp_path: Path) -> None:
    text = "n 0 0 0 \nn nan nan nan\nn -nan -nan -nan\nn 10 0 5e-1\nc 3 0\n"
    path = written(tmp_path, "removed.graph", text)
    assert read_raw(path).edges.tolist() == [[3, 0]]
    cleaning = read_with_repairs(path, 1.0)
    assert cleaning.repairs == Repairs(nodes_without_position=2)
    assert cleaning.skeleton.nodes.tolist() == [[0, 0, 0], [10, 0, 0.5]]
    assert cleaning.skeleton.edges.tolist() == [[1, 0]]


def test_edges_of_removed_nodes_are_dropped_and_counted(tmp_path: Path) -> None:
    path = written(tmp_path, "cut.graph", "n 0 0 0\nn 9 0 0\nn nan nan nan\nc 0 1\nc 1 2\n")
    repairs = read_with_repairs(path, 1.0).repairs
    assert repairs == Repairs(nodes_without_position=1, edges_without_position=1)


def test_edges_may_come_before_their_nodes(tmp_path: Path) -> None:
    path = written(tmp_path, "early.graph", "n 0 0 0\nc 0 1\nn 9 0 0\n")
    assert read_raw(path).edges.tolist() == [[0, 1]]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("n 1 2", r"bad\.graph, line 3: 'n 1 2' is too short; need a node: n x y z"),
        ("n 1 2 q", "line 3: 'q' is not a number; need a node: n x y z"),
        ("c 0", "line 3: 'c 0' is too short; need an edge: c i j"),
        ("c 0 1.5", r"line 3: '1\.5' is not a whole number; need an edge: c i j"),
        ("c 0 2", "line 3: index 2; need 0 to 1"),
        ("c -1 0", "line 3: index -1; need 0 to 1"),
        (f"c 0 {'9' * 30}", "line 3: index 9+; need 0 to 1"),
        ("e 0 1", "line 3: 'e'; need a node: n x y z, or an edge: c i j"),
    ],
)
def test_errors_name_the_line_and_the_value(tmp_path: Path, line: str, message: str) -> None:
    path = written(tmp_path, "bad.graph", f"n 0 0 0\nn 1 0 0\n{line}\n")
    with pytest.raises(FormatError, match=message):
        read_raw(path)
