from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.skeleton.thinning import farthest_sample, kept_samples

_NUMBER = st.integers(-200, 200).map(lambda quarters: quarters / 4)
_SAMPLES = st.lists(st.tuples(_NUMBER, _NUMBER, _NUMBER), min_size=2, max_size=30, unique=True)

THIN = 1e-6
"""A radius so small that no joint is crowded, mm."""


def strays(points: Points, radii: Floats, keep: np.ndarray) -> float:
    """Return how far a sample lies from the polyline of those kept between its neighbors."""
    samples = np.column_stack([points, radii])
    kept = np.flatnonzero(keep)
    worst = 0.0
    for first, last in pairwise(kept.tolist()):
        chord = samples[last] - samples[first]
        for sample in samples[first : last + 1]:
            t = np.clip((sample - samples[first]) @ chord / max(chord @ chord, 1e-300), 0, 1)
            worst = max(worst, float(np.linalg.norm(sample - samples[first] - t * chord)))
    return worst


@given(_SAMPLES, st.floats(0, 20))
def test_no_sample_strays_more_than_the_tolerance(
    places: list[tuple[float, float, float]], tolerance: float
) -> None:
    points = np.array(places)
    radii = np.full(len(points), THIN)
    keep = kept_samples(points, radii, tolerance)
    assert keep[0]
    assert keep[-1]
    assert strays(points, radii, keep) <= tolerance + 1e-9


def test_samples_on_a_line_go_and_corners_stay() -> None:
    points = np.array([[0, 0, 0], [3, 0, 0], [5, 0, 0], [9, 0, 0], [9, 4, 0], [9, 9, 0]], float)
    keep = kept_samples(points, np.full(6, 0.1), 0.01)
    assert keep.tolist() == [True, False, False, True, False, True]


def test_a_change_of_radius_keeps_its_sample() -> None:
    points = np.stack([np.arange(0, 50, 10.0), np.zeros(5), np.zeros(5)], axis=1)
    keep = kept_samples(points, np.array([1.0, 1, 2, 1, 1]), 0.3)
    assert keep.tolist() == [True, True, True, True, True]
    keep = kept_samples(points, np.array([1.0, 1.5, 2, 2.5, 3]), 0.3)
    assert keep.tolist() == [True, False, False, False, True]


def test_a_joint_closer_to_its_neighbor_than_its_radius_goes() -> None:
    points = np.array([[0, 0, 0], [2, 1, 0], [10, 0, 3], [19, 1, 0], [20, 0, 0]], float)
    keep = kept_samples(points, np.full(5, 3.0), 0.0)
    assert keep.tolist() == [True, False, True, False, True]
    assert kept_samples(points, np.full(5, 1.0), 0.0).all()


def test_only_neighbors_along_the_chain_crowd_each_other() -> None:
    # The second sample is near the end in space, not along the chain.
    points = np.array([[9, 0, 0], [0, 1, 0], [0, 9, 0], [-9, 0, 0], [0, 0, 0]], float)
    assert kept_samples(points, np.full(5, 2.0), 0.0).all()


def test_joints_near_the_end_go_one_after_the_other() -> None:
    points = np.array([[0, 0, 0], [10, 0, 0], [12, 1, 0], [12, 0, 0]], float)
    assert kept_samples(points, np.full(4, 3.0), 0.0).tolist() == [True, False, False, True]


def test_the_larger_radius_of_the_two_counts() -> None:
    points = np.array([[0, 0, 0], [5, 1, 0], [20, 0, 0]], float)
    assert not kept_samples(points, np.array([6.0, 4.8, 1]), 0.0)[1]
    assert kept_samples(points, np.array([4.9, 4.8, 1]), 0.0)[1]
    assert kept_samples(points, np.array([1.0, 4.8, 6]), 0.0)[1]


@pytest.mark.parametrize("turned", [1, -1])
def test_a_joint_stays_where_a_thin_strut_leaves_a_ball(turned: int) -> None:
    points = np.array([[0, 0, 0], [5, 0, 0], [5.5, 0, 0], [40, 0, 0]], float)[::turned]
    assert kept_samples(points, np.array([6.0, 1, 1, 1])[::turned], 0.01)[1:3].any()
    assert kept_samples(points[::3], np.array([6.0, 1])[::turned], 0.01).all()


def test_no_sample_of_a_crowded_run_strays_in_radius() -> None:
    points = np.stack([np.linspace(0, 4, 9), np.zeros(9), np.zeros(9)], axis=1)
    radii = np.array([5.0, 5, 5, 5, 1, 1, 1, 1, 1])
    keep = np.flatnonzero(kept_samples(points, radii, 0.0))
    between = np.interp(points[:, 0], points[keep, 0], radii[keep])
    assert np.abs(between - radii).max() <= 0.1 * 5.0


@pytest.mark.parametrize("count", [2, 3])
def test_equal_samples_are_thinned_to_the_ends(count: int) -> None:
    keep = kept_samples(np.ones((count, 3)), np.ones(count), 0.0)
    assert np.flatnonzero(keep).tolist() == [0, count - 1]


def test_the_farthest_sample_is_an_inner_one() -> None:
    points = np.array([[0, 0, 0], [2, 0, 0], [4, 0, 3], [6, 0, -4], [8, 0, 0]], float)
    assert farthest_sample(points) == 3
    assert farthest_sample(points[:3] * [1, 1, 0]) == 1
