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


@pytest.mark.parametrize("suffix", [".polylines.txt", ".cgal"])
def test_polylines_join_where_they_have_equal_points(tmp_path: Path, suffix: str) -> None:
    text = "3 0 0 0 5 0 0 5 5 0\n1 7 7 7\n2 5 5 0 9.5 5 1\n2 -0.0 0 0 0 0 5\n"
    raw = read_raw(written(tmp_path, "lines" + suffix, text))
    assert raw.nodes.tolist() == [
        [0, 0, 0],
        [5, 0, 0],
        [5, 5, 0],
        [7, 7, 7],
        [9.5, 5, 1],
        [0, 0, 5],
    ]
    assert raw.edges.tolist() == [[0, 1], [1, 2], [2, 4], [0, 5]]


def test_a_closed_polyline_becomes_a_ring(tmp_path: Path) -> None:
    path = written(tmp_path, "ring.cgal", "4 0 0 0 5 0 0 5 5 0 0 0 0\n")
    skeleton = read_skeleton(path, 0.5, strict=True)
    assert (skeleton.loop_count, len(skeleton.nodes)) == (1, 3)


@given(skeletons())
def test_writing_and_reading_gives_the_same_edges(
    tmp_path_factory: pytest.TempPathFactory, skeleton: Skeleton
) -> None:
    ends = skeleton.nodes[skeleton.edges].reshape(-1, 6)
    text = "\n".join("2 " + " ".join(map(repr, row)) for row in ends.tolist())
    path = written(tmp_path_factory.mktemp("cgal"), "skeleton.cgal", text)
    read = read_skeleton(path, 1.0, strict=True)
    np.testing.assert_array_equal(read.nodes[read.edges].reshape(-1, 6), ends)
    assert len(read.nodes) == len(skeleton.nodes)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("2 0 0 0 1 1", r"bad\.cgal, line 2: N is 2 with 5 numbers; need a polyline: N x y z"),
        ("0", "line 2: N is 0 with 0 numbers; need a polyline"),
        ("-1", "line 2: N is -1 with 0 numbers; need a polyline"),
        ("99999999999999999999 0 0 0", "line 2: N is 9+ with 3 numbers; need a polyline"),
        ("2 0 0 0 1 1 a", "line 2: 'a' is not a number; need a polyline"),
        ("1_0 0 0 0 1 1 1", "line 2: '1_0' is not a whole number; need a polyline"),
        ("two 0 0 0 1 1 1", "line 2: 'two' is not a whole number; need a polyline"),
    ],
)
def test_errors_name_the_line_and_the_value(tmp_path: Path, line: str, message: str) -> None:
    path = written(tmp_path, "bad.cgal", f"2 0 0 0 1 1 1\n{line}\n")
    with pytest.raises(FormatError, match=message):
        read_raw(path)
