"""Which runs are proved to keep apart: never those that meet, and those with room between."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from scaffold_cad.base.segments import nearest_on_segments
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.apart import Slack, _apart, crossings
from scaffold_cad.struts.pieces import Pieces
from tests.crossings import check_as_written


def pair(gap: float, radii: object = 1.0) -> Skeleton:
    nodes = [[0, 0, 0], [20, 0, 0], [10, -8, gap], [10, 8, gap]]
    return Skeleton(nodes, [[0, 1], [2, 3]], radii)


@pytest.mark.parametrize(("gap", "meet"), [(1.99, True), (2.01, False), (0.0, True)])
def test_cylinders_meet_where_axes_are_nearer_than_their_radii(gap: float, meet: bool) -> None:
    struts = round_struts(pair(gap))
    assert struts.overlapping.tolist() == ([0, 1] if meet else [])
    assert struts.crowded_runs.tolist() == [meet, meet]


def test_nodes_of_struts_that_cross_between_them_are_not_crowded() -> None:
    bent = Skeleton(
        [[0, 0, 0], [20, 0, 0], [20, 20, 0], [10, -8, 0], [10, 8, 0]],
        [[0, 1], [1, 2], [3, 4]],
        1.0,
    )
    struts = round_struts(bent)
    assert struts.crowded_runs.tolist() == [True, False, True]
    assert not struts.crowded.any()
    assert struts.overlapping.tolist() == [0, 2]
    assert struts.exact.tolist() == [False, True, False]


def test_struts_at_crowded_nodes_are_no_thicker_than_they_are() -> None:
    # Two struts 1° apart have no collars within reach; one beside them is 3 radii away.
    turn = np.radians(1.0)
    nodes = [[0, 0, 0], [40, 0, 0], [40 * np.cos(turn), 40 * np.sin(turn), 0], [0, 0, -20]]
    fan = Skeleton([*nodes, [-9, 0, 5], [30, 0, 5]], [[0, 1], [0, 2], [0, 3], [4, 5]], 1.0)
    struts = round_struts(fan)
    assert struts.crowded[0]
    assert not struts.crowded[3:].any()
    assert struts.overlapping.tolist() == [0, 1, 2]


def test_hulls_meet_where_no_plane_parts_them() -> None:
    count, random = 300, np.random.default_rng(3)
    corners = random.normal(size=(2 * count, 4, 3))
    middles = np.repeat(corners.mean(axis=1)[:, None], 2, axis=1)  # where their capsules are
    corners[count:] += random.normal(size=(count, 1, 3))
    middles[count:] = corners[count:].mean(axis=1)[:, None]
    rows = np.arange(2 * count)
    none = np.full(2 * count, -1)
    pieces = Pieces(
        middles[:, 0],
        middles[:, 1],
        np.full(2 * count, 9.0),
        np.stack([rows, rows], axis=1),
        rows,
        rows,
        (corners,),
        np.zeros((2 * count, 3)),
        none,
        np.empty((0, 4, 3, 3)),
    )
    apart = _apart(pieces, rows[:count], rows[count:], np.zeros(2 * count))
    # Points of both hulls at one place: weights >= 0 that add up to 1.
    meet = [
        linprog(
            np.zeros(8),
            A_eq=np.block([[a.T, -b.T], [np.ones(4), np.zeros(4)], [np.zeros(4), np.ones(4)]]),
            b_eq=[0, 0, 0, 1, 1],
        ).success
        for a, b in zip(corners[:count], corners[count:], strict=True)
    ]
    assert 50 < sum(meet) < 250
    assert np.array_equal(apart, ~np.array(meet))


def test_thicker_polygons_meet_sooner() -> None:
    struts = round_struts(pair(2.01))
    parts = struts.runs, struts.blended, struts.curves, struts.collar, "flat", struts.crowded
    assert len(crossings(*parts).runs) == 0
    assert crossings(*parts, Slack(0.01)).runs.tolist() == [[0, 1]]


def test_cones_are_looked_at_in_pieces() -> None:
    # As wide as at its thick end all along, the cone would meet the cylinder.
    assert len(round_struts(pair(3.6, [1.0, 3.0, 1.0, 1.0])).overlapping) == 0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_struts_that_meet_are_always_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ends, radius = rng.normal(size=(4, 3)), rng.uniform(0.05, 0.3, 2)
    a, b = nearest_on_segments(*ends[:, None])
    nearest = float(np.linalg.norm(a - b))
    struts = round_struts(Skeleton(ends, [[0, 1], [2, 3]], np.repeat(radius, 2)))
    found = len(struts.overlapping) == 2
    # Flat ends reach less far than capsules do: only where both places are inside do they agree.
    if min(np.linalg.norm(ends - p, axis=1).min() for p in (*a, *b)) > radius.max():
        assert found == (nearest < radius.sum())
    elif nearest > radius.sum():
        assert not found


@pytest.mark.parametrize(("gap", "meet"), [(1.9, True), (2.1, False)])
def test_round_ends_reach_beyond_their_nodes(gap: float, meet: bool) -> None:
    tips = Skeleton([[0, 0, 0], [10, 0, 0], [10 + gap, 0, 0], [20, 0, 0]], [[0, 1], [2, 3]], 1.0)
    assert round_struts(tips, ends="round").overlapping.tolist() == ([0, 1] if meet else [])
    assert round_struts(tips, ends="flat").overlapping.tolist() == []
    check_as_written(round_mesh(round_struts(tips, ends="round")))


def test_neighbors_are_not_compared() -> None:
    bent = Skeleton([[0, 0, 0], [10, 0, 0], [10, 10, 0]], [[0, 1], [1, 2]], 1.0)
    struts = round_struts(bent)
    parts = struts.runs, struts.blended, struts.curves, struts.collar, "flat", struts.crowded
    assert len(crossings(*parts).runs) == 0
