from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_raw
from tests.fuzz.samples import GLTF, SAMPLES
from tests.io.test_reading import written


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
        ({"nodes": [{}, {"scale": [1, None, 1]}, {}, {}]}, "has null as scale of node 1"),
    ],
)
def test_gltf_errors_name_what_is_wrong(
    tmp_path: Path, change: dict[str, object], message: str
) -> None:
    with pytest.raises(FormatError, match=message):
        read_raw(written(tmp_path, "bad.gltf", json.dumps(json.loads(GLTF) | change)))
