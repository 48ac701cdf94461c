"""GraphML, as networkx, igraph, yEd and vessel programs write it: nodes with positions."""

from __future__ import annotations

import math
from itertools import product
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from scaffold_cad.errors import FormatError
from scaffold_cad.io._attributes import as_number, position_in, radius_in
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, check_size
from scaffold_cad.io._xml import xml_root
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer


def _recognizes(head: bytes) -> bool:
    return b"<graphml" in head


@register_reader("GraphML", ".graphml", recognizes=_recognizes)
def read_graphml(path: Path) -> RawSkeleton:
    """Read nodes and edges; names of attributes may differ in case.

    A node's position is in ``x``, ``y`` and ``z``, or in ``pos``, ``position`` or ``coordinates``
    as a text; its radius, and that of an edge, in ``radius``, ``diameter`` or ``area``, and those
    of an edge's ends in ``r1`` and ``r2``. Lengths are taken as mm.
    """
    check_size(path, LARGEST_FILE)
    root = xml_root(path, path.read_bytes())
    names, usual = _keys(root)
    graph = NamedGraph(path)
    for node in _all(root, "node"):
        values = usual["node"] | _data(node, names)
        place = position_in(values)
        name = node.get("id", "")
        if place is None:
            raise FormatError(f"{path} has no position of node {name!r:.80}; need x, y and z")
        graph.add_node(name, place, radius_in(values))
    for edge in _all(root, "edge"):
        values = usual["edge"] | _data(edge, names)
        ends = (as_number(values.get("r1")), as_number(values.get("r2")))
        radius: float | tuple[float, float] = radius_in(values)
        if ends[0] is not None and ends[1] is not None:
            radius = (ends[0], ends[1])
        graph.add_edge(edge.get("source", ""), edge.get("target", ""), radius)
    return graph.skeleton()


def _keys(root: Element) -> tuple[dict[str, str], dict[str, dict[str, Any]]]:
    """Return the names of attributes by their keys, and what nodes and edges have without data."""
    names: dict[str, str] = {}
    usual: dict[str, dict[str, Any]] = {"node": {}, "edge": {}}
    for key in _all(root, "key"):
        name = names[key.get("id", "")] = key.get("attr.name", key.get("id", ""))
        for kind, default in product(usual, _all(key, "default")):
            if key.get("for", "all") in (kind, "all"):
                usual[kind][name] = (default.text or "").strip()
    return names, usual


def _all(root: Element, tag: str) -> list[Element]:
    """Return the elements of a name in any namespace or none."""
    return [element for element in root.iter() if element.tag.rpartition("}")[2] == tag]


def _data(owner: Element, names: dict[str, str]) -> dict[str, Any]:
    return {
        names.get(data.get("key", ""), data.get("key", "")): (data.text or "").strip()
        for data in owner
        if data.tag.rpartition("}")[2] == "data"
    }


@register_writer(".graphml", name="GraphML", solids=False)
def write_graphml(content: Content, path: Path) -> None:
    """Write a Skeleton, exact to the last bit: nodes with radii, edges with those of their ends."""
    skeleton = content.skeleton("a GraphML file")
    keys = {"x": "node", "y": "node", "z": "node", "radius": "node", "r1": "edge", "r2": "edge"}
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(
            f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- scaffold_cad, unit: {content.unit} -->\n'
            '<graphml xmlns="http://graphml.graphdrawing.org/xmlns">\n'
        )
        file.writelines(
            f'<key id="{name}" for="{owner}" attr.name="{name}" attr.type="double"/>\n'
            for name, owner in keys.items()
        )
        file.write('<graph edgedefault="undirected">\n')
        rows = zip(skeleton.nodes.tolist(), skeleton.radii.tolist(), strict=True)
        for k, (place, radius) in enumerate(rows):
            named = zip(("x", "y", "z", "radius"), (*place, radius), strict=True)
            file.write(f'<node id="{k}">{_written(named)}</node>\n')
        pairs = zip(skeleton.edges.tolist(), skeleton.edge_radii.tolist(), strict=True)
        for (a, b), ends in pairs:
            named = zip(("r1", "r2"), ends, strict=True)
            file.write(f'<edge source="{a}" target="{b}">{_written(named)}</edge>\n')
        file.write("</graph>\n</graphml>\n")


def _written(named: Any) -> str:
    return "".join(
        f'<data key="{key}">{value!r}</data>' for key, value in named if math.isfinite(value)
    )
