"""Skeletons that are written and read again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from scaffold_cad import write
from scaffold_cad.errors import FormatError
from scaffold_cad.io import read_skeleton
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from tests.skeletons import CUBE, NAMED, STICK_FIGURE, STRUT, TWO_STRUTS
from tests.strategies import skeletons


def struts(skeleton: Skeleton) -> set[frozenset[tuple[float, ...]]]:
    """Return the edges as pairs of (x, y, z, r), whatever the order of nodes and edges."""
    rows = [tuple(row) for row in np.column_stack([skeleton.nodes, skeleton.radii]).tolist()]
    return {frozenset((rows[a], rows[b])) for a, b in skeleton.edges.tolist()}


@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_json_gives_the_same_arrays(tmp_path: Path, skeleton: Skeleton) -> None:
    write(skeleton, tmp_path / "a.json")
    read = read_skeleton(tmp_path / "a.json", strict=True)
    for name in ("nodes", "edges", "radii"):
        np.testing.assert_array_equal(getattr(read, name), getattr(skeleton, name))


@pytest.mark.parametrize("skeleton", NAMED.values(), ids=NAMED)
def test_obj_lines_give_the_same_nodes_and_edges(tmp_path: Path, skeleton: Skeleton) -> None:
    write(skeleton, tmp_path / "a.obj")
    read = read_skeleton(tmp_path / "a.obj", 1.0, strict=True)
    np.testing.assert_array_equal(read.nodes, skeleton.nodes)
    np.testing.assert_array_equal(read.edges, skeleton.edges)


TREES = {name: skeleton for name, skeleton in NAMED.items() if skeleton.loop_count == 0}


@pytest.mark.parametrize("skeleton", TREES.values(), ids=TREES)
def test_swc_gives_the_same_struts(tmp_path: Path, skeleton: Skeleton) -> None:
    write(skeleton, tmp_path / "a.swc")
    assert struts(read_skeleton(tmp_path / "a.swc", strict=True)) == struts(skeleton)


@given(skeletons())
@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_skeleton_comes_back(tmp_path: Path, skeleton: Skeleton) -> None:
    if skeleton.loop_count == 0:
        write(skeleton, tmp_path / "a.swc")
        assert struts(read_skeleton(tmp_path / "a.swc", strict=True)) == struts(skeleton)
    write(skeleton, tmp_path / "a.json")
    assert struts(read_skeleton(tmp_path / "a.json", strict=True)) == struts(skeleton)


def test_samples_of_swc_come_after_their_parents(tmp_path: Path) -> None:
    flipped = Skeleton(STICK_FIGURE.nodes, STICK_FIGURE.edges[::-1, ::-1], STICK_FIGURE.radii)
    write(flipped, tmp_path / "a.swc")
    rows = np.loadtxt(tmp_path / "a.swc")
    assert rows[:, 0].tolist() == list(range(1, len(rows) + 1))
    assert (rows[:, 6] < rows[:, 0]).all()
    assert (rows[:, 6] == -1).sum() == 1


def test_each_component_is_a_tree_of_swc(tmp_path: Path) -> None:
    write(TWO_STRUTS, tmp_path / "a.swc")
    assert (np.loadtxt(tmp_path / "a.swc")[:, 6] == -1).sum() == 2


@pytest.mark.parametrize(
    ("what", "message"),
    [
        (CUBE, "SWC holds trees only; the skeleton has 5 loops"),
        (build_scaffold(STRUT).mesh, "an SWC file cannot hold a QuadMesh; need a Skeleton"),
    ],
)
def test_what_swc_cannot_hold_is_refused(
    tmp_path: Path, what: Skeleton | QuadMesh, message: str
) -> None:
    with pytest.raises(FormatError, match=message):
        write(what, tmp_path / "a.swc")
    assert not list(tmp_path.iterdir())


UNEVEN = Skeleton(
    [[0, 0, 0], [9, 0, 0], [0, 9, 0]], [[0, 1], [0, 2]], [3, 1, 1], edge_radii=[[1, 1], [2, 1]]
)


@pytest.mark.parametrize(
    ("suffix", "message"),
    [
        (".json", None),
        (".graphml", None),
        (".3mf", "holds the radii of members: 1 ball at nodes lost"),
        (".csv", "holds the radii of members: 1 ball at nodes lost"),
        (
            ".inp",
            (
                "holds a radius for each member, the mean of both ends: 1 taper and 1 ball at "
                "nodes lost"
            ),
        ),
        (".vtu", "holds a radius for each member, the mean of both ends: 1 taper lost"),
        (".swc", "holds a radius for each node, which makes 2 struts up to 3 times as thick"),
        (".obj", "holds no radii; need radius= to read it"),
    ],
)
def test_radii_that_a_format_does_not_hold_are_told(
    tmp_path: Path, suffix: str, message: str | None, caplog: pytest.LogCaptureFixture
) -> None:
    write(UNEVEN, tmp_path / f"a{suffix}")
    assert caplog.messages == ([] if message is None else [f"a{suffix} {message}"])
    radius = 1.0 if suffix == ".obj" else None
    read = read_skeleton(tmp_path / f"a{suffix}", radius)
    same = np.array_equal(read.radii, [3, 1, 1]) and (read.edge_radii == UNEVEN.edge_radii).all()
    assert same == (message is None)
