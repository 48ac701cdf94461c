"""How many things of a long work are done, for a line of progress; not counted otherwise."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
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


@contextmanager
def counting(name: str, total: int) -> Iterator[Count]:
    """Count things while the block runs, which tells how many are done.

    Examples
    --------
    >>> with counting("boxes", 3) as count:
    ...     count.done += 2
    ...     print(running().done, "of", running().total)
    2 of 3
    """
    count = Count(name, total)
    _running.append(count)
    try:
        yield count
    finally:
        _running.remove(count)


def tracked(name: str, results: Iterable[T], sizes: Sequence[int]) -> Iterator[T]:
    """Yield results one after the other, and count what is done until then.

    Parameters
    ----------
    name : of the things, such as "blends"
    sizes : how many of them each result is of, as many as there are results

    Examples
    --------
    >>> for letter in tracked("letters", "ab", [1, 3]):
    ...     print(letter, running().done, "of", running().total)
    a 1 of 4
    b 4 of 4
    """
    with counting(name, sum(sizes)) as count:
        for result, size in zip(results, sizes, strict=True):
            count.done += size
            yield result


def running() -> Count | None:
    """Return the count that began last of those that have not ended."""
    try:
        return _running[-1]
    except IndexError:
        return None
