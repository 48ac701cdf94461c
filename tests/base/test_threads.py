"""Blocks of work in several threads: in order, few ahead, and errors come through."""

from __future__ import annotations

import time
from collections.abc import Iterator
from threading import Event, Timer

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from scaffold_cad.base.threads import MOST_THREADS, in_order
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.intersections.search import ONE_THREAD
from scaffold_cad.mesh.subdivision import catmull_clark
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton


def test_results_come_in_the_order_of_the_items() -> None:
    def work(item: int) -> int:
        if item == 0:
            time.sleep(0.05)  # others are done before the first
        return item * item

    assert list(in_order(work, range(100))) == [k * k for k in range(100)]


def test_few_items_are_taken_ahead() -> None:
    taken = []

    def items() -> Iterator[int]:
        for k in range(1000):
            taken.append(k)
            yield k

    results = in_order(abs, items())
    assert next(results) == 0
    assert len(taken) <= 2 * MOST_THREADS + 1


def test_products_take_one_thread_while_any_work_runs() -> None:
    def threads(_: object = None) -> set[int]:
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    with threadpool_limits(2):
        before = threads()
        outer, inner = in_order(threads, range(4)), in_order(threads, range(4))
        assert next(outer) == next(inner) == {1}
        assert list(outer) == [{1}] * 3
        assert list(inner) == [{1}] * 3
        assert threads() == before


def test_an_error_in_a_thread_is_raised() -> None:
    with pytest.raises(ZeroDivisionError):
        list(in_order(lambda k: 1 // k, [2, 1, 0]))


@pytest.mark.parametrize("failing", [True, False], ids=["an error", "a break"])
def test_what_waits_is_not_begun_in_vain(monkeypatch: pytest.MonkeyPatch, failing: bool) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    begun, held = [], Event()

    def work(item: int) -> int:
        begun.append(item)
        if item == 0:
            return 1 // (0 if failing else 1)
        assert held.wait(10)
        return item

    results = in_order(work, range(100))
    release = Timer(0.2, held.set)  # shutting down waits for what is begun
    release.start()
    if failing:
        with pytest.raises(ZeroDivisionError):
            next(results)
    else:
        next(results)
        results.close()
    release.join()
    assert set(begun) <= {0, 1, 2}  # what two threads begin at most before one item is done


def test_large_meshes_are_tested_as_small_ones_are(monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = [[-9, 0, 0], [9, 0, 0], [0, -9, 0.5], [0, 9, 0.5]]
    crossing = build_scaffold(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))
    mesh = catmull_clark(crossing.mesh, 6).mesh
    assert len(mesh.triangles) > ONE_THREAD
    found = self_intersections(mesh)
    assert len(found) > 0
    monkeypatch.setattr("scaffold_cad.mesh.intersections.search.ONE_THREAD", len(mesh.triangles))
    np.testing.assert_array_equal(self_intersections(mesh), found)
