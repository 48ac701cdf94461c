from __future__ import annotations

from pathlib import Path

import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import BVH
from tests.io.test_reading import written


def test_bvh_adds_offsets_along_the_hierarchy(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "rest.bvh", BVH))
    assert raw.nodes.tolist() == [[0, 0, 0], [0, 10, 0], [0, 15, 1]]
    assert raw.edges.tolist() == [[0, 1], [1, 2]]
    assert raw.radii is None


def test_bvh_may_have_several_roots_braces_on_the_line_and_no_motion(tmp_path: Path) -> None:
    limb = "ROOT {0} {{\nOFFSET {0} 0 0\nJOINT a b {{\nOFFSET 1 0 0\n}}\n}}\n"
    raw = read_raw(written(tmp_path, "two.bvh", "HIERARCHY\n" + limb.format(0) + limb.format(5)))
    assert raw.nodes.tolist() == [[0, 0, 0], [1, 0, 0], [5, 0, 0], [6, 0, 0]]
    assert raw.edges.tolist() == [[0, 1], [2, 3]]


def test_bvh_may_be_nested_deeply(tmp_path: Path) -> None:
    depth = 5000
    joints = "".join("JOINT j\n{\nOFFSET 1 0 0\n" for _ in range(depth))
    text = f"HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\n{joints}" + "}\n" * (depth + 1)
    raw = read_raw(written(tmp_path, "deep.bvh", text))
    assert raw.nodes[-1].tolist() == [depth, 0, 0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("JOINT Chest", "ROOT Chest", "line 6: 'ROOT Chest'; need ROOT outside, JOINT inside"),
        ("    OFFSET 0 10 0\n", "", "line 8: the joint before it has no offset"),
        ("OFFSET 0 10 0", "OFFSET 0 10", "line 8: 'OFFSET 0 10' is too short"),
        ("OFFSET 0 10 0", "OFFSET 0 ten 0", "line 8: 'ten' is not a number"),
        ("}\nMOTION", "MOTION", "ends within its hierarchy"),
        ("}\nMOTION", "}\n}\nMOTION", "line 15: '}' closes nothing"),
        ("  CHANNELS", "  OFFSET 1 1 1\n  CHANNELS", "line 5: an offset of no joint"),
        ("CHANNELS", "ROTATIONS", "line 5: 'ROTATIONS'; need ROOT, JOINT"),
    ],
)
def test_bvh_errors_name_the_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.bvh", BVH.decode().replace(old, new, 1)))
