"""Abaqus and CalculiX input files (.inp): beams, pipes and trusses with their sections."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import normalize
from scaffold_cad.errors import FormatError
from scaffold_cad.io._nodes import NamedGraph, radius_of_area
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import line_error, read_text
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_reader, register_writer

BEAMS = ("B2", "B3", "PIPE", "T2D", "T3D", "FRAME", "U1")
"""Beginnings of the types of elements that are struts; U1 is CalculiX's own beam."""

HELD = {
    "ENCASTRE": (0, 1, 2, 3, 4, 5), "PINNED": (0, 1, 2),
    "XSYMM": (0, 4, 5), "YSYMM": (1, 3, 5), "ZSYMM": (2, 3, 4),
    "XASYMM": (1, 2, 3), "YASYMM": (0, 2, 4), "ZASYMM": (0, 1, 5),
}  # fmt: skip
"""Freedoms 0..5 of a node that supports with names hold."""

SIGNIFICANT = 9
"""Digits to which radii are the same section when beams are written."""

_NODE = "a node: number, x, y, z"
_ELEMENT = "an element: number, then its nodes"

_log = logging.getLogger(__name__)


@dataclass
class _Block:
    """A keyword with its parameters and its lines of data."""

    line: int
    keyword: str
    options: dict[str, str]
    rows: list[tuple[int, list[str]]] = field(default_factory=list)


@dataclass
class _Part:
    """Nodes and struts that count for themselves."""

    nodes: dict[int, tuple[int, list[float]]] = field(default_factory=dict)
    """Line and place of each node."""
    struts: dict[int, tuple[int, list[int]]] = field(default_factory=dict)
    """Line and nodes of each strut."""
    sets: dict[str, list[int]] = field(default_factory=dict)
    """Elements of each set."""
    radii: dict[int, float] = field(default_factory=dict)
    """Radius of struts that have a section."""
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    """Nodes of each set."""


@dataclass
class _Model:
    """Parts, where they stand, and what holds and loads them."""

    parts: dict[str, _Part] = field(default_factory=lambda: {"": _Part()})
    """By name, "" for what is in none."""
    instances: list[tuple[str, str, Floats]] = field(
        default_factory=lambda: [("", "", np.eye(4, 3))]
    )
    """Name, part, and transform, shape (4, 3)."""
    sets: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    """Nodes of the sets of an assembly, by instance."""
    conditions: list[_Block] = field(default_factory=list)
    """Supports and loads up to the end of the first step."""

    def instance(self, name: str) -> int | None:
        """Return the number of the instance of this name."""
        names = [one for one, _, _ in self.instances]
        return names.index(name) if name in names else None


def _recognises(head: bytes) -> bool:
    upper = head.upper()
    return any(
        line.startswith((b"*NODE", b"*HEADING", b"*PART"))
        for line in upper.replace(b"\r", b"\n").split(b"\n")
    )


@register_reader("Abaqus input", ".inp", recognises=_recognises)
def read_abaqus(path: Path) -> RawSkeleton:
    """Read the beams, pipes and trusses of an Abaqus or CalculiX input file; other elements go.

    A beam with a node at its middle is two edges. The radius of a member is that of its circle or
    pipe, or of the circle of its section's area. Parts are placed by their instances. Lengths are
    taken as mm, forces as N; files that are included are not read. Supports (*BOUNDARY) and loads
    (*CLOAD) of the model and its first step are kept.
    """
    model = _model(path)
    graph = NamedGraph(path)
    for number, (_, name, matrix) in enumerate(model.instances):
        _add(graph, model.parts[name], number, matrix)
    if len(graph) and not len(graph.skeleton().edges):
        raise FormatError(f"{path} has nodes and no struts; need beams, pipes or trusses")
    for block in model.conditions:
        _add_conditions(path, graph, model, block)
    return graph.skeleton()


def _add_conditions(path: Path, graph: NamedGraph, model: _Model, block: _Block) -> None:
    """Add the supports or loads of a block to their nodes."""
    if block.options.get("TYPE", "DISPLACEMENT").upper() != "DISPLACEMENT":
        _log.warning("%s, line %d: supports with a speed are left out", path, block.line)
        return
    for line, words in block.rows:
        nodes, where = _nodes_named(path, line, words[0], model), f"line {line}"
        name = words[1].upper() if len(words) > 1 else ""
        if block.keyword == "BOUNDARY" and name in HELD:
            for node in nodes:
                graph.hold(node, HELD[name], where=where)
            continue
        is_load = block.keyword == "CLOAD"
        first, last, value = _condition(path, line, words, is_load)
        for node in nodes:
            for freedom in range(max(first, 1) - 1, min(last, 6)):
                if is_load:
                    graph.pull(node, freedom, value, where)
                else:
                    graph.hold(node, [freedom], value, where)


def _condition(path: Path, line: int, words: list[str], is_load: bool) -> tuple[int, int, float]:
    """Return the first and the last freedom, from 1, of a line of data, and its value."""
    need = "a node or a set, then freedoms 1 to 6 and a value"
    first, second, third = [*words[1:], "", "", ""][:3]
    begin = int(_numbers(path, line, [first], need)[0])
    if is_load:
        return begin, begin, _numbers(path, line, [second], need)[0]
    end = int(_numbers(path, line, [second or first], need)[0])
    return begin, end, _numbers(path, line, [third or "0"], need)[0]


def _nodes_named(path: Path, line: int, word: str, model: _Model) -> list[tuple[int, int]]:
    """Return the nodes that a word names, by instance: a set, a number, or INSTANCE.number."""
    name = word.upper().strip('"')
    if name in model.sets:
        return model.sets[name]
    before, _, inner = name.rpartition(".")
    number = model.instance(before)
    if number is None:
        raise line_error(path, line, f"nodes {word!r}", "a node, or a set that was defined before")
    known = model.parts[model.instances[number][1]].node_sets
    if inner in known:
        return [(number, node) for node in known[inner]]
    return [(number, int(_numbers(path, line, [inner], "a node or a set")[0]))]


def _add(graph: NamedGraph, part: _Part, number: int, matrix: Floats) -> None:
    """Add a part that is placed by `matrix`, shape (4, 3)."""
    for node, (line, place) in part.nodes.items():
        point = np.array([*place, 0.0, 0.0][:3]) @ matrix[:3] + matrix[3]
        graph.add_node((number, node), point.tolist(), where=f"line {line}")
    for element, (line, nodes) in part.struts.items():
        radius = part.radii.get(element, math.nan)
        for a, b in pairwise(nodes):
            graph.add_edge((number, a), (number, b), radius, f"line {line}")


def _model(path: Path) -> _Model:
    """Return what a file holds, up to the end of its first step."""
    model, inside = _Model(), ""
    for block in _blocks(path):
        if block.keyword == "PART":
            inside = block.options.get("NAME", "").upper()
            model.parts[inside] = _Part()
        elif block.keyword == "ENDPART":
            inside = ""
        elif block.keyword == "INSTANCE":
            part = block.options.get("PART", "").upper()
            if part not in model.parts:
                raise line_error(path, block.line, f"an instance of part {part!r}", "a part before")
            name = block.options.get("NAME", "").upper()
            model.instances.append((name, part, _placement(path, block)))
        elif block.keyword == "NSET" and not inside:
            _take_assembly_set(path, block, model)
        elif block.keyword in ("BOUNDARY", "CLOAD"):
            model.conditions.append(block)
        elif block.keyword == "ENDSTEP":
            break
        else:
            _take(path, block, model.parts[inside])
            if block.keyword == "NODE" and not inside:
                name = block.options.get("NSET", "").upper()
                model.sets[name] = [(0, node) for node in model.parts[""].node_sets.get(name, [])]
    return model


def _take_assembly_set(path: Path, block: _Block, model: _Model) -> None:
    """Add the nodes of a set that is in no part."""
    name = block.options.get("NSET", "").upper()
    instance = model.instance(block.options.get("INSTANCE", "").upper())
    if instance is None:
        raise line_error(path, block.line, "a set of nodes of an instance", "one defined before")
    if "GENERATE" in block.options:
        found = [(instance, node) for node in _members(path, block, model.parts[""], {})]
    else:
        found = []
        for line, words in block.rows:
            for word in filter(None, words):
                number = [(instance, int(word))] if word.isdigit() else None
                found += number or _nodes_named(path, line, word, model)
    model.sets[name] = [*dict.fromkeys([*model.sets.get(name, []), *found])]


def _take(path: Path, block: _Block, part: _Part) -> None:
    """Put what a block says into the part that it belongs to."""
    options = block.options
    if block.keyword == "NODE":
        for line, words in block.rows:
            numbers = _numbers(path, line, words[:4], _NODE)
            if len(numbers) < 3:
                raise line_error(path, line, f"{', '.join(words)!r} is too short", _NODE)
            part.nodes[int(numbers[0])] = (line, numbers[1:])
            part.node_sets.setdefault(options.get("NSET", "").upper(), []).append(int(numbers[0]))
    elif block.keyword == "ELEMENT":
        _take_elements(path, block, part)
    elif block.keyword == "ELSET":
        _take_set(path, block, part, part.sets)
    elif block.keyword == "NSET":
        _take_set(path, block, part, part.node_sets)
    elif block.keyword in ("BEAMSECTION", "BEAMGENERALSECTION", "SOLIDSECTION", "FRAMESECTION"):
        radius = _radius(path, block)
        name = options.get("ELSET", "").upper()
        chosen = part.sets.get(name, [])
        part.radii |= dict.fromkeys(chosen, radius)
    elif block.keyword == "INCLUDE":
        _log.warning("%s, line %d: the file included is not read", path, block.line)


def _take_set(path: Path, block: _Block, part: _Part, known: dict[str, list[int]]) -> None:
    """Add the members of a set to it, each once: sets may name each other again and again."""
    name = block.options.get(block.keyword, "").upper()
    known[name] = [*dict.fromkeys([*known.get(name, []), *_members(path, block, part, known)])]


def _take_elements(path: Path, block: _Block, part: _Part) -> None:
    kind = block.options.get("TYPE", "").upper()
    name = block.options.get("ELSET", "").upper()
    rows: list[tuple[int, list[str]]] = []
    more = False
    for line, words in block.rows:
        if more:
            rows[-1][1].extend(words)
        else:
            rows.append((line, [*words]))
        more = len(words) > 1 and words[-1] == ""  # a comma at the end: the list goes on
        if more:
            rows[-1][1].pop()
    for line, words in rows:
        numbers = [int(number) for number in _numbers(path, line, words, _ELEMENT)]
        part.sets.setdefault(name, []).append(numbers[0])
        if not kind.startswith(BEAMS):
            continue
        if len(numbers) < 3:
            raise line_error(path, line, f"{', '.join(words)!r} is too short", _ELEMENT)
        # A third node is the middle, which comes second; beams in a plane may name a direction.
        count = 3 if kind.startswith(("B22", "B32", "PIPE22", "PIPE32", "T2D3", "T3D3")) else 2
        part.struts[numbers[0]] = (line, numbers[1 : 1 + count])


def _members(path: Path, block: _Block, part: _Part, known: dict[str, list[int]]) -> Iterator[int]:
    """Yield the members of a set: numbers, names of known sets, or first, last and step."""
    for line, words in block.rows:
        if "GENERATE" in block.options:
            numbers = [int(number) for number in _numbers(path, line, words, "first, last, step")]
            first, last, step = [*numbers, 1, 1][:3] if len(numbers) > 1 else (0, -1, 1)
            if step < 1 or (last - first) // step > len(part.struts) + len(part.nodes) + 10**6:
                raise line_error(path, line, f"{', '.join(words)!r}", "a range of numbers")
            yield from range(first, last + 1, step)
            continue
        for word in filter(None, words):
            if word.upper() in known:
                yield from known[word.upper()]
            else:
                yield int(_numbers(path, line, [word], "numbers")[0])


def _radius(path: Path, block: _Block) -> float:
    """Return the radius of a section, NaN where it has none that is known."""
    if not block.rows:
        return math.nan
    line, words = block.rows[0]
    values = [abs(x) for x in _numbers(path, line, [w for w in words if w], "sizes of a section")]
    if not values:
        return math.nan
    if block.keyword != "BEAMSECTION":
        return radius_of_area(values[0])
    kind = block.options.get("SECTION", "").upper()
    if kind == "CIRC" and len(values) > 1:  # CalculiX: its widths, not its radius
        return math.sqrt(values[0] * values[1]) / 2
    if kind in ("CIRC", "PIPE", "THICKPIPE"):
        return values[0]
    if kind in ("RECT", "BOX") and len(values) > 1:
        return radius_of_area(values[0] * values[1])
    _log.warning("%s, line %d: a section %s has no radius that is known", path, block.line, kind)
    return math.nan


def _placement(path: Path, block: _Block) -> Floats:
    """Return the transform of an instance, shape (4, 3): it is moved, then turned."""
    matrix = np.eye(4, 3)
    for (line, words), count in zip(block.rows, (3, 7), strict=False):
        values = _numbers(path, line, [word for word in words if word], "where an instance is")
        if len(values) != count or max(map(abs, values)) > 1e12:
            raise line_error(path, line, f"{', '.join(words)!r}", f"{count} numbers")
        if count == 3:
            matrix[3] = values
            continue
        start, end = np.array(values[:3]), np.array(values[3:6])
        turn = _rotation(end - start, math.radians(values[6]))
        matrix[:3] = turn
        matrix[3] = (matrix[3] - start) @ turn + start
    return matrix


def _rotation(axis: Floats, angle: float) -> Floats:
    """Return the matrix that turns rows about `axis` by `angle`, rad, shape (3, 3)."""
    if not np.linalg.norm(axis) > 0:
        return np.eye(3)
    x, y, z = normalize(axis[None])[0]
    cross = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    turn: Floats = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turn


def _blocks(path: Path) -> Iterator[_Block]:
    """Yield the keywords of a file, in order, each with its data."""
    block: _Block | None = None
    for line, text in enumerate(read_text(path).split("\n"), start=1):
        text = text.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*"):
            if block is not None:
                yield block
            keyword, *options = text[1:].split(",")
            named = [option.partition("=") for option in options]
            block = _Block(
                line,
                keyword.upper().replace(" ", ""),
                {name.strip().upper(): value.strip().strip('"') for name, _, value in named},
            )
        elif block is not None:
            block.rows.append((line, [word.strip() for word in text.split(",")]))
    if block is not None:
        yield block


def _numbers(path: Path, line: int, words: list[str], need: str) -> list[float]:
    try:
        values = [float(word) for word in words if word]
    except ValueError:
        raise line_error(path, line, f"{', '.join(words)!r} holds no numbers", need) from None
    if not values or not all(abs(value) < 1e15 for value in values):
        raise line_error(path, line, f"{', '.join(words)!r}", need)
    return values


@register_writer(".inp", name="Abaqus input", solids=False)
def write_abaqus(content: Content, path: Path) -> None:
    """Write a Skeleton as beams B31, mm, with one circular section a radius.

    A beam has the mean of the radii of its ends: the format has no beams that taper.
    """
    skeleton = content.skeleton("an .inp file")
    radii = skeleton.edge_radii.mean(axis=1)
    rounded = np.array([float(f"{radius:.{SIGNIFICANT}g}") for radius in radii.tolist()])
    sections, section = np.unique(rounded, return_inverse=True)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"*HEADING\nscaffold_cad, unit: {content.unit}\n*NODE\n")
        rows = enumerate(skeleton.nodes.tolist(), start=1)
        file.writelines(f"{k}, {x!r}, {y!r}, {z!r}\n" for k, (x, y, z) in rows)
        for number in range(1, len(sections) + 1):
            file.write(f"*ELEMENT, TYPE=B31, ELSET=S{number}\n")
            chosen = np.flatnonzero(section == number - 1)
            pairs = (skeleton.edges[chosen] + 1).tolist()
            file.writelines(
                f"{k + 1}, {a}, {b}\n" for k, (a, b) in zip(chosen.tolist(), pairs, strict=True)
            )
        file.write("*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n")
        for number, radius in enumerate(sections.tolist(), start=1):
            file.write(f"*BEAM SECTION, ELSET=S{number}, MATERIAL=M, SECTION=CIRC\n{radius!r}\n")
