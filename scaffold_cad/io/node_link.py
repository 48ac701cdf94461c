"""Node-link JSON, as networkx and D3 write graphs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from scaffold_cad.errors import FormatError
from scaffold_cad.io._attributes import position_in, radius_in
from scaffold_cad.io._document import member, read_document
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_reader

_NODES = re.compile(rb'"nodes"\s*:\s*\[\s*\{')

_OTHERS = (b'"point"', b'"markups"', b'"asset"', b'"node_list"')
"""What spatial frames, markups and glTF have, and node-link JSON does not have."""


def _recognizes(head: bytes) -> bool:
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    is_graph = text.startswith(b"{") and bool(_NODES.search(head))
    return is_graph and not any(mark in head for mark in _OTHERS)


@register_reader("node-link JSON", ".json", recognizes=_recognizes)
def read_node_link(path: Path) -> RawSkeleton:
    """Read the graph that `networkx.node_link_data` gives; ``links`` may be called ``edges``.

    A node's position is in ``x``, ``y`` and ``z``, or in ``pos`` or ``position``; its radius, and
    that of an edge, in ``radius``, ``diameter`` or ``area``. Edges name the ``id`` of nodes, or
    count nodes from 0 where these have none. Lengths are taken as mm.
    """
    document = read_document(path)
    rows = member(path, document, "nodes", list)
    links = member(path, document, "links" if "links" in document else "edges", list)
    graph = NamedGraph(path)
    for k, row in enumerate(rows):
        values = _object(path, row, f"node {k}")
        place = position_in(values)
        if place is None:
            raise FormatError(f"{path} has no position of node {k}; need x, y and z, or pos")
        name = values.get("id", values.get("name", values.get("key", k)))
        graph.add_node(_name(name), place, radius_in(values))
    for k, row in enumerate(links):
        values = _object(path, row, f"edge {k}")
        ends = [_name(values.get(key)) for key in ("source", "target")]
        graph.add_edge(ends[0], ends[1], radius_in(values))
    return graph.skeleton()


def _object(path: Path, row: Any, where: str) -> dict[str, Any]:
    if not isinstance(row, dict):
        raise FormatError(f"{path} has {str(row)[:80]!r} as {where}; need an object")
    return row


def _name(value: Any) -> str:
    """Return the name of a node: networkx may write a tuple, which JSON has as a list."""
    return value if isinstance(value, str) else repr(value)
