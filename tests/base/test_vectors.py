"""Tests of base/vectors.py."""

from __future__ import annotations

import numpy as np

from scaffold_cad.base.vectors import sums_by_row


def test_sums_by_row_take_values_and_rows_of_any_shape() -> None:
    rng = np.random.default_rng(2)
    rows, values = rng.integers(0, 5, (7, 4)), rng.normal(size=(7, 4, 3, 2))
    table = np.zeros((6, 3, 2))
    np.add.at(table, rows, values)
    np.testing.assert_allclose(sums_by_row(values, rows, 6), table, atol=1e-14)
    assert sums_by_row(values[:0], rows[:0], 6).shape == (6, 3, 2)
