"""New skeletons made of one: sums, turns, mirror images, pieces, cuts; radii of struts are kept."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.regions import BoxRegion
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.lattice import tile
from scaffold_cad.skeleton import Skeleton, check_skeleton
from tests.skeletons import TETRAPOD

PATH = Skeleton(
    [[0, 0, 0], [10, 0, 0], [10, 8, 0]], [[0, 1], [1, 2]], [1.0, 2.0, 1.5], [[0.5, 0.7], [0.6, 0.4]]
)
"""Two struts of radii of their own."""


def distances(skeleton: Skeleton) -> Floats:
    nodes = skeleton.nodes
    gaps: Floats = np.linalg.norm(nodes[:, None] - nodes, axis=2)
    return gaps


@given(st.integers(0, 2**32 - 1))
def test_turning_mirroring_and_moving_keep_distances_edges_and_radii(seed: int) -> None:
    random = np.random.default_rng(seed)
    axis, place = random.normal(size=(2, 3))
    for changed in (
        PATH.turned(random.uniform(-4, 4), axis, place),
        PATH.mirrored(axis, place),
        PATH.moved_by(place),
        PATH.oriented(axis),
    ):
        np.testing.assert_allclose(distances(changed), distances(PATH), atol=1e-12)
        for name in ("edges", "radii", "edge_radii"):
            np.testing.assert_array_equal(getattr(changed, name), getattr(PATH, name))


def test_a_quarter_turn_around_z_brings_x_to_y() -> None:
    turned = PATH.turned(np.pi / 2, about=(10, 0, 0))
    np.testing.assert_allclose(turned.nodes, [[10, -10, 0], [10, 0, 0], [2, 0, 0]], atol=1e-12)


def test_mirroring_twice_and_turning_back_give_the_same() -> None:
    back = PATH.mirrored([1, 2, 3], [4, 5, 6]).mirrored([1, 2, 3], [4, 5, 6])
    np.testing.assert_allclose(back.nodes, PATH.nodes, atol=1e-12)
    back = PATH.turned(0.3, [1, 0, 2], [3, 3, 3]).turned(-0.3, [1, 0, 2], [3, 3, 3])
    np.testing.assert_allclose(back.nodes, PATH.nodes, atol=1e-12)


@pytest.mark.parametrize("up", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (1, -2, 0.5)])
def test_an_oriented_skeleton_stands_on_the_plate_the_right_way_up(
    up: tuple[float, float, float],
) -> None:
    standing = TETRAPOD.oriented(up)
    assert (standing.nodes[:, 2] - standing.radii).min() == pytest.approx(0)
    heights = TETRAPOD.nodes @ np.array(up) / np.linalg.norm(up)
    np.testing.assert_allclose(np.ptp(standing.nodes[:, 2] - heights), 0, atol=1e-12)
    handed = np.linalg.det(np.diff(TETRAPOD.nodes[:4], axis=0))
    assert np.linalg.det(np.diff(standing.nodes[:4], axis=0)) == pytest.approx(handed)


def test_a_sum_welds_nodes_and_shares_struts() -> None:
    one = tile("sc", 5.0, 2, radius=0.5)
    both = one + one.moved_by([10, 0, 0])
    expected = tile("sc", 5.0, (4, 2, 2), radius=0.5)
    assert len(both.nodes) == len(expected.nodes)
    assert len(both.edges) == len(expected.edges)
    check_skeleton(both)
    row = sum(one.moved_by([10 * k, 0, 0]) for k in range(4))
    assert isinstance(row, Skeleton)
    assert len(row.edges) == len(tile("sc", 5.0, (8, 2, 2), radius=0.5).edges)
    assert len(one.edges) == len(tile("sc", 5.0, 2, radius=0.5).edges)  # as it was


def test_a_sum_keeps_the_radii_of_struts_and_the_larger_of_shared_nodes() -> None:
    both = PATH + PATH.moved_by([10, 8, 0])
    assert sorted(both.edge_radii.round(9).tolist()) == sorted(2 * PATH.edge_radii.tolist())
    shared = np.flatnonzero((both.nodes == [10, 8, 0]).all(axis=1))
    assert both.radii[shared].tolist() == [1.5]
    with pytest.raises(TypeError):
        PATH + 3  # type: ignore[operator]


def test_edges_are_cut_in_equal_pieces_with_radii_between() -> None:
    pieces = PATH.subdivided(4)
    assert len(pieces.edges) == 8
    np.testing.assert_allclose(np.sort(pieces.lengths), [2] * 4 + [2.5] * 4)
    first = pieces.edge_radii[:4]
    np.testing.assert_allclose(first, np.c_[0.5 + 0.05 * np.arange(4), 0.55 + 0.05 * np.arange(4)])
    np.testing.assert_array_equal(pieces.nodes[:3], PATH.nodes)
    np.testing.assert_allclose(pieces.radii[3:6], [0.55, 0.6, 0.65])
    assert PATH.subdivided(1).edges.tolist() == PATH.edges.tolist()
    by_length = PATH.subdivided(longest=5.0)
    assert len(by_length.edges) == 4
    check_skeleton(by_length)


@given(st.floats(-20, 20), st.integers(0, 2**32 - 1))
def test_a_cut_leaves_what_is_inside(height: float, seed: int) -> None:
    random = np.random.default_rng(seed)
    lattice = tile("bcc", 10.0, 2, radius=0.5).moved_by([-10, -10, -10])
    lattice = lattice.turned(1.0, random.normal(size=3))
    normal = random.normal(size=3)
    normal /= np.linalg.norm(normal)

    def plane(points: Points) -> Floats:
        gaps: Floats = points @ normal - height
        return gaps

    ends = plane(lattice.nodes)[lattice.edges]
    below = np.clip(ends.min(axis=1) / (ends.min(axis=1) - ends.max(axis=1)), 0, 1)
    share = np.where(ends.max(axis=1) <= 0, 1.0, np.where(ends.min(axis=1) >= 0, 0.0, below))
    expected = float((share * lattice.lengths).sum())
    if expected < 1e-3:
        return
    cut = lattice.cut(plane, shortest=0.0)
    assert plane(cut.nodes).max() < 1e-6
    assert cut.lengths.sum() == pytest.approx(expected, rel=1e-6)


def test_radii_at_a_cut_are_those_of_the_strut_there() -> None:
    cut = PATH.cut(lambda points: points[:, 0] - 5.0)
    np.testing.assert_allclose(cut.nodes, [[0, 0, 0], [5, 0, 0]])
    np.testing.assert_allclose(cut.edge_radii, [[0.5, 0.6]])
    np.testing.assert_allclose(cut.radii, [1.0, 0.6])


def test_regions_and_objects_with_a_distance_cut_too() -> None:
    class Ball:
        def signed_distance(self, points: Points) -> Floats:
            return np.asarray(np.linalg.norm(points, axis=1) - 5.0)

    assert PATH.cut(Ball()).lengths.tolist() == pytest.approx([5.0])
    in_box = PATH.cut([[-1, -1, -1], [20, 4, 1]])
    assert in_box.lengths.sum() == pytest.approx(14)
    whole = PATH.cut(BoxRegion([[-1, -1, -1], [20, 4.5, 1]]), keep="whole")
    assert whole.lengths.sum() == pytest.approx(18)
    one = PATH.cut(BoxRegion([[-1, -1, -1], [20, 3.5, 1]]), keep="whole")
    assert one.edges.tolist() == [[0, 1]]
    assert one.edge_radii.tolist() == [[0.5, 0.7]]


def test_short_rests_become_a_node_on_the_surface() -> None:
    cut = PATH.cut(lambda points: points[:, 1] - 1e-3)
    assert len(cut.edges) == 1
    np.testing.assert_allclose(cut.nodes[1], [10, 1e-3, 0])
    assert cut.radii[1] == 2.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda: PATH.moved_by([1, 2]), "offset is .*; need three finite numbers"),
        (lambda: PATH.turned(np.nan), "angle is nan; need a finite number"),
        (lambda: PATH.turned(1.0, axis=[0, 0, 0]), "axis is .*; need a direction"),
        (lambda: PATH.mirrored([0, 0, 0]), "normal is .*; need a direction"),
        (lambda: PATH.oriented([0, 0, np.inf]), "up is .*; need a direction, three finite"),
        (lambda: PATH.subdivided(), "either a count of pieces or their longest length"),
        (lambda: PATH.subdivided(0), "count of pieces is 0"),
        (lambda: PATH.subdivided(longest=0.0), "longest length is 0 mm"),
        (lambda: PATH.cut([[0, 0], [1, 1]]), r"box has shape \(2, 2\); need \(2, 3\)"),
        (lambda: PATH.cut({}), "the region is a dict; need a box, or a function"),  # type: ignore[arg-type]
        (lambda: PATH.cut(lambda p: p[:, 0], keep="half"), "keep is 'half'"),  # type: ignore[arg-type]
        (lambda: PATH.cut(lambda p: p[:, 0] + 5), r"no edge of the skeleton from \[.*\] mm is in"),
    ],
)
def test_what_cannot_be_is_refused_by_name(change: object, message: str) -> None:
    with pytest.raises((OptionError, SkeletonError), match=message):
        change()  # type: ignore[operator]
