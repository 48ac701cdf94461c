from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw, read_skeleton, skeleton_to_json
from scaffold_cad.skeleton import Skeleton
from tests.io.test_reading import written
from tests.skeletons import TAPER
from tests.strategies import skeletons

STRUT_DOCUMENT: dict[str, Any] = {
    "format": "scaffold-cad skeleton",
    "version": 1,
    "units": "mm",
    "nodes": [[0, 0, 0], [10.5, 0, 0]],
    "edges": [[0, 1]],
    "radii": [1, 1.5],
}


def changed(**fields: Any) -> str:
    """Return the document with other fields; None removes one."""
    document = STRUT_DOCUMENT | fields
    return json.dumps({key: value for key, value in document.items() if value is not None})


@given(skeletons())
def test_writing_and_reading_gives_the_same_skeleton(
    tmp_path_factory: pytest.TempPathFactory, skeleton: Skeleton
) -> None:
    path = written(tmp_path_factory.mktemp("json"), "s.json", skeleton_to_json(skeleton))
    read = read_skeleton(path, strict=True)
    np.testing.assert_array_equal(read.nodes, skeleton.nodes)
    np.testing.assert_array_equal(read.edges, skeleton.edges)
    np.testing.assert_array_equal(read.radii, skeleton.radii)


def test_text_has_one_item_a_line() -> None:
    assert skeleton_to_json(TAPER) == (
        "{\n"
        '  "format": "scaffold-cad skeleton",\n'
        '  "version": 1,\n'
        '  "units": "mm",\n'
        '  "nodes": [\n    [0.0, 0.0, 0.0],\n    [0.0, 0.0, 10.0]\n  ],\n'
        '  "edges": [\n    [0, 1]\n  ],\n'
        '  "radii": [\n    1.0,\n    2.0\n  ]\n'
        "}\n"
    )


def test_a_skeleton_of_nothing_is_valid_json() -> None:
    empty = Skeleton(np.zeros((0, 3)), np.zeros((0, 2), dtype=int), np.zeros(0))
    assert json.loads(skeleton_to_json(empty))["nodes"] == []


def test_radii_may_be_left_out_and_further_keys_are_ignored(tmp_path: Path) -> None:
    path = written(tmp_path, "s.json", changed(radii=None, author="nobody"))
    assert read_raw(path).radii is None
    assert read_skeleton(path, 2.0).radii.tolist() == [2, 2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{\n\n oops", r"bad\.json, line 3: Expecting property name .*; need JSON"),
        ("[" * 100_000, r"bad\.json is nested too deeply; need lists of numbers"),
        ("[1, 2]", r"is JSON of another kind; need an object"),
        ('{"type": "FeatureCollection"}', "is JSON of another kind"),
        (changed(version=3), r'bad\.json has "version": 3; need 1 or 2'),
        (changed(version=None), r'bad\.json has no "version"; need 1 or 2'),
        (changed(units=None), r'bad\.json has no "units"; need "mm"'),
        (changed(units="inch"), r'bad\.json has "units": "inch"; need "mm"'),
        (changed(nodes=None), r'bad\.json has no list "nodes"; need one'),
        (changed(edges="none"), r'bad\.json has no list "edges"; need one'),
        (changed(nodes=[[0, 0], [1, 1]]), r"bad\.json: nodes has shape \(2, 2\); need \(n, 3\)"),
        (changed(nodes=[[0, 0, 0], [1]]), r"bad\.json: nodes is not an array of numbers"),
        (
            changed(nodes=[[0, 0, 0], ["a", 0, 0]]),
            r'has "a" as a number of nodes\[1\]; need a number',
        ),
        (changed(nodes=[[0, 0, 0], [1, None, 0]]), r"has null as a number of nodes\[1\]"),
        (changed(edges=[[0, True]]), r"has true as a number of edges\[0\]; need a number"),
        (changed(radii=[1, True]), r"has true as a number of radii\[1\]; need a number"),
        (changed(radii=True), "has true as radii; need a number"),
        (changed(edges=[[0, 2]]), r"bad\.json: edges\[0\] joins nodes \[0, 2\]; need 0 to 1"),
        (changed(edges=[[0, -1]]), r"edges\[0\] joins nodes \[0, -1\]; need 0 to 1"),
        (changed(edges=[[0, 0.5]]), "edges holds 0.5; need whole numbers"),
        (
            changed(edges=[[0, 10**30]]),
            f"edges holds {10**30}; need whole numbers below 9e",
        ),
        (changed(edges=[[0, 1, 0]]), r"edges has shape \(1, 3\); need \(n, 2\)"),
        (changed(edges=[[0], [0, 1]]), "edges is not an array of indices"),
        (changed(radii=[1]), r"bad\.json: radii have shape \(1,\); need \(2,\), one per node"),
        (changed(radii=["1", "x"]), r'has "1" as a number of radii\[0\]; need a number'),
        (changed().replace("10.5", "NaN"), r"bad\.json: NaN is not a JSON number"),
        (changed().replace("10.5", "1e999"), r"nodes\[1\] is \[inf, 0\.0, 0\.0\]; need finite"),
        (changed().replace("10.5", "9" * 5000), r"bad\.json: .*; need finite numbers"),
    ],
)
def test_errors_name_what_is_wrong(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.json", text))
