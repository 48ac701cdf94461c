from __future__ import annotations

from pathlib import Path

import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import GXL
from tests.io.test_reading import written


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
