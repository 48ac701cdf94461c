"""What functions return is kept by its size."""

from __future__ import annotations

import gc
from dataclasses import dataclass
from weakref import ref

import numpy as np
import pytest

from scaffold_cad.base.kept import bytes_of, kept, kept_last


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


def test_the_last_result_is_kept_while_its_first_argument_lives() -> None:
    class Thing:
        pass

    made: list[int] = []

    @kept_last
    def thing_for(what: Thing, number: int) -> Thing:
        made.append(number)
        return Thing()

    one, other = Thing(), Thing()
    assert thing_for(one, 1) is thing_for(one, 1)
    first = ref(thing_for(one, 1))
    thing_for(other, 1)
    thing_for(other, 2)
    gc.collect()
    assert first() is None
    thing_for(one, 1)
    assert made == [1, 1, 2, 1]
    last = ref(thing_for(one, 1))
    assert last() is not None
    del one
    gc.collect()
    assert last() is None


def test_an_error_keeps_nothing() -> None:
    @kept_last
    def half(what: np.ndarray, number: int) -> float:
        return 1.0 / number

    numbers = np.zeros(3)
    for number in (1, 0, 2, 2):
        if number == 0:
            with pytest.raises(ZeroDivisionError):
                half(numbers, number)
        else:
            assert half(numbers, number) == 1.0 / number


def test_arrays_in_tuples_and_fields_count() -> None:
    @dataclass
    class Pair:
        first: np.ndarray
        second: tuple[np.ndarray, int]

    assert bytes_of(Pair(np.zeros(3), (np.zeros(2), 7))) == 40
    assert bytes_of("text") == 0
