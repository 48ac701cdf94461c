"""GML, the graph modeling language: nested lists of keys and values."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from scaffold_cad.errors import FormatError
from scaffold_cad.io._attributes import position_in, radius_in
from scaffold_cad.io._nodes import NamedGraph
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import line_error, read_text
from scaffold_cad.io.register import register_reader

DEEPEST = 32
"""How deep lists may be nested."""

_TOKEN = re.compile(r'"[^"]*"|\[|\]|[^\s\[\]"]+')
_GRAPH = re.compile(rb"^\s*graph\s*\[|\n\s*graph\s*\[|^\s*graph\s*[\r\n]+\s*\[", re.IGNORECASE)


def _recognizes(head: bytes) -> bool:
    return b"\0" not in head and bool(_GRAPH.search(head))


@register_reader("GML", ".gml", recognizes=_recognizes)
def read_gml(path: Path) -> RawSkeleton:
    """Read nodes and edges; names of attributes may differ in case.

    A node's position is in ``x``, ``y`` and ``z``, in ``graphics`` too, or in ``pos`` or
    ``position`` as a text or as one number after the other; its radius, and that of an edge, in
    ``radius``, ``diameter`` or ``area``. Lengths are taken as mm.
    """
    document = _parsed(path, read_text(path))
    found = [value for key, value in document if key == "graph" and isinstance(value, list)]
    if not found:
        raise FormatError(f"{path} has no graph [ ... ]; need one")
    graph = NamedGraph(path)
    for key, value in found[0]:
        if key == "node" and isinstance(value, list):
            values = _values(value)
            place = position_in(values) or position_in(_nested(values, "graphics"))
            if place is None:
                raise FormatError(f"{path} has no position of node {values.get('id')!r:.80}")
            graph.add_node(str(values.get("id")), place, radius_in(values))
    for key, value in found[0]:
        if key == "edge" and isinstance(value, list):
            values = _values(value)
            ends = (str(values.get("source")), str(values.get("target")))
            graph.add_edge(*ends, radius_in(values))
    return graph.skeleton()


def _values(rows: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the values of a list by key; those of a key that comes again are a list."""
    values: dict[str, Any] = {}
    repeated: dict[str, list[Any]] = {}
    for key, value in rows:
        repeated.setdefault(key, []).append(value)
    for key, several in repeated.items():
        values[key] = several[0] if len(several) == 1 else several
    return values


def _nested(values: dict[str, Any], key: str) -> dict[str, Any]:
    """Return the values of the list of a key; none where it has another value, or several."""
    rows = values.get(key)
    single = isinstance(rows, list) and all(isinstance(row, tuple) for row in rows)
    return _values(rows) if single else {}  # type: ignore[arg-type]  # rows of a list


def _parsed(path: Path, text: str) -> list[tuple[str, Any]]:
    """Return the keys and values of a file; a list is a list of them."""
    stack: list[list[tuple[str, Any]]] = [[]]
    key: str | None = None
    for line, row in enumerate(text.split("\n"), start=1):
        if row.lstrip().startswith("#"):
            continue
        for word in _TOKEN.findall(row):
            if word == "]":
                if len(stack) == 1 or key is not None:
                    raise line_error(path, line, "']'", "a key and its value before it")
                stack.pop()
            elif key is None:
                key = word.lower()
            elif word == "[":
                inner: list[tuple[str, Any]] = []
                stack[-1].append((key, inner))
                stack.append(inner)
                key = None
                if len(stack) > DEEPEST:
                    raise line_error(path, line, f"lists nested {DEEPEST} deep", "fewer")
            else:
                stack[-1].append((key, word.strip('"')))
                key = None
    if len(stack) != 1:
        raise FormatError(f"{path} ends within a list; need the whole file")
    return stack[0]
