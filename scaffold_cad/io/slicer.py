"""3D Slicer markups (.mrk.json): curves and lines by their control points."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.errors import FormatError
from scaffold_cad.io._document import member, number, read_document
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._units import length_of
from scaffold_cad.io.register import register_reader

OPEN, CLOSED = ("Curve", "Line"), ("ClosedCurve",)
"""Kinds of markups that become edges."""


def _recognizes(head: bytes) -> bool:
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    return text.startswith(b"{") and b'"markups"' in head and b'"controlPoints"' in head


@register_reader("Slicer markups", ".mrk.json", ".json", recognizes=_recognizes)
def read_slicer(path: Path) -> RawSkeleton:
    """Read lines, curves and closed curves; a curve is the polyline of its control points.

    Values of control points that are called "radius" are radii. Coordinates stay in the file's
    coordinate system, in mm.
    """
    document = read_document(path)
    points: list[Points] = [np.zeros((0, 3))]
    edges: list[Any] = [np.zeros((0, 2), dtype=np.intp)]
    radii: list[Floats] = [np.zeros(0)]
    count = 0
    for k, markup in enumerate(member(path, document, "markups", list)):
        if not isinstance(markup, dict) or markup.get("type") not in (*OPEN, *CLOSED):
            continue
        scale = length_of(str(markup.get("coordinateUnits", "mm"))) or 1.0
        rows = member(path, markup, "controlPoints", list, f"markup {k}")
        found = [_position(path, row, f"control point {i}") for i, row in enumerate(rows)]
        places = np.reshape(np.asarray(found, dtype=np.float64), (-1, 3)) * scale
        closed = markup["type"] in CLOSED and len(places) > 2
        after = np.arange(len(places) if closed else max(len(places) - 1, 0))
        edges.append(count + np.stack([after, (after + 1) % max(len(places), 1)], axis=1))
        points.append(places)
        radii.append(_radii(path, markup, len(places)))
        count += len(places)
    if not count:
        raise FormatError(f"{path} has no curves; need markups of type {', '.join(OPEN + CLOSED)}")
    of_nodes = np.concatenate(radii)
    known = None if np.isnan(of_nodes).all() else of_nodes
    return RawSkeleton(np.concatenate(points), np.concatenate(edges), known, unit="mm")


def _position(path: Path, row: Any, where: str) -> list[float]:
    place = member(path, row, "position", list, where)
    if len(place) != 3:
        raise FormatError(f"{path} has {len(place)} numbers as position of {where}; need 3")
    return [number(path, value, f"a coordinate of {where}") for value in place]


def _radii(path: Path, markup: dict[str, Any], count: int) -> Floats:
    """Return the radius of each control point, NaN where the file has none."""
    measured = markup.get("measurements", [])
    for row in measured if isinstance(measured, list) else []:
        if isinstance(row, dict) and str(row.get("name", "")).lower() == "radius":
            values = row.get("controlPointValues")
            if isinstance(values, list) and len(values) == count:
                return np.array([number(path, value, "a radius") for value in values])
    return np.full(count, np.nan)
