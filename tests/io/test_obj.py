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

SQUARE = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\n"

RHINO = """\
# Rhino

v 0 0 0
p 1
cstype bspline
deg 1
v 0 0 0
v 10 0 0
v 10 10 0
curv 0 20 2 \\
3 4
parm u 0 0 10 \\
20 20
end
"""


def edges_of(tmp_path: Path, text: str) -> list[list[int]]:
    edges: list[list[int]] = read_raw(written(tmp_path, "lines.obj", text)).edges.tolist()
    return edges


@pytest.mark.parametrize(
    "elements",
    [
        "l 1 2\nl 2 3\n",
        "l 1 2 3\n",
        "l 1/1 2/2 3/3\n",
        "l 1// 2 3/\n",
        "l -4 -3 -2\n",
        "g group\ns off\nusemtl none\nl 1 2 3 # a comment\n",
        "l 1 2\\\n 3\n",
        "l 1 2 \\\n3\n",
    ],
)
def test_line_elements_become_edges(tmp_path: Path, elements: str) -> None:
    assert edges_of(tmp_path, SQUARE + elements) == [[0, 1], [1, 2]]


def test_negative_indices_count_back_from_their_own_line(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nl -1 -2\nv 2 0 0\nl -1 -2\n"
    assert edges_of(tmp_path, text) == [[1, 0], [2, 1]]


def test_lines_may_come_before_their_vertices(tmp_path: Path) -> None:
    assert edges_of(tmp_path, "l 1 2 3\n" + SQUARE) == [[0, 1], [1, 2]]


def test_vertices_may_have_weights_or_colors(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "w.obj", "v 0 0 1 1.0\nv 1e1 -.5 2 0.1 0.2 0.3\nl 1 2\n"))
    assert raw.nodes.tolist() == [[0, 0, 1], [10, -0.5, 2]]
    assert raw.radii is None


def test_vertices_that_no_line_uses_are_left_out(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "mixed.obj", SQUARE + "f 1 2 3\nl 2 4\n"))
    assert raw.nodes.tolist() == [[10, 0, 0], [0, 10, 0]]
    assert raw.edges.tolist() == [[0, 1]]


def test_curves_of_degree_one_become_edges(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "rhino.obj", RHINO))
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0]]


def test_the_suffix_of_pymesh_is_known(tmp_path: Path) -> None:
    assert len(read_skeleton(written(tmp_path, "cell.wire", SQUARE + "l 1 2\n"), 1.0).edges) == 1


@given(skeletons())
def test_writing_and_reading_gives_the_same_skeleton(
    tmp_path_factory: pytest.TempPathFactory, skeleton: Skeleton
) -> None:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in skeleton.nodes.tolist()]
    lines += [f"l {a + 1} {b + 1}" for a, b in skeleton.edges.tolist()]
    path = written(tmp_path_factory.mktemp("obj"), "skeleton.obj", "\n".join(lines))
    read = read_skeleton(path, 2.0, strict=True)
    np.testing.assert_array_equal(read.nodes, skeleton.nodes)
    np.testing.assert_array_equal(read.edges, skeleton.edges)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 1 2\nl 1 1\n", r"bad\.obj, line 1: 'v 1 2' is too short; need a vertex: v x y z"),
        ("v 1 2 z\nl 1 1\n", r"bad\.obj, line 1: 'z' is not a number; need a vertex: v x y z"),
        (SQUARE + "l 1\n", "line 5: 'l 1' is too short; need a line element: l i j"),
        (SQUARE + "l 1 x\n", "line 5: '1 x'; need numbers of vertices"),
        (SQUARE + "l 1 2.0\n", r"line 5: '1 2\.0'; need numbers of vertices"),
        (SQUARE + "l 1 2 \\\n", "need numbers of vertices"),
        (SQUARE + "l 0 1\n", "line 5: vertex 0; need 1 or more: OBJ counts from 1, and this file"),
        (SQUARE + "l 1 5\n", "line 5: vertex 5; need 1 to 4, or -1 to -4"),
        (SQUARE + "l 1 -5\n", "line 5: vertex -5; need 1 to 4, or -1 to -4"),
        (SQUARE + f"l 1 1{'0' * 40}\n", "line 5: vertex 10+; need 1 to 4"),
        (SQUARE + f"l 1 1{'0' * 5000}\n", r"line 5: '1 10+\.\.\.; need numbers of vertices"),
        (SQUARE + "deg 3\ncurv 0 1 1 2 3 4\n", "line 6: a curve of degree 3; need degree 1"),
        (SQUARE + "curv 0 1 1 2\n", "line 5: a curve of degree unknown; need degree 1"),
        (SQUARE + "deg 1\ncurv 0 1 1\n", "line 6: 'curv 0 1 1' is too short; need a curve: curv"),
        (SQUARE + "f 1 2 3\n", r"bad\.obj has only faces; need line elements \('l' or 'curv'\)"),
        (SQUARE, r"bad\.obj has no elements; need line elements \('l' or 'curv'\)"),
    ],
)
def test_errors_name_the_line_and_the_value(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_skeleton(written(tmp_path, "bad.obj", text), 1.0)
