"""Runs: edges that change nothing at a joint are one strut, and all else ends a run."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts.runs import straight_runs
from tests.skeletons import CUBE, ELBOW, RING, TRIPOD, polyline


def line(radii: object, bend: float = 0.0) -> Skeleton:
    """Return four nodes 10 mm apart along x, the third `bend` mm aside."""
    nodes = np.array([[0, 0, 0], [10, 0, 0], [20, bend, 0], [30, bend, 0]], dtype=float)
    return Skeleton(nodes, polyline(4), radii)


def test_a_straight_chain_of_one_radius_is_one_run() -> None:
    runs = straight_runs(line(1.0))
    assert np.sort(runs.edges, axis=1).tolist() == [[0, 3]]
    assert runs.run_of_edge.tolist() == [0, 0, 0]
    assert runs.lengths == pytest.approx([30.0])
    assert runs.valency.tolist() == [1, 0, 0, 1]


def test_a_straight_chain_of_one_taper_is_one_cone() -> None:
    runs = straight_runs(line([4.0, 3.0, 2.0, 1.0]))
    assert len(runs.edges) == 1
    assert np.sort(runs.radii[0]).tolist() == [1.0, 4.0]
    assert np.abs(runs.slopes) == pytest.approx([0.1, 0.1])
    assert runs.radii_at(np.array([0]), np.array([10.0])) == pytest.approx(
        runs.radii[0, 0] + 10 * runs.slopes[0]
    )


@pytest.mark.parametrize(
    "skeleton",
    [line([1.0, 1.0, 2.0, 2.0]), line(1.0, bend=1e-3), line([1.0, 2.0, 1.0, 1.0])],
    ids=["taper", "bend", "waist"],
)
def test_a_change_of_taper_or_direction_ends_a_run(skeleton: Skeleton) -> None:
    assert len(straight_runs(skeleton).edges) == 3


def test_a_step_of_radius_ends_a_run() -> None:
    skeleton = line(1.0).with_edge_radii([[1.0, 1.0], [2.0, 2.0], [2.0, 2.0]])
    assert len(straight_runs(skeleton).edges) == 2


def test_a_ball_at_a_joint_ends_a_run() -> None:
    skeleton = line(1.0).with_edge_radii(np.ones((3, 2)), radii=[1.0, 1.5, 1.0, 1.0])
    assert len(straight_runs(skeleton).edges) == 2


@pytest.mark.parametrize("skeleton", [ELBOW, TRIPOD, CUBE, RING])
def test_where_nothing_is_straight_runs_are_edges(skeleton: Skeleton) -> None:
    runs = straight_runs(skeleton)
    assert runs.edges.tolist() == skeleton.edges.tolist()
    np.testing.assert_array_equal(runs.radii, skeleton.edge_radii)


def test_half_runs_leave_their_nodes() -> None:
    runs = straight_runs(TRIPOD)
    heads = runs.edges[:, ::-1].reshape(-1)
    spans = TRIPOD.nodes[heads] - TRIPOD.nodes[runs.tails]
    lengths = np.linalg.norm(spans, axis=1, keepdims=True)
    np.testing.assert_allclose(runs.directions, spans / lengths, atol=1e-15)
