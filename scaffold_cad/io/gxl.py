"""GXL, the graph exchange language, as VascuSynth writes vascular trees."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import read_text
from scaffold_cad.io._xml import xml_root
from scaffold_cad.io.register import register_reader


def _recognizes(head: bytes) -> bool:
    return b"<gxl" in head


@register_reader("GXL", ".gxl", recognizes=_recognizes)
def read_gxl(path: Path) -> RawSkeleton:
    """Read nodes with a ``position`` and edges with a ``radius``, or with none.

    VascuSynth puts blanks before names and around
    values (``name=" position"``), declares a document type by name only, which is left out, and
    calls its files ``tree_structure.xml``. Positions are taken as mm.
    """
    root = xml_root(path, _without_doctype(read_text(path)).encode())
    number: dict[str, int] = {}
    nodes = []
    for node in root.iter("node"):
        name = _name(path, node, "id")
        if name in number:
            raise FormatError(f"{path} has two nodes {name!r}; need each once")
        number[name] = len(number)
        nodes.append(_values(path, node, "position", f"node {name!r}", 3))
    edges, radii = [], []
    for edge in root.iter("edge"):
        ends = [_name(path, edge, key) for key in ("from", "to")]
        lost = next((end for end in ends if end not in number), None)
        if lost is not None:
            raise FormatError(f"{path} has an edge to {lost!r}; need the name of a node")
        edges.append([number[end] for end in ends])
        radii.append(_values(path, edge, "radius", f"edge {ends[0]!r} to {ends[1]!r}", 1))
    pairs = np.reshape(np.asarray(edges, dtype=np.intp), (-1, 2))
    points = np.reshape(nodes, (-1, 3))
    if not any(radii):
        return RawSkeleton(points, pairs)
    of_edges = np.array([row[0] if row else np.nan for row in radii])
    return RawSkeleton(points, pairs, edge_radii=of_edges)


def _without_doctype(text: str) -> str:
    """Return `text` without a document type that only names itself."""
    start = text.find("<!DOCTYPE")
    end = text.find(">", start)
    if start < 0 or end < 0 or "[" in text[start:end]:
        return text
    return text[:start] + text[end + 1 :]


def _name(path: Path, element: Element, key: str) -> str:
    name = element.get(key)
    if name is None:
        raise FormatError(f"{path} has a <{element.tag}> without {key!r}; need one")
    return name.strip()


def _values(path: Path, owner: Element, name: str, where: str, count: int) -> list[float]:
    """Return the numbers of an attribute: `count`, or none if it has no radius."""
    for attribute in owner.findall("attr"):
        if attribute.get("name", "").strip() == name:
            texts = [
                value.text or "" for kind in ("float", "int") for value in attribute.iter(kind)
            ]
            try:
                values = [float(text) for text in texts]
            except ValueError:
                values = []
            if len(values) != count:
                raise FormatError(f"{path} has {texts} as {name} of {where}; need {count} numbers")
            return values
    if name == "radius":
        return []
    raise FormatError(f"{path} has no {name} of {where}; need {count} numbers")
