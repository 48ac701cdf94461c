"""What functions return is kept by its size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scaffold_cad.base.kept import bytes_of, kept


def test_results_are_kept_until_they_are_too_large() -> None:
    calls: list[int] = []

    @kept(1000)
    def zeros(count: int) -> np.ndarray:
        calls.append(count)
        return np.zeros(count)

    assert zeros(50) is zeros(50)
    zeros(60)
    zeros(50)  # used again, so the other goes first
    zeros(40)
    assert calls == [50, 60, 40]
    zeros(50)
    zeros(60)
    assert calls == [50, 60, 40, 60]
    assert zeros(500) is zeros(500)  # larger than all that may be kept
    zeros(60)
    assert calls[-2:] == [500, 60]


def test_arrays_in_tuples_and_fields_count() -> None:
    @dataclass
    class Pair:
        first: np.ndarray
        second: tuple[np.ndarray, int]

    assert bytes_of(Pair(np.zeros(3), (np.zeros(2), 7))) == 40
    assert bytes_of("text") == 0
