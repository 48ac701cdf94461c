from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.boxes import (
    PAIRS_AT_ONCE,
    order_in_space,
    overlapping_boxes,
    overlapping_neighbors,
    spans_of,
)
from scaffold_cad.base.counts import Count

ROUNDING = 2.0**-19
"""How far apart boxes of a pair may be, as a fraction of the extent of all."""


def pairs_of(low: Floats, high: Floats) -> list[tuple[int, int]]:
    blocks = [np.stack(block, axis=1) for block in overlapping_boxes(low, high)]
    return [tuple(pair) for pair in np.concatenate(blocks).tolist()]


def overlap_within(low: Floats, high: Floats, distance: float) -> set[tuple[int, int]]:
    gap = np.maximum(low[:, None] - high[None], low[None] - high[:, None]).max(axis=2)
    i, j = np.nonzero(np.triu(gap <= distance, k=1))
    return set(zip(i.tolist(), j.tolist(), strict=True))


def check(low: Floats, high: Floats) -> None:
    pairs = pairs_of(low, high)
    assert len(pairs) == len(set(pairs))
    extent = (high - low.min(axis=0)).max()
    assert overlap_within(low, high, 0.0) <= set(pairs)
    assert set(pairs) <= overlap_within(low, high, ROUNDING * extent)


@given(
    st.integers(1, 60),
    st.integers(0, 2**32 - 1),
    st.sampled_from([1e-6, 0.05, 1.0]),
    st.sampled_from([1e-3, 1.0, 1e6]),
)
@settings(max_examples=60, deadline=None)
def test_pairs_are_those_of_all_boxes_compared(
    count: int, seed: int, size: float, scale: float
) -> None:
    random = np.random.default_rng(seed)
    low = scale * random.standard_normal((count, 3))
    check(low, low + scale * size * random.exponential(size=(count, 3)))


def test_boxes_that_touch_are_pairs() -> None:
    low = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.5, 0, 0]])
    assert pairs_of(low, low + 1.0) == [(0, 1)]


def test_equal_boxes_and_points_are_pairs() -> None:
    low = np.zeros((4, 3))
    assert set(pairs_of(low, low)) == overlap_within(low, low, 0.0)


def test_one_large_box_among_small_ones_meets_them_all() -> None:
    random = np.random.default_rng(5)
    low = random.random((300, 3))
    high = low + 1e-3
    low[17], high[17] = 0.0, 1.1
    check(low, high)


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_boxes_have_no_pairs(count: int) -> None:
    low = np.zeros((count, 3))
    assert pairs_of(low, low + 1.0) == []


def test_many_pairs_come_in_blocks_of_bounded_size() -> None:
    count = 600
    low = np.zeros((count, 3))
    sizes = [len(i) for i, _ in overlapping_boxes(low, low + 1.0)]
    assert sum(sizes) == count * (count - 1) // 2
    assert max(sizes) <= 4 * PAIRS_AT_ONCE


@pytest.mark.parametrize("number", [1, 7, 1000])
def test_boxes_are_counted_once_their_pairs_are_told(number: int) -> None:
    low = np.random.default_rng(number).random((number, 3))
    high = low + 0.2
    order, count = order_in_space(low, high), Count("boxes", number)
    list(overlapping_neighbors(low[order], high[order], count))
    assert count.done == number


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-6, 0.05, 1.0]))
def test_spans_overlap_where_they_do_along_all_axes(seed: int, size: float) -> None:
    random = np.random.default_rng(seed)
    low = random.standard_normal((40, 3))
    high = low + size * random.exponential(size=(40, 3))
    i, j = np.triu_indices(40, 1)
    told = set(zip(i[found := spans_of(low, high).overlap(i, j)], j[found], strict=True))
    extent = (high - low.min(axis=0)).max()
    assert overlap_within(low, high, 0.0) <= told <= overlap_within(low, high, ROUNDING * extent)
