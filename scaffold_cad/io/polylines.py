"""CGAL polylines: on each line the number of points of a polyline, then their coordinates."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.io._raw import RawSkeleton, joined_polylines
from scaffold_cad.io._text import (
    first_words,
    floats,
    is_number,
    line_error,
    read_rows,
    whole_number,
)
from scaffold_cad.io.register import register_reader

_NEED = "a polyline: N x y z x y z ..., with N points"


def _recognizes(head: bytes) -> bool:
    words = first_words(head)
    return (
        len(words) >= 7
        and len(words) % 3 == 1
        and words[0] == str(len(words) // 3)
        and all(is_number(word) for word in words)
    )


@register_reader("CGAL polylines", ".polylines.txt", ".cgal", recognizes=_recognizes)
def read_polylines(path: Path) -> RawSkeleton:
    """Read polylines, which have no radii and join where they have equal points."""
    rows = read_rows(path)
    counts = []
    for line, words in rows:
        count = whole_number(path, line, words[0], _NEED)
        if count < 1 or len(words) != 1 + 3 * count:
            raise line_error(path, line, f"N is {count} with {len(words) - 1} numbers", _NEED)
        counts.append(count)
    points = floats(path, rows, slice(1, None), _NEED).reshape(-1, 3)
    # The format has no other way to share a node than to repeat its coordinates.
    return joined_polylines(np.split(points, np.cumsum(counts[:-1], dtype=np.intp)))
