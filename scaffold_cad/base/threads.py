"""Work on blocks of arrays in several threads: numpy lets them run at the same time.

Products of matrices then take one thread each. Left to themselves they take as many as there are
processors, which wait for each other: the same work took fifteen times as long. And the last bits
of products depend on how many threads there are.
"""

from __future__ import annotations

import os
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from functools import lru_cache
from threading import Lock
from typing import TypeVar

from threadpoolctl import ThreadpoolController

T = TypeVar("T")
U = TypeVar("U")

MOST_THREADS = 8
"""More of them wait for each other."""


def in_order(function: Callable[[T], U], items: Iterable[T]) -> Iterator[U]:
    """Yield `function` of each item, in the items' order, a few of them at a time.

    Only as many items are taken ahead as keep the threads busy, and none of them is begun after an
    error or once no more results are asked for.
    """
    threads = min(os.cpu_count() or 1, MOST_THREADS)
    waiting: deque[Future[U]] = deque()
    pool = ThreadPoolExecutor(threads)
    _single.enter()
    try:
        for item in items:
            waiting.append(pool.submit(function, item))
            if len(waiting) > 2 * threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)
        _single.leave()


class _SingleProducts:
    """Lets products of matrices take one thread each, for as long as anyone wants it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._users = 0
        self._limits = ExitStack()

    def enter(self) -> None:
        with self._lock:
            if self._users == 0:
                controller = _controller("scipy.linalg" in sys.modules)
                self._limits.enter_context(controller.limit(limits=1, user_api="blas"))
            self._users += 1

    def leave(self) -> None:
        with self._lock:
            self._users -= 1
            if self._users == 0:
                self._limits.close()


@lru_cache(maxsize=2)
def _controller(with_scipy: bool) -> ThreadpoolController:  # noqa: ARG001  (it has its own library)
    """Return what holds back the libraries that are loaded: to look for them takes some 30 ms."""
    return ThreadpoolController()


_single = _SingleProducts()
