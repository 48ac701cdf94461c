"""Graphs of other fields: TGF, GXL, molecules, spatial frames."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import CJSON, GXL, NEW_FRAME, OLD_FRAME, TGF, XYZ
from tests.io.test_reading import written


def test_tgf_labels_are_coordinates_and_radius(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "path.tgf", TGF))
    assert raw.nodes.tolist() == [[0, 0, 0], [10, 0, 0], [10, 10, 0]]
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.radii is not None
    assert raw.radii.tolist() == [1, 1.5, 2]


def test_tgf_without_radii(tmp_path: Path) -> None:
    assert read_raw(written(tmp_path, "bare.tgf", "1 0 0 0\n2 1 0 0\n#\n1 2\n")).radii is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 0 0 0\n2 1 0 0\n1 2\n", "has no line '#' between nodes and edges"),
        ("1 0 0\n#\n", r"line 1: '1 0 0'; need a node: name, x, y, z"),
        ("1 a b c\n#\n", r"line 1: '1 a b c'; need a node"),
        ("1 0 0 0\n1 1 0 0\n#\n", "line 2: node 1 is there already"),
        ("1 0 0 0\n#\n1 2\n", "line 3: '1 2'; need an edge: two names of nodes"),
        ("1 0 0 0\n#\n1\n", "line 3: '1'; need an edge"),
    ],
)
def test_tgf_errors_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.tgf", text))


@pytest.mark.parametrize("name", ["vessels.gxl", "tree_structure.xml"])
def test_gxl_edges_have_radii(tmp_path: Path, name: str) -> None:
    second = b'<node id="n3"><attr name="position"><tup><int>5</int><int>5</int><int>5</int></tup>'
    second += b'</attr></node><edge from="n2" to="n3"><attr name="radius"><float>2</float></attr>'
    text = GXL.replace(b"</graph>", second + b"</edge></graph>")
    raw = read_raw(written(tmp_path, name, text))
    assert raw.nodes.tolist() == [[0, 0, 0], [10, 0, 1], [5, 5, 5]]
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.edge_radii is not None
    assert raw.edge_radii.tolist() == [[1.5, 1.5], [2, 2]]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b'to="n2"', b'to="n9"', "has an edge to 'n9'; need the name of a node"),
        (b'to="n2"', b"", "has a <edge> without 'to'"),
        (b'id="n2"', b'id="n1"', "has two nodes 'n1'"),
        (b"<float>10</float>", b"", "as position of node 'n2'; need 3 numbers"),
        (b"<float>1.5</float>", b"<float>thick</float>", "as radius of edge 'n1' to 'n2'"),
        (b" position", b" place", "has no position of node 'n1'"),
        (b"</gxl>", b"", "need well-formed XML"),
    ],
)
def test_gxl_errors_name_what_is_wrong(
    tmp_path: Path, old: bytes, new: bytes, message: str
) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.gxl", GXL.replace(old, new, 1)))


def test_molecules_are_atoms_and_bonds(tmp_path: Path) -> None:
    water = read_raw(written(tmp_path, "water.xyz", XYZ))
    assert water.nodes.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert water.edges.tolist() == [[0, 1], [0, 2]]
    bent = read_raw(written(tmp_path, "bent.cjson", CJSON))
    assert bent.nodes.tolist() == [[0, 0, 0], [1.5, 0, 0], [1.5, 1.5, 0]]
    assert bent.edges.tolist() == [[0, 1], [1, 2]]


def test_a_periodic_box_is_left_out(tmp_path: Path) -> None:
    boxed = XYZ.replace(b"water\n", b"water\n30 30 30 90 90 90\n")
    assert len(read_raw(written(tmp_path, "water.txyz", boxed)).edges) == 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("2\nplain\nO 0 0 0\nH 1 0 0\n", "is plain XYZ, 2 atoms without bonds; need a format with"),
        ("2\nO 0 0 0\nH 1 0 0\n", "is plain XYZ, 2 atoms without bonds; need a format with"),
        ("1\n1 O 0 0 0 1 7\n", "line 2: atom 7; need 1 to 1"),
        ("many\n", "line 1: 'many' is not a whole number; need the number of atoms"),
    ],
)
def test_xyz_errors_name_the_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.xyz", text))


def test_an_older_frame_has_one_section(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "frame.json", OLD_FRAME))
    assert raw.nodes.tolist() == [[0, 0, 0], [100, 0, 0], [100, 100, 0], [100, 100, 50]]
    assert raw.edges.tolist() == [[0, 1], [1, 2], [2, 3]]
    assert raw.edge_radii == pytest.approx(np.full((3, 2), math.sqrt(3 / math.pi)))


def test_a_newer_frame_has_sections_by_tag(tmp_path: Path) -> None:
    document = json.loads(NEW_FRAME)
    document["elements"][2]["elem_tag"] = "thick"
    document["cross_secs"].append({"elem_tags": ["thick"], "radius": 0.5})
    raw = read_raw(written(tmp_path, "frame.json", json.dumps(document)))
    thin = math.sqrt(3 / math.pi)
    assert raw.nodes[3].tolist() == [10_000, 10_000, 5000]
    assert raw.edge_radii == pytest.approx(np.array([[thin] * 2, [thin] * 2, [500] * 2]))


def test_a_frame_without_sections_has_no_radii(tmp_path: Path) -> None:
    document = json.loads(NEW_FRAME)
    del document["cross_secs"]
    assert read_raw(written(tmp_path, "frame.json", json.dumps(document))).has_radii is False


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"unit": "furlong"}, "has the unit 'furlong'; need one of millimeter"),
        ({"nodes": [{"point": [1]}]}, 'has no "point" of 2 or 3 numbers in node 0'),
        ({"nodes": [{"point": [1, "x", 2]}]}, "has 'x' as a coordinate of node 0"),
        ({"elements": [{"end_node_inds": [0]}]}, r"joins \[0\] by element 0; need two"),
        ({"elements": [{"end_node_inds": [0, 4]}]}, r"joins nodes \[0, 4\]; need 0 to 3"),
        ({"elements": [{}]}, 'has no list "end_node_inds" in element 0'),
        ({"elements": {}}, 'has no list "elements"'),
        ({"cross_secs": [{"elem_tags": [], "A": 1, "A_unit": "acre"}]}, "has the unit 'acre'"),
        ({"cross_secs": [7]}, "has a section that is no object"),
    ],
)
def test_frame_errors_name_what_is_wrong(
    tmp_path: Path, change: dict[str, Any], message: str
) -> None:
    text = json.dumps(json.loads(NEW_FRAME) | change)
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.json", text))
