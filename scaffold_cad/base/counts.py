"""How many things of a long work are done, for whoever shows it; nobody looks unless asked."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

T = TypeVar("T")


@dataclass(eq=False)
class Count:
    """Things that are worked on."""

    name: str
    """What they are, such as "blends"."""
    total: int
    """How many there are."""
    done: int = 0
    """How many of them are done."""
    begun: float = field(default_factory=time.monotonic)
    """When the work on them began, s of the monotonic clock."""


_running: list[Count] = []


def counted(name: str, results: Iterable[T], sizes: Sequence[int]) -> Iterator[T]:
    """Yield results one after the other, and count what is done until then.

    Parameters
    ----------
    name : of the things, such as "blends"
    sizes : how many of them each result is of, as many as there are results

    Examples
    --------
    >>> for letter in counted("letters", "ab", [1, 3]):
    ...     print(letter, running().done, "of", running().total)
    a 1 of 4
    b 4 of 4
    """
    count = Count(name, sum(sizes))
    _running.append(count)
    try:
        for result, size in zip(results, sizes, strict=True):
            count.done += size
            yield result
    finally:
        _running.remove(count)


def running() -> Count | None:
    """Return the count that began last of those that have not ended."""
    try:
        return _running[-1]
    except IndexError:
        return None
