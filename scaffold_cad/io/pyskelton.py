"""Graphs of PySkelton (.graph): sections of nodes, edges, arcs and radii."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import (
    Row,
    first_words,
    float_columns,
    is_number,
    line_error,
    read_rows,
    whole_number,
)
from scaffold_cad.io.register import register_reader

_NODE = "a node: x y z"
_EDGE = "two numbers of nodes, from 0, or more of an arc"
_RADIUS = "a radius a node"


def _recognizes(head: bytes) -> bool:
    return first_words(head) == ["nodes"]


@register_reader("PySkelton graph", ".graph", recognizes=_recognizes)
def read_pyskelton(path: Path) -> RawSkeleton:
    """Read the sections ``nodes``, ``edges`` and ``arcs``, and ``radii`` where there are any.

    An arc is read as the edges between its nodes. Other sections are left out.
    """
    sections: dict[str, list[Row]] = {}
    inside = ""
    for line, words in read_rows(path):
        if len(words) == 1 and not is_number(words[0]):
            inside = words[0].lower()
            sections.setdefault(inside, [])
        else:
            sections.setdefault(inside, []).append((line, words))
    if "nodes" not in sections:
        raise FormatError(f"{path} has no line 'nodes'; need one before the nodes")
    rows = sections["nodes"]
    nodes = float_columns(path, rows, 0, 3, _NODE)
    pairs: list[tuple[int, int]] = []
    for line, words in [*sections.get("edges", []), *sections.get("arcs", [])]:
        numbers = [whole_number(path, line, word, _EDGE) for word in words]
        if len(numbers) < 2 or min(numbers) < 0 or max(numbers) >= len(rows):
            raise line_error(path, line, f"{' '.join(words)!r}", _EDGE)
        pairs += pairwise(numbers)
    edges = np.unique(np.reshape(np.asarray(pairs, dtype=np.intp), (-1, 2)), axis=0)
    radii = [word for _, words in sections.get("radii", []) for word in words]
    if not radii:
        return RawSkeleton(nodes, edges)
    if len(radii) != len(rows) or not all(is_number(word) for word in radii):
        raise FormatError(f"{path} has {len(radii)} radii of {len(rows)} nodes; need {_RADIUS}")
    return RawSkeleton(nodes, edges, [float(word) for word in radii])
