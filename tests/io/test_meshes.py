"""Meshes by their edges: STL, PLY and OFF."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton
from tests.fuzz.samples import OFF, PLY_EDGES, SAMPLES
from tests.io.test_reading import written

MESHES = ("tetrahedron.off", "text.stl", "binary.stl", "faces.ply")

CUBE_OFF = """OFF 8 6 12
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1
0 1 1
4 0 3 2 1
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
"""


@pytest.mark.parametrize("name", MESHES)
def test_all_formats_give_the_six_edges_of_a_tetrahedron(tmp_path: Path, name: str) -> None:
    raw = read_raw(written(tmp_path, name, SAMPLES[name]))
    found = {frozenset(map(tuple, raw.nodes[edge].tolist())) for edge in raw.edges}
    corners = [(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)]
    assert found == {frozenset((a, b)) for a in corners for b in corners if a != b}


@pytest.mark.parametrize("suffix", ["stl", "ply", "off"])
def test_diagonals_of_flat_faces_are_left_out(tmp_path: Path, suffix: str) -> None:
    box = trimesh.creation.box((10, 20, 30))
    box.apply_transform(trimesh.transformations.rotation_matrix(0.7, (1, 2, 3)))
    path = tmp_path / f"box.{suffix}"
    box.export(path)
    skeleton = read_skeleton(path, 1.0)
    assert (len(skeleton.nodes), len(skeleton.edges)) == (8, 12)
    assert sorted(set(np.round(skeleton.lengths, 3))) == [10, 20, 30]


def test_a_curved_surface_keeps_all_edges(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    path = tmp_path / "ball.stl"
    ball.export(path)
    assert len(read_skeleton(path, 0.01).edges) == len(ball.edges_unique)


def test_polygons_keep_their_sides(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "cube.off", CUBE_OFF))
    assert (len(raw.nodes), len(raw.edges)) == (8, 12)
    flat = "OFF\n6 2 0\n0 0 0\n1 0 0\n2 0 0\n2 1 0\n1 1 0\n0 1 0\n4 0 1 4 5\n4 1 2 3 4\n"
    assert len(read_raw(written(tmp_path, "flat.off", flat)).edges) == 7


def test_edges_of_a_folded_sheet_stay(tmp_path: Path) -> None:
    sheet = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n"
    assert len(read_raw(written(tmp_path, "sheet.off", sheet)).edges) == 3


def test_ply_edges_come_before_faces_and_may_have_radii(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "edges.ply", PLY_EDGES))
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.radii is None
    thick = PLY_EDGES.replace(b"float z\n", b"float z\nproperty float radius\n")
    thick = thick.replace(b"0 0 0\n10 0 0\n10 10 0\n", b"0 0 0 1\n10 0 0 2\n10 10 0 3\n")
    raw = read_raw(written(tmp_path, "thick.ply", thick))
    assert raw.radii is not None
    assert raw.radii.tolist() == [1, 2, 3]


def test_faces_of_any_number_of_corners_in_binary_ply(tmp_path: Path) -> None:
    head = (
        b"ply\nformat binary_big_endian 1.0\nelement vertex 5\nproperty float x\n"
        b"property float y\nproperty float z\nelement face 2\n"
        b"property list uchar ushort vertex_index\nend_header\n"
    )
    points = np.array([[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0], [5, 5, 5]], dtype=">f4")
    faces = b"\4" + np.arange(4, dtype=">u2").tobytes()
    faces += b"\3" + np.array([0, 1, 4], dtype=">u2").tobytes()
    raw = read_raw(written(tmp_path, "mixed.ply", head + points.tobytes() + faces))
    assert len(raw.edges) == 6


def test_binary_ply_edges_of_either_order(tmp_path: Path) -> None:
    for order, name in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        head = PLY_EDGES[: PLY_EDGES.index(b"end_header") + 11].replace(b"ascii", name.encode())
        points = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0]], dtype=order + "f4")
        edges = np.array([[0, 1], [1, 2]], dtype=order + "i4")
        path = written(tmp_path, "binary.ply", head + points.tobytes() + edges.tobytes())
        raw = read_raw(path)
        assert raw.nodes.tolist() == points.tolist()
        assert raw.edges.tolist() == edges.tolist()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.off", OFF.replace(b"3 0 2 1", b"3 0 2"), "line 7: '3 0 2'; need a face"),
        ("a.off", OFF.replace(b"3 0 2 1", b"2 0 2"), "line 7: '2 0 2'; need a face"),
        ("a.off", OFF.replace(b"3 0 2 1", b"3 0 2 4"), "line 7: index 4; need 0 to 3"),
        ("a.off", OFF.replace(b"OFF", b"FOO"), "does not begin with OFF"),
        ("a.off", b"OFF\n", "line 1: ''; need the numbers of vertices"),
        ("a.stl", SAMPLES["text.stl"].replace(b"endsolid", b"end"), "does not end with 'endsolid'"),
        ("a.stl", SAMPLES["text.stl"].replace(b"vertex", b"point", 1), "has 11 vertices of 4"),
        (
            "a.stl",
            SAMPLES["text.stl"].replace(b"10.0", b"ten", 1),
            "line 5: 'vertex 0.0 ten 0.0'; need a vertex",
        ),
        ("a.stl", b"short", r"has 5 bytes; need an STL file"),
        ("a.ply", PLY_EDGES.replace(b"end_header", b"end"), "has no PLY header"),
        ("a.ply", PLY_EDGES.replace(b"ascii", b"ebcdic"), "has no format that is known"),
        ("a.ply", PLY_EDGES.replace(b"int vertex1", b"bool vertex1"), "in its header"),
        ("a.ply", PLY_EDGES.replace(b"vertex1", b"start"), "has no element 'edge' with vertex1"),
        ("a.ply", PLY_EDGES.replace(b"1 2\n", b"1 b\n"), "has 'b' as a number; need numbers"),
        ("a.ply", PLY_EDGES.replace(b"1 2\n", b"1\n"), "ends within 2 elements 'edge'"),
        ("a.ply", PLY_EDGES.replace(b"1 2\n", b"1 5\n"), r"joins nodes \[1, 5\]; need 0 to 2"),
        ("a.ply", PLY_EDGES.replace(b"float y", b"float x"), "need another type"),
        (
            "a.ply",
            PLY_EDGES.replace(b"int vertex2", b"list float int v"),
            "need another type",
        ),
        ("a.ply", PLY_EDGES.replace(b"edge 2", b"point 2"), "has no element 'face'"),
    ],
)
def test_errors_name_what_is_wrong(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, name, content))


def test_a_list_longer_than_the_file_is_refused(tmp_path: Path) -> None:
    sound = SAMPLES["faces.ply"].replace(b"list uchar int", b"list int int")
    at = sound.index(b"end_header\n") + 11 + 4 * 12
    content = sound[:at] + (2**30).to_bytes(4, "little") + sound[at:]
    with pytest.raises(FormatError, match="ends within 4 elements 'face'"):
        read_raw(written(tmp_path, "long.ply", content))


def test_nan_of_any_kind_is_a_node_without_a_place(tmp_path: Path) -> None:
    sound = SAMPLES["binary.stl"]
    signaling = b"\x01\0\xa0\x7f"  # of the kind that processors warn of
    content = sound[:96] + signaling + sound[100:]
    raw = read_raw(written(tmp_path, "damaged.stl", content))
    assert np.isnan(raw.nodes).any(axis=1).sum() == 1
