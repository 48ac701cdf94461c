"""OpenSees models (.tcl): nodes, and the elements that are struts."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from itertools import takewhile
from pathlib import Path

from scaffold_cad.errors import FormatError
from scaffold_cad.io._nodes import NamedGraph, radius_of_area
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import is_number, line_error, read_text
from scaffold_cad.io.register import register_reader

STRUTS = (
    "truss", "corottruss", "trusssection", "corottrusssection", "elasticbeamcolumn",
    "elastictimoshenkobeam", "forcebeamcolumn", "dispbeamcolumn", "nonlinearbeamcolumn",
    "beamwithhinges", "gradientinelasticbeamcolumn", "mixedbeamcolumn", "dispbeamcolumnint",
)  # fmt: skip
"""Elements between two nodes, without regard to case."""

AREA_AT = {"truss": 5, "corottruss": 5, "elasticbeamcolumn": 5, "elastictimoshenkobeam": 7}
"""Elements that name their area, and the word that it is."""

FREEDOMS = {(2, 2): (0, 1), (2, 3): (0, 1, 5), (3, 3): (0, 1, 2), (3, 6): (0, 1, 2, 3, 4, 5)}
"""Freedoms 0..5 of a node, by the numbers of dimensions and of freedoms."""

_NODE = "node, its number, and x, y, z"
_ELEMENT = "element, its kind, its number, and two nodes"

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    lines = [line.split() for line in head.decode("utf-8", errors="replace").splitlines()]
    nodes = [words for words in lines if words[:1] == ["node"]]
    return b"\0" not in head and any(len(words) >= 4 and is_number(words[1]) for words in nodes)


@register_reader("OpenSees", ".tcl", recognizes=_recognizes)
def read_opensees(path: Path) -> RawSkeleton:
    """Read the nodes and struts of a model, whose numbers must be written out or ``set`` before.

    The radius of a member is that of the circle of its area, where the element names an area.
    Lengths are taken as mm, forces as N. Loops and expressions are not worked out.
    Supports (``fix``, ``sp``) and loads are kept; nodes of a model in a plane are held in it.
    """
    graph = NamedGraph(path)
    struts: list[tuple[int, list[str]]] = []
    held: list[tuple[int, list[str]]] = []
    dimensions = 3
    for line, words in _commands(path):
        if words[0] == "node":
            place = [*takewhile(lambda word: is_number(word) or word[0] != "-", words[2:5])]
            if len(place) < 2 or not all(map(is_number, place)):
                raise line_error(path, line, f"{' '.join(words)!r}", f"{_NODE} as plain numbers")
            graph.add_node(words[1], [float(word) for word in place], where=f"line {line}")
        elif words[0] == "element" and len(words) > 1 and words[1].lower() in STRUTS:
            struts.append((line, words))
        elif words[0] == "model" and "-ndm" in words[:-1]:
            dimensions = 2 if words[words.index("-ndm") + 1] == "2" else 3
        elif words[0] in ("fix", "load", "sp"):
            held.append((line, words))
        elif words[0] in ("for", "foreach", "while", "source", "fixX", "fixY", "fixZ"):
            _log.warning("%s, line %d: '%s' is not evaluated", path, line, words[0])
    for line, words in struts:
        if len(words) < 5:
            raise line_error(path, line, f"{' '.join(words)!r}", _ELEMENT)
        radius = math.nan
        at = AREA_AT.get(words[1].lower(), len(words))
        if at < len(words) and is_number(words[at]):
            radius = radius_of_area(float(words[at]))
        graph.add_edge(words[3], words[4], radius, f"line {line}")
    if not len(graph):
        raise FormatError(f"{path} has no nodes; need {_NODE}")
    for line, words in held:
        _load(path, graph, line, words, dimensions)
    if held and dimensions == 2:
        graph.hold_in_plane()
    return graph.skeleton()


def _load(path: Path, graph: NamedGraph, line: int, words: list[str], dimensions: int) -> None:
    """Add a support or a load to its node."""
    where = f"line {line}"
    values = [float(word) for word in takewhile(is_number, words[2:])]
    if words[0] == "sp":
        freedoms = FREEDOMS[dimensions, 3 * dimensions - 3]
        if len(values) < 2 or not 1 <= values[0] <= len(freedoms):
            raise line_error(path, line, f"{' '.join(words)!r}", "sp, a node, a freedom, a number")
        graph.hold(words[1], [freedoms[int(values[0]) - 1]], values[1], where)
        return
    if (dimensions, len(values)) not in FREEDOMS:
        raise line_error(path, line, f"{' '.join(words)!r}", "a node and a number for each freedom")
    for freedom, value in zip(FREEDOMS[dimensions, len(values)], values, strict=True):
        if words[0] == "load":
            graph.pull(words[1], freedom, value, where)
        elif value:
            graph.hold(words[1], [freedom], where=where)


def _commands(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the words of each command, variables that were set put in, and its line."""
    known: dict[str, str] = {}
    text = read_text(path).replace("\\\n", " \0")  # a command goes on in the next line
    line = 0
    for row in text.split("\n"):
        line += 1
        for command in row.partition("#")[0].replace("\0", " ").split(";"):
            words = [_value(word, known) for word in command.split()]
            if words[:1] == ["pattern"] and "{" in words:
                words = words[words.index("{") + 1 :]
            words = words[: words.index("}")] if "}" in words else words
            if words[:1] == ["set"] and len(words) == 3:
                known[words[1]] = words[2]
            elif words:
                yield line, words
        line += row.count("\0")


def _value(word: str, known: dict[str, str]) -> str:
    name = word.removeprefix("$").strip("{}")
    return known.get(name, word) if word.startswith("$") else word
