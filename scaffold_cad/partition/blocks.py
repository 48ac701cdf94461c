"""Cutting long stacks of arrays into blocks, which bounds memory and stays in the cache."""

from __future__ import annotations

from collections.abc import Iterator


def blocks(count: int, width: int, size: int) -> Iterator[slice]:
    """Return slices that cut `count` rows of `width` elements into blocks of about `size`."""
    rows = max(1, size // width)
    return (slice(start, min(start + rows, count)) for start in range(0, count, rows))
