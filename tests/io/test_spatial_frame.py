from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import NEW_FRAME, OLD_FRAME
from tests.io.test_reading import written


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
        ({"nodes": [{"point": [1, "x", 2]}]}, 'has "x" as a coordinate of node 0'),
        ({"elements": [{"end_node_inds": [0]}]}, r"joins \[0\] by element 0; need two"),
        ({"elements": [{"end_node_inds": [0, 4]}]}, r"joins nodes \[0, 4\]; need 0 to 3"),
        ({"elements": [{}]}, 'has no list "end_node_inds" in element 0'),
        ({"elements": {}}, 'has no list "elements"'),
        ({"cross_secs": [{"elem_tags": [], "A": 1, "A_unit": "acre"}]}, "has the unit 'acre'"),
        ({"cross_secs": [7]}, "has a section that is not an object"),
    ],
)
def test_frame_errors_name_what_is_wrong(
    tmp_path: Path, change: dict[str, Any], message: str
) -> None:
    text = json.dumps(json.loads(NEW_FRAME) | change)
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.json", text))
