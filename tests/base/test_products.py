"""Products of rows that do not depend on how many there are."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.base.products import row_products
from scaffold_cad.base.vectors import running_sums


@pytest.mark.parametrize("count", [1, 3, 24, 25, 100])
def test_rows_have_the_same_bits_among_any_others(count: int) -> None:
    random = np.random.default_rng(count)
    rows, matrix = random.normal(size=(count, 400)), random.normal(size=(400, 70))
    all_rows = row_products(np.concatenate([rows, random.normal(size=(60, 400))]), matrix)
    np.testing.assert_array_equal(row_products(rows, matrix), all_rows[:count])
    np.testing.assert_allclose(all_rows[:count], rows @ matrix, rtol=1e-9, atol=1e-9)


def test_no_rows_have_no_products() -> None:
    assert row_products(np.empty((0, 4)), np.ones((4, 2))).shape == (0, 2)


def test_sums_of_a_run_have_the_same_bits_among_any_others() -> None:
    random = np.random.default_rng(3)
    runs = [random.normal(size=size) for size in (1, 7, 100, 3)]
    position = np.concatenate([np.arange(len(run)) for run in runs])
    sums = running_sums(np.concatenate(runs), position)
    alone = [running_sums(run, np.arange(len(run))) for run in runs]
    np.testing.assert_array_equal(sums, np.concatenate(alone))
    np.testing.assert_allclose(alone[2], np.cumsum(runs[2]), atol=1e-12)
