"""TGF, the trivial graph format, with coordinates in the labels of nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import Row, is_number, line_error, read_text
from scaffold_cad.io.register import register_reader

_NODE = "a node: name, x, y, z, and its radius if it has one"
_PUNCTUATION = str.maketrans("()[]{},;", "        ")


def _recognizes(head: bytes) -> bool:
    if b"\0" in head:
        return False
    lines = head.decode("utf-8-sig", errors="replace").translate(_PUNCTUATION).split("\n")
    if "#" not in [line.strip() for line in lines]:
        return False
    words = lines[0].split()
    return len(words) >= 4 and all(is_number(word) for word in words[1:4])


@register_reader("TGF", ".tgf", recognizes=_recognizes)
def read_tgf(path: Path) -> RawSkeleton:
    """Read nodes, a line ``#``, and edges.

    A node's label is its x, y, z, and its radius or none, between commas, blanks or brackets; what
    follows, as in files of libigl, is ignored, and so is an edge's label. Names are any words;
    edges have no direction.
    """
    nodes, links = _parts(path)
    number: dict[str, int] = {}
    values = np.full((len(nodes), 4), np.nan)
    for line, words in nodes:
        if words[0] in number:
            raise line_error(path, line, f"node {words[0]} is there already", "each name once")
        known = words[1:5] if len(words) == 5 else words[1:4]
        if len(known) < 3 or not all(is_number(word) for word in known):
            raise line_error(path, line, f"{' '.join(words)!r}", _NODE)
        values[len(number), : len(known)] = [float(word) for word in known]
        number[words[0]] = len(number)
    edges = []
    for line, words in links:
        lost = next((word for word in words[:2] if word not in number), None)
        if len(words) < 2 or lost is not None:
            raise line_error(path, line, f"{' '.join(words)!r}", "an edge: two names of nodes")
        edges.append((number[words[0]], number[words[1]]))
    radii = values[:, 3] if any(len(words) == 5 for _, words in nodes) else None
    pairs = np.reshape(np.asarray(edges, dtype=np.intp), (-1, 2))
    return RawSkeleton(values[:, :3], pairs, radii)


def _parts(path: Path) -> tuple[list[Row], list[Row]]:
    """Return the rows before and after the line ``#``."""
    before: list[Row] = []
    after: list[Row] | None = None
    for line, text in enumerate(read_text(path).split("\n"), start=1):
        words = text.translate(_PUNCTUATION).split()
        if words[:1] == ["#"] and after is None:
            after = []
        elif words:
            (before if after is None else after).append((line, words))
    if after is None:
        raise FormatError(f"{path} has no line '#' between nodes and edges; need one")
    return before, after
