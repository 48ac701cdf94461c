"""Spans: stretches of struts that belong to clusters, and the room between them."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.clusters.spans import Spans, merged
from scaffold_cad.struts.runs import straight_runs

RUNS = straight_runs(
    Skeleton([[0, 0, 0], [30, 0, 0], [0, 9, 0], [30, 9, 0]], [[0, 1], [2, 3]], 1.0)
)
FREE = np.array([[0.0, 30.0], [4.0, 26.0]])


def spans(*rows: tuple[int, float, float]) -> Spans:
    run, low, high = zip(*rows, strict=True)
    return Spans(np.array(run), np.array(low, float), np.array(high, float))


def rows_of(found: Spans) -> list[tuple[int, float, float]]:
    columns = (found.run.tolist(), found.low.tolist(), found.high.tolist())
    return list(zip(*columns, strict=True))


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ([(0, 10, 12), (0, 11, 14)], [(0, 10, 14)]),
        ([(0, 10, 12), (0, 20, 22)], [(0, 10, 12), (0, 20, 22)]),
        ([(0, 10, 12), (0, 14, 16)], [(0, 10, 16)]),  # no room for two cuts between
        ([(0, 0.5, 12)], [(0, 0, 12)]),  # no room for a cut before the end
        ([(1, 4.5, 12)], [(1, 0, 12)]),  # nor beside the other node's ring
        ([(1, 12, 25.5)], [(1, 12, 30)]),
        ([(1, 6, 8), (0, 6, 8)], [(0, 6, 8), (1, 6, 8)]),
        ([(0, -3, 40)], [(0, 0, 30)]),
    ],
)
def test_spans_without_room_between_them_become_one(
    given: list[tuple[int, float, float]], found: list[tuple[int, float, float]]
) -> None:
    assert rows_of(merged(spans(*given), RUNS, FREE)) == found


def test_spans_that_reach_a_node_hold_it() -> None:
    assert spans((0, 0, 5), (1, 6, 30)).nodes(RUNS).tolist() == [True, False, False, True]


def test_spans_cover_what_is_within_them() -> None:
    own = spans((0, 5, 9), (1, 2, 4), (1, 8, 12))
    asked = spans((0, 5, 9), (0, 4, 9), (1, 9, 10), (1, 3, 9), (1, 2, 4.001))
    assert own.covers(asked, np.full(5, 0.01)).tolist() == [True, False, True, False, True]
