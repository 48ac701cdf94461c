"""OpenSees, TubeTK, Slicer, NML, COMPAS, plain points and edges, PySkelton: their quirks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.members import COMPAS, NML, OPENSEES, PYSKELTON, SLICER, TUBETK
from tests.io.test_members import sizes
from tests.io.test_reading import written


def test_a_closed_curve_of_slicer_is_a_ring_and_points_alone_are_left_out(tmp_path: Path) -> None:
    document = json.loads(SLICER)
    markup = document["markups"][0]
    document["markups"] = [{**markup, "type": "ClosedCurve"}, {**markup, "type": "Fiducial"}]
    raw = read_raw(written(tmp_path, "x.mrk.json", json.dumps(document)))
    assert raw.edges.tolist() == [[0, 1], [1, 2], [2, 0]]


def test_a_model_in_the_plane_is_read(tmp_path: Path) -> None:
    text = "model basic -ndm 2 -ndf 3\nnode 1 0 0\nnode 2 9 4\nelement dispBeamColumn 1 1 2 5 1 1\n"
    raw = read_raw(written(tmp_path, "x.tcl", text))
    assert raw.nodes.tolist() == [[0, 0, 0], [9, 4, 0]]
    assert raw.has_radii is False


@pytest.mark.parametrize(
    ("key", "values", "radii"),
    [
        ("radius", 2.0, [2, 2, 2]),
        ("radii", [1, 2, 3], [1, 2, 3]),
        ("edge_radii", [1, 2], [1, 2, 2]),
        ("edge_radii", [[1, 2], [3, 4]], [1, 3, 4]),
        ("diameters", [2, 4], [1, 2, 2]),
        ("areas", [np.pi, 4 * np.pi], [1, 2, 2]),
    ],
)
def test_radii_of_plain_points_and_edges(
    tmp_path: Path, key: str, values: object, radii: list[float]
) -> None:
    document = {"vertices": [[0, 0], [9, 0], [9, 9]], "edges": [[0, 1], [1, 2]], key: values}
    raw = read_raw(written(tmp_path, "x.json", json.dumps(document)))
    np.testing.assert_allclose(sizes(raw), radii)


POINTS = {"points": [[0, 0, 0], [9, 0, 0]], "edges": [[0, 1]]}


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("x.tcl", "node 1 0 0 [expr 2+2]\n", "line 1: .*; need node, its number, and x, y, z as"),
        ("x.tcl", OPENSEES + b"element truss 7 1\n", "line 13: .*; need element, its kind"),
        ("x.tcl", OPENSEES + b"element truss 7 1 9 1 1\n", "line 13: an edge has the end '9'"),
        (
            "x.tre",
            TUBETK.replace(b"5 0 0 ", b"5 0 x "),
            "line 13: '5 0 x 0.75 0 0'; need a point: x",
        ),
        ("x.tre", TUBETK.replace(b"2 2 2", b"2 z 2"), "has '2 z 2' as ElementSpacing; need numb"),
        ("x.tre", b"ObjectType = Tube\nNDims = 3\nBinaryData = True\n", "is a binary file; need t"),
        ("x.mrk.json", SLICER.replace(b"Curve", b"Plane"), "has no curves; need markups of type"),
        ("x.nml", NML.replace(b'x="0"', b'x="q"'), "has 'q' as x of <node>; need a number"),
        ("x.nml", b"<things/>", "has no nodes; need things"),
        (
            "x.json",
            b'{"nodes": [[0, 0, 0], [null, 0, 0]], "edges": [[0, 1]]}',
            'has null as a number in row 1 of "nodes"; need a number',
        ),
        (
            "x.json",
            COMPAS.replace(b"node", b"vertex"),
            r"x\.json is a compas.datastructures/Graph; need a Network or a Graph",
        ),
        (
            "x.json",
            json.dumps({**POINTS, "edges": [[0, 0.5]]}),
            "edges that are not pairs of whole",
        ),
        ("x.json", json.dumps({**POINTS, "unit": "ell"}), "has the unit 'ell'; need mm, cm, m"),
        ("x.json", json.dumps({**POINTS, "radii": [1, 2, 3]}), r"has radii of shape \(3,\); need"),
        ("x.json", json.dumps({"points": [[0, 0, 0]]}), "has no list of edges; need one called"),
        (
            "x.json",
            json.dumps({**POINTS, "points": [[0, 0, 0], [9, 0]]}),
            r"has \[9.0, 0.0\] as point 1, and \[0.0, 0.0, 0.0\] as point 0; need as many",
        ),
        ("x.json", json.dumps({**POINTS, "edges": [[0, 1, 2]]}), 'as row 0 of "edges"; need'),
        ("x.graph", PYSKELTON.replace(b"\n0 1\n", b"\n0 7\n"), "line 7: '0 7'; need two numbers"),
        ("x.graph", PYSKELTON + b"3\n", "has 4 radii of 3 nodes; need a radius a node"),
    ],
)
def test_errors_name_the_item(tmp_path: Path, name: str, text: str | bytes, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, name, text))


def test_nodes_with_and_without_z_are_refused(tmp_path: Path) -> None:
    nodes = [{"id": "a", "x": 0, "y": 0, "z": 5}, {"id": "b", "x": 9, "y": 0}]
    text = json.dumps({"nodes": nodes, "links": [{"source": "a", "target": "b"}]})
    with pytest.raises(FormatError, match="node 'b' has 2 coordinates, those before 3; need"):
        read_raw(written(tmp_path, "x.json", text))
