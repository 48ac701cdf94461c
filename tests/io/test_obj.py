from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton, read_triangles
from scaffold_cad.mesh import TriangleMesh
from scaffold_cad.printability import check_printability
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


BOX_VERTICES = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
BOX_FACES = ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6")


def triangles_of(tmp_path: Path, text: str) -> TriangleMesh:
    mesh = read_triangles(written(tmp_path, "mesh.obj", text))
    assert mesh is not None
    return mesh


@pytest.mark.parametrize(
    "line",
    ["{0}", "g part{1}\n{0}", "usemtl m{1}\n{0}", "o box{1}\n{0}", "s {1}\n{0}"],
    ids=["plain", "groups", "materials", "objects", "smoothing"],
)
def test_faces_share_vertices_across_groups_and_materials(tmp_path: Path, line: str) -> None:
    faces = "\n".join(line.format(f"f {face}", k) for k, face in enumerate(BOX_FACES))
    box = triangles_of(tmp_path, BOX_VERTICES + faces)
    assert (len(box.vertices), len(box.triangles)) == (8, 12)
    assert box.signed_volume == pytest.approx(1.0)
    assert check_printability(box, "sls")["watertight"].verdict == "ok"


def test_corners_count_back_have_textures_and_go_on_in_the_next_line(tmp_path: Path) -> None:
    plain = triangles_of(tmp_path, BOX_VERTICES + "".join(f"f {face}\n" for face in BOX_FACES))
    split = [face.split() for face in BOX_FACES]
    others = [
        [f"f {' '.join(str(int(k) - 9) for k in face)}" for face in split],
        [f"f {' '.join(f'{k}/{n + 1}' for n, k in enumerate(face))}" for face in split],
        [f"  f\t{'  '.join(f'{k}//1' for k in face)} # a side\r" for face in split],
        [f"f {' '.join(face[:2])} \\\n{' '.join(face[2:])}" for face in split],
    ]
    for faces in others:
        again = triangles_of(tmp_path, "\ufeff" + BOX_VERTICES + "\n".join(faces))
        assert again.triangles.tolist() == plain.triangles.tolist()


def test_polygons_of_any_size_are_fans(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 1.5 1 0\nv .5 2 0\nv -.5 1 0\nf 1 2 3 4 5\nf 1 2 3\n"
    triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2]]
    assert triangles_of(tmp_path, text).triangles.tolist() == triangles


@pytest.mark.parametrize(
    ("face", "message"),
    [
        ("f 0 1 2", "line 9: vertex 0; need 1 or more: OBJ counts from 1"),
        ("f 1 2 99", "line 9: vertex 99; need 1 to 8"),
        ("f a b c", "line 9: 'a b c'; need numbers of vertices"),
        ("f 1 2", "line 9: 'f 1 2' is too short; need a face: f i j k"),
        ("v 1 2\nf 1 2 3", "line 9: 'v 1 2' is too short; need a vertex: v x y z"),
    ],
)
def test_faulty_faces_are_named(tmp_path: Path, face: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        triangles_of(tmp_path, BOX_VERTICES + face)
