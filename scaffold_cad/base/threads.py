"""Work on blocks of arrays in several threads: numpy lets them run at the same time."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

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
    try:
        for item in items:
            waiting.append(pool.submit(function, item))
            if len(waiting) > 2 * threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)
