"""NML, skeletons of webKnossos and KNOSSOS: nodes in voxels, with radii."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from scaffold_cad.errors import FormatError
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, check_size, is_number
from scaffold_cad.io._xml import xml_root
from scaffold_cad.io.register import register_reader

NANOMETERS = 1000.0
"""nm in the micrometer that is taken as a millimeter."""


def _recognizes(head: bytes) -> bool:
    return b"<things" in head


@register_reader("NML", ".nml", recognizes=_recognizes)
def read_nml(path: Path) -> RawSkeleton:
    """Read the trees of an NML file.

    Positions are in voxels, whose size in nm is the file's ``scale``; radii are in nm. As neurons
    are, so that something can be built, they are given in µm and these are taken as mm.
    """
    check_size(path, LARGEST_FILE)
    root = xml_root(path, path.read_bytes())
    scale = root.find("parameters/scale")
    size = [1.0] * 3 if scale is None else [_number(path, scale, axis) for axis in "xyz"]
    graph = NamedGraph(path)
    for node in root.iter("node"):
        place = [_number(path, node, axis) * s for axis, s in zip("xyz", size, strict=True)]
        radius = math.nan if node.get("radius") is None else _number(path, node, "radius")
        graph.add_node(node.get("id", ""), place, radius)
    for edge in root.iter("edge"):
        graph.add_edge(edge.get("source", ""), edge.get("target", ""))
    if not len(graph):
        raise FormatError(f"{path} has no nodes; need things with nodes and edges")
    return graph.skeleton(1.0 / NANOMETERS, usual_unit="um")


def _number(path: Path, element: Element, name: str) -> float:
    text = element.get(name, "")
    if not is_number(text):
        raise FormatError(f"{path} has {text[:80]!r} as {name} of <{element.tag}>; need a number")
    return float(text)
