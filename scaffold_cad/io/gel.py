"""GEL graphs: a line `n x y z` per node, a line `c i j` per edge."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import first_words, float_columns, index_columns, line_error, read_rows
from scaffold_cad.io.register import register_reader

_NODE = "a node: n x y z"
_EDGE = "an edge: c i j"


def _recognizes(head: bytes) -> bool:
    words = first_words(head)
    return len(words) >= 4 and words[0] == "n"


@register_reader("GEL graph", ".graph", recognizes=_recognizes)
def read_graph(path: Path) -> RawSkeleton:
    """Read a graph of the GEL library, which has no radii.

    Nodes that were removed are there as ``n nan nan nan`` and count in the indices from 0.
    """
    rows = read_rows(path)
    for line, words in rows:
        if words[0] not in ("n", "c"):
            raise line_error(path, line, f"{words[0]!r}", f"{_NODE}, or {_EDGE}")
    nodes = float_columns(path, [row for row in rows if row[1][0] == "n"], 1, 3, _NODE)
    links = [row for row in rows if row[1][0] == "c"]
    return RawSkeleton(nodes, index_columns(path, links, 1, 2, len(nodes), _EDGE))
