"""Skeletons of animation: BVH and glTF."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import BVH, GLTF, SAMPLES
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


def test_gltf_is_turned_to_z_up_in_mm(tmp_path: Path) -> None:
    raw = read_raw(written(tmp_path, "arm.gltf", GLTF))
    # By hand: node 1 at (0, 0, 1) m, turned by 90° about z; node 2 10 mm along its x, which is
    # y; node 3 5 mm along the same, doubled. y becomes z and z becomes -y.
    expected = [[0, -1000, 0], [0, -1000, 10], [0, -1000, 20]]
    np.testing.assert_allclose(raw.nodes, expected, atol=1e-9)
    assert raw.edges.tolist() == [[0, 1], [1, 2]]


def test_glb_holds_the_same_as_gltf(tmp_path: Path) -> None:
    one = read_raw(written(tmp_path, "arm.glb", SAMPLES["arm.glb"]))
    other = read_raw(written(tmp_path, "arm.gltf", GLTF))
    np.testing.assert_array_equal(one.nodes, other.nodes)
    np.testing.assert_array_equal(one.edges, other.edges)


def test_gltf_joins_a_joint_to_the_nearest_joint_above_it(tmp_path: Path) -> None:
    document = json.loads(GLTF)
    document["skins"] = [{"joints": [3, 1]}]
    raw = read_raw(written(tmp_path, "skip.gltf", json.dumps(document)))
    assert raw.edges.tolist() == [[0, 1]]
    assert len(raw.nodes) == 2


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"skins": []}, "has no skin; need one with joints"),
        ({"skins": [{"joints": [9]}]}, "has 9 as a joint of a skin; need 0 to 4"),
        ({"skins": [{"joints": ["1"]}]}, "has 1 as a joint of a skin"),
        ({"nodes": [{"children": [1]}, {"children": [0]}, {}, {}, {}]}, "below themselves"),
        ({"nodes": [{"children": [1, 1]}, {}, {}, {}]}, "has node 1 below two others"),
        ({"nodes": [{}, {"translation": [1]}, {}, {}]}, "has 1 numbers as translation of node 1"),
        ({"nodes": [{}, {}, {}, {}, 0.7071]}, "has '0.7071' as node 4; need an object"),
        ({"nodes": [{}, {"scale": [1, None, 1]}, {}, {}]}, "has 'None' as scale of node 1"),
    ],
)
def test_gltf_errors_name_what_is_wrong(
    tmp_path: Path, change: dict[str, object], message: str
) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.gltf", json.dumps(json.loads(GLTF) | change)))
