"""Runs: edges that change nothing at a joint are one strut, and all else ends a run."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import to_solid
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.runs import balls_of, straight_runs
from tests.skeletons import CUBE, ELBOW, RING, TRIPOD, polyline
from tests.validation.struts import union_volume


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


def test_a_cell_body_of_steep_cones_is_a_ball() -> None:
    tips = np.array([[7, 0, 0], [-3, 6, 0], [-3, -6, 1.0], [0, 1, 8]])
    nodes = np.concatenate([np.zeros((1, 3)), tips])
    body = Skeleton(nodes, [[0, tip] for tip in range(1, 5)], [5, 0.3, 0.3, 0.3, 0.3])
    assert balls_of(body, straight_runs(body)).tolist() == [5, 0, 0, 0, 0]
    volume, _ = union_volume(body, np.random.default_rng(2))
    solid = to_solid(round_struts(body), sides=24)
    assert 0.985 < solid.volume() / volume < 1.05  # triangles are inside of round surfaces
    slender = Skeleton(nodes, body.edges, [0.5, 0.3, 0.3, 0.3, 0.3])
    assert not balls_of(slender, straight_runs(slender)).any()
