"""Tests of base/blocks.py."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.blocks import CACHE, blocks, cut, uneven_blocks


@pytest.mark.parametrize("count", [0, 1, 7, 1000])
def test_blocks_hold_each_row_once(count: int) -> None:
    for row in (1, 16, 1e9):
        parts = [np.arange(count)[part] for part in blocks(count, row, within=64)]
        assert np.concatenate([*parts, []]).tolist() == list(range(count))
        assert all(len(part) == max(1, 64 // row) for part in parts[:-1])


def test_rows_larger_than_a_block_come_one_by_one() -> None:
    assert [len(part) for part in cut(np.arange(3), 2 * CACHE, CACHE)] == [1, 1, 1]


def test_uneven_blocks_hold_each_row_once_and_hardly_more_than_they_may() -> None:
    sizes = np.random.default_rng(3).integers(0, 9, size=200)
    parts = list(uneven_blocks(sizes, item=8, within=160))
    assert np.concatenate([np.arange(200)[part] for part in parts]).tolist() == list(range(200))
    assert max(sizes[part].sum() for part in parts) < 20 + 9


def test_nothing_has_no_uneven_blocks() -> None:
    assert list(uneven_blocks(np.zeros(0, dtype=np.intp), item=8)) == []
