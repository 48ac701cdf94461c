from __future__ import annotations

from pathlib import Path

import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import TGF
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
