"""COMPAS JSON: networks and graphs, of COMPAS 1 and 2."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from scaffold_cad.errors import FormatError
from scaffold_cad.io._attributes import position_in, radius_in
from scaffold_cad.io._document import member, read_document
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_reader


def _recognizes(head: bytes) -> bool:
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    return text.startswith(b"{") and b'"dtype"' in head and b'"compas' in head


@register_reader("COMPAS JSON", ".json", recognizes=_recognizes)
def read_compas(path: Path) -> RawSkeleton:
    """Read a network or graph of COMPAS; lengths are taken as mm.

    Positions are x, y, z of nodes, or of the defaults of nodes; radii are attributes ``radius``,
    ``diameter`` or ``area`` of nodes and of edges.
    """
    document = read_document(path)
    kind = str(document.get("dtype", ""))
    data = member(path, document, "data" if "data" in document else "value", dict)
    if isinstance(data.get("data"), dict):  # older versions wrap it once more
        data = data["data"]
    if not isinstance(data.get("node"), dict):
        raise FormatError(f"{path} is a {kind[:80]}; need a Network or a Graph")
    usual = data.get("default_node_attributes", data.get("dna", {}))
    usual = usual if isinstance(usual, dict) else {}
    usual = {"x": 0.0, "y": 0.0, "z": 0.0, **usual}
    graph = NamedGraph(path)
    for name, row in data["node"].items():
        values: dict[str, Any] = {**usual, **(row if isinstance(row, dict) else {})}
        place = position_in(values)
        if place is None:
            raise FormatError(f"{path} has no position of node {name!r:.80}; need x, y and z")
        graph.add_node(name, place, radius_in(values))
    pairs = set()
    for start, row in member(path, data, "edge", dict).items():
        for end, values in (row if isinstance(row, dict) else {}).items():
            if frozenset((start, end)) not in pairs:  # some versions have both directions
                pairs.add(frozenset((start, end)))
                graph.add_edge(start, end, radius_in(values if isinstance(values, dict) else {}))
    return graph.skeleton()
