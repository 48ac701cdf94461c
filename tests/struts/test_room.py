"""Room on struts that two nodes share: what is wanted where it fits, in proportion where not."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.struts.room import SPARE, allotted


def test_what_fits_is_allowed() -> None:
    allowed, without = allotted(np.array([3.0, 4.0]), np.array([1.0, 1.0]), np.array([10.0]))
    assert allowed.tolist() == [3.0, 4.0]
    assert not without.any()


def test_what_is_left_is_shared_in_proportion() -> None:
    allowed, without = allotted(np.array([6.0, 11.0]), np.array([1.0, 1.0]), np.array([8.0]))
    usable = 8.0 * (1 - SPARE)
    assert allowed.sum() == pytest.approx(usable)
    assert allowed - 1.0 == pytest.approx((usable - 2) * np.array([5, 10]) / 15)
    assert not without.any()


def test_struts_shorter_than_the_least_have_no_room() -> None:
    wanted, least = np.array([6.0, 6.0, 1.0, 1.0]), np.array([4.0, 4.1, 0.5, 0.5])
    allowed, without = allotted(wanted, least, np.array([8.0, 8.0]))
    assert without.tolist() == [True, False]
    assert (allowed >= least).all()


def test_ends_that_want_nothing_get_nothing() -> None:
    allowed, without = allotted(np.zeros(2), np.zeros(2), np.array([5.0]))
    assert allowed.tolist() == [0.0, 0.0]
    assert not without.any()
