"""Spatial frames as JSON: the assembly format of choreo, and the models of pyconmech."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.errors import FormatError
from scaffold_cad.io._document import member, number, read_document
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.register import register_reader

_UNITS = {
    "millimeter": 1.0,
    "mm": 1.0,
    "centimeter": 10.0,
    "cm": 10.0,
    "meter": 1000.0,
    "m": 1000.0,
    "inch": 25.4,
    "in": 25.4,
    "feet": 304.8,
    "foot": 304.8,
    "ft": 304.8,
}
"""Length of each unit, mm."""


def _recognizes(head: bytes) -> bool:
    is_object = head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{")
    return is_object and (b'"node_list"' in head or (b'"nodes"' in head and b'"point"' in head))


@register_reader("spatial frame JSON", ".json", recognizes=_recognizes)
def read_spatial_frame(path: Path) -> RawSkeleton:
    """Read a frame of bars, each with its radius.

    Older files have ``node_list`` with points ``{"X": , "Y": , "Z": }``, ``element_list``, and
    one section for all bars in ``material_properties``; newer ones have ``nodes``, ``elements``,
    and ``cross_secs`` that bars name by tag. A section's radius is that of the circle of its
    area, whatever its shape. Lengths are in ``unit``, sections in their own units.
    """
    document = read_document(path)
    unit = _unit(path, document.get("unit", "millimeter"))
    older = "node_list" in document
    nodes = member(path, document, "node_list" if older else "nodes", list)
    bars = member(path, document, "element_list" if older else "elements", list)
    ends_key = "end_node_ids" if older else "end_node_inds"
    points = [_point(path, node, f"node {k}") for k, node in enumerate(nodes)]
    ends = [_pair(path, bar, ends_key, f"element {k}") for k, bar in enumerate(bars)]
    # Made here, so that ends out of range are refused before radii are put at them.
    said = None if "unit" not in document else str(document["unit"])
    bare = RawSkeleton(np.reshape(points, (-1, 3)) * unit, np.reshape(ends, (-1, 2)), unit=said)
    radii = _radii_of_bars(path, document, bars, unit)
    if radii is None:
        return bare
    return RawSkeleton(bare.nodes, bare.edges, edge_radii=radii, unit=said)


def _point(path: Path, node: Any, where: str) -> list[float]:
    """Return the position of a node: x, y, z, or x, y of a plane frame."""
    value = node.get("point") if isinstance(node, dict) else None
    if isinstance(value, dict):
        value = [value.get(axis) for axis in "XYZ"]
    if not isinstance(value, list) or len(value) not in (2, 3):
        raise FormatError(f'{path} has no "point" of 2 or 3 numbers in {where}; need one')
    return [number(path, x, f"a coordinate of {where}") for x in [*value, 0.0][:3]]


def _pair(path: Path, bar: Any, key: str, where: str) -> list[int]:
    ends: list[int] = member(path, bar, key, list, where)
    if len(ends) != 2 or not all(isinstance(end, int) for end in ends):
        raise FormatError(f"{path} joins {str(ends)[:80]} by {where}; need two numbers of nodes")
    return ends


def _radii_of_bars(
    path: Path, document: dict[str, Any], bars: list[Any], unit: float
) -> Floats | None:
    """Return the radius of each bar, shape (m,), mm, or None if the file holds no section."""
    if "cross_secs" not in document:
        section = document.get("material_properties")
        radius = _radius(path, section, "cross_sec_area", unit) if section else None
        return None if radius is None else np.full(len(bars), radius)
    sections = member(path, document, "cross_secs", list)
    of_tag: dict[str, float] = {}
    for section in sections:
        radius = _radius(path, section, "A", unit)
        if radius is not None:
            tags = member(path, section, "elem_tags", list) or [""]
            of_tag.update({str(tag): radius for tag in tags})
    if not of_tag:
        return None
    # Bars that name no section have the first one.
    first = next(iter(of_tag.values()))
    return np.array([of_tag.get(str(bar.get("elem_tag", "")), first) for bar in bars])


def _radius(path: Path, section: Any, key: str, unit: float) -> float | None:
    """Return the radius of a section, mm, or None if it has neither radius nor area."""
    if not isinstance(section, dict):
        raise FormatError(f"{path} has a section that is not an object; need one with {key!r}")
    if "radius" in section:
        name = section.get("radius_unit")
        scale = unit if name is None else _unit(path, name)
        return number(path, section["radius"], "radius") * scale
    if key not in section:
        return None
    area = number(path, section[key], key)
    name = str(section.get(f"{key}_unit", ""))
    scale = _unit(path, name.removesuffix("^2").removesuffix("2")) if name else unit
    return scale * math.sqrt(max(area, 0.0) / math.pi)


def _unit(path: Path, name: Any) -> float:
    """Return the length of a unit, mm."""
    known = str(name).strip().lower()
    if known not in _UNITS:
        raise FormatError(
            f"{path} has the unit {str(name)[:80]!r}; need one of {', '.join(_UNITS)}"
        )
    return _UNITS[known]
