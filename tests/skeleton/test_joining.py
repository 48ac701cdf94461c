from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad import Skeleton
from scaffold_cad.cli import main
from scaffold_cad.errors import OptionError
from scaffold_cad.io import read_skeleton, read_triangles
from scaffold_cad.skeleton import check_skeleton

CROSS = Skeleton([[-5, 0, 0], [5, 0, 0], [0, -5, 0], [0, 5, 0]], [[0, 1], [2, 3]], 1.0)
TEE = Skeleton([[-5, 0, 0], [5, 0, 0], [0, 0, 0.005], [0, 5, 0]], [[0, 1], [2, 3]], 1.0)


@pytest.mark.parametrize(("skeleton", "edges"), [(CROSS, 4), (TEE, 3)])
def test_a_node_is_made_where_struts_cross_or_end_on_others(skeleton, edges: int) -> None:
    joined = skeleton.joined(0.01)
    assert len(joined.edges) == edges
    assert joined.component_count == 1
    assert joined.valency.max() == edges
    assert joined.lengths.sum() == pytest.approx(skeleton.lengths.sum(), abs=0.01)
    check_skeleton(joined)


def test_struts_farther_apart_than_the_tolerance_stay_apart() -> None:
    lifted = np.array([[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 1]])
    apart = Skeleton(CROSS.nodes + lifted, CROSS.edges, 1.0)
    assert apart.joined(0.9).component_count == 2
    joined = apart.joined(1.1)
    assert joined.component_count == 1
    assert joined.nodes[joined.branch_points].tolist() == [[0, 0, 0.5]]


def test_radii_change_evenly_along_the_struts_that_were_split() -> None:
    skeleton = Skeleton(CROSS.nodes, CROSS.edges, edge_radii=[[1.0, 2.0], [0.5, 0.5]])
    joined = skeleton.joined(0.01)
    (middle,) = joined.branch_points
    for (a, b), (near, far) in zip(joined.edges.tolist(), joined.edge_radii.tolist(), strict=True):
        wide = joined.nodes[[a, b], 0].any()
        assert (near if a == middle else far) == pytest.approx(1.5 if wide else 0.5)


def test_a_grid_of_lines_becomes_a_net() -> None:
    n = 6
    lines = [[[k, -1, 0], [k, n, 0]] for k in range(n)] + [
        [[-1, k, 0], [n, k, 0]] for k in range(n)
    ]
    nodes = np.reshape(np.asarray(lines, dtype=np.float64), (-1, 3))
    joined = Skeleton(nodes, np.arange(4 * n).reshape(-1, 2), 0.1).joined(1e-6)
    assert len(joined.branch_points) == n * n
    assert len(joined.edges) == 2 * n * (n + 1)
    assert joined.loop_count == (n - 1) ** 2


@given(st.integers(0, 2**32 - 1), st.integers(2, 12))
@settings(max_examples=30)
def test_random_lines_of_a_plane_meet_in_all_their_crossings(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    ends = np.concatenate([rng.uniform(-10, 10, (2 * count, 2)), np.zeros((2 * count, 1))], axis=1)
    skeleton = Skeleton(ends, np.arange(2 * count).reshape(-1, 2), 0.01)
    joined = skeleton.joined(1e-7)
    a, b = ends[0::2, :2], ends[1::2, :2]

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    wanted = sum(
        side(a[i], b[i], a[j]) * side(a[i], b[i], b[j]) < 0
        and side(a[j], b[j], a[i]) * side(a[j], b[j], b[i]) < 0
        for i in range(count)
        for j in range(i)
    )
    assert len(joined.nodes) == 2 * count + wanted
    assert len(joined.edges) == count + 2 * wanted
    assert joined.lengths.sum() == pytest.approx(skeleton.lengths.sum())


def test_a_tolerance_must_be_positive() -> None:
    with pytest.raises(OptionError, match="tolerance is 0 mm; need > 0"):
        CROSS.joined(0)


@pytest.mark.parametrize(("name", "edges"), [("dxf_T.dxf", 3), ("dxf_X.dxf", 4)])
def test_reported_drawings_become_one_solid(
    shared_data: Path, tmp_path: Path, name: str, edges: int
) -> None:
    path = shared_data / "reported" / name
    if not path.is_file():
        pytest.skip(f"no {name} beside the repository")
    assert read_skeleton(path, 1.0).component_count == 2
    joined = read_skeleton(path, 1.0).joined(0.01)
    assert (len(joined.edges), joined.component_count) == (edges, 1)
    out = tmp_path / "out.step"
    options = ["--radius", "1", "--collars", "--join", "0.01", "-o", str(out)]
    assert main(["build", str(path), *options]) == 0
    mesh = read_triangles(out)
    assert mesh is not None
    assert mesh.signed_volume > 100
