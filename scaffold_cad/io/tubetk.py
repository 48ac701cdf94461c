"""TubeTK vessels (.tre): MetaIO tubes with a radius at each point."""

from __future__ import annotations

import math
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import as_count, is_number, line_error, read_text
from scaffold_cad.io.register import register_reader


def _recognizes(head: bytes) -> bool:
    return b"ObjectType" in head and (b"Tube" in head or b"Scene" in head) and b"NDims" in head


@register_reader("TubeTK", ".tre", recognizes=_recognizes)
def read_tubetk(path: Path) -> RawSkeleton:
    """Read the tubes of a text file: points in order, with radii.

    Points and radii are multiplied by ``ElementSpacing`` and moved by ``Offset``; a tube that
    names its parent's point is joined to that. Lengths are taken as mm.
    """
    graph = NamedGraph(path)
    tubes: list[tuple[str, dict[str, str]]] = []
    fields: dict[str, str] = {}
    rows: list[tuple[int, list[str]]] = []
    said = ""
    for line, text in enumerate(read_text(path).split("\n"), start=1):
        key, mark, value = text.partition("=")
        if mark:
            key = key.strip()
            if key == "ObjectType":
                _add_tube(path, graph, tubes, fields, rows)
                fields, rows = {}, []
            fields[key] = value.strip()
            if key == "NObjects":
                said = value.strip()
            if key == "BinaryData" and value.strip().lower() == "true":
                raise FormatError(f"{path} is a binary file; need text (BinaryData = False)")
        elif text.split() and "Points" in fields:
            rows.append((line, text.split()))
    _add_tube(path, graph, tubes, fields, rows)
    for name, of_tube in tubes:
        parent = (of_tube.get("ParentID", ""), of_tube.get("ParentPoint", ""))
        if parent in graph:
            graph.add_edge(parent, (name, "0"))
    if as_count(said) not in (None, len(tubes)):
        raise FormatError(f"{path} has {len(tubes)} tubes; need {said}, as it says")
    if not len(graph):
        raise FormatError(f"{path} has no tubes; need points")
    return graph.skeleton()


def _add_tube(
    path: Path,
    graph: NamedGraph,
    tubes: list[tuple[str, dict[str, str]]],
    fields: dict[str, str],
    rows: list[tuple[int, list[str]]],
) -> None:
    """Add the points of a tube to the graph, each joined to the one before it."""
    count = fields.get("NPoints", "")
    if as_count(count) not in (None, len(rows)):
        raise FormatError(f"{path} has {len(rows)} points in a tube; need {count}, as it says")
    if not rows:
        return
    columns = fields.get("PointDim", "x y z r").split()
    width = max(map(columns.index, set(columns) & {"x", "y", "z", "r"}), default=0) + 1
    if not {"x", "y"} <= set(columns):
        raise FormatError(f"{path} has points of {' '.join(columns)[:80]!r}; need x, y, z and r")
    spacing = _three(path, fields, "ElementSpacing", 1.0)
    offset = _three(path, fields, "Offset", 0.0)
    name = fields.get("ID", "")
    name = f"tube {len(tubes)}" if (name, "0") in graph or not name else name
    tubes.append((name, fields))
    for k, (line, words) in enumerate(rows):
        if len(words) < width or not all(is_number(word) for word in words[:width]):
            need = f"a point: {' '.join(columns)}"
            raise line_error(path, line, f"{' '.join(words)!r}", need)
        values = {axis: float(words[columns.index(axis)]) for axis in "xyzr" if axis in columns}
        place = [values.get(a, 0.0) * s + o for a, s, o in zip("xyz", spacing, offset, strict=True)]
        graph.add_node((name, str(k)), place, values.get("r", math.nan) * spacing[0])
        if k:
            graph.add_edge((name, str(k - 1)), (name, str(k)))


def _three(path: Path, fields: dict[str, str], key: str, default: float) -> list[float]:
    """Return three numbers of a field."""
    words = fields.get(key, "").split()
    if not all(is_number(word) for word in words):
        raise FormatError(f"{path} has {' '.join(words)[:80]!r} as {key}; need numbers")
    return [*(float(word) for word in words[:3]), *[default] * 3][:3]
