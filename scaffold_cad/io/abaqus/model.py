"""What an Abaqus input file says: its keywords, parts, sets, and where parts stand."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.vectors import normalize
from scaffold_cad.io._nodes import radius_of_area
from scaffold_cad.io._text import as_count, line_error, read_text

BEAMS = ("B2", "B3", "PIPE", "T2D", "T3D", "FRAME", "U1")
"""Beginnings of the types of elements that are struts; U1 is CalculiX's own beam."""

GENERATING = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY")
"""Keywords that make nodes and elements of others."""

_NODE = "a node: number, x, y, z"
_ELEMENT = "an element: number, then its nodes"

_log = logging.getLogger(__name__)


@dataclass
class Block:
    """A keyword with its parameters and its lines of data."""

    line: int
    keyword: str
    options: dict[str, str]
    rows: list[tuple[int, list[str]]] = field(default_factory=list)


@dataclass
class Part:
    """Nodes and struts that count for themselves."""

    nodes: dict[int, tuple[int, list[float]]] = field(default_factory=dict)
    """Line and place of each node."""
    struts: dict[int, tuple[int, list[int]]] = field(default_factory=dict)
    """Line and nodes of each strut."""
    sets: dict[str, list[int]] = field(default_factory=dict)
    """Elements of each set."""
    sections: list[tuple[str, float]] = field(default_factory=list)
    """Name of a set of elements, and the radius of its section."""
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    """Nodes of each set."""

    def radii(self) -> dict[int, float]:
        """Return the radius of struts that have a section."""
        return {
            element: radius for name, radius in self.sections for element in self.sets.get(name, [])
        }


@dataclass
class Model:
    """Parts, where they stand, and what holds and loads them."""

    parts: dict[str, Part] = field(default_factory=lambda: {"": Part()})
    """By name, "" for what is in none."""
    instances: list[tuple[str, str, Floats]] = field(
        default_factory=lambda: [("", "", np.eye(4, 3))]
    )
    """Name, part, and transform, shape (4, 3)."""
    sets: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    """Nodes of the sets of an assembly, by instance."""
    conditions: list[Block] = field(default_factory=list)
    """Supports and loads up to the end of the first step."""

    def instance(self, name: str) -> int | None:
        """Return the number of the instance of this name."""
        names = [one for one, _, _ in self.instances]
        return names.index(name) if name in names else None


def model_of(path: Path) -> Model:
    """Return what a file holds, up to the end of its first step."""
    model, inside = Model(), ""
    for block in _blocks(path):
        if block.keyword == "PART":
            inside = block.options.get("NAME", "").upper()
            model.parts[inside] = Part()
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


def _take_assembly_set(path: Path, block: Block, model: Model) -> None:
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
                number = as_count(word)
                if number is None:
                    found += nodes_named(path, line, word, model)
                else:
                    found.append((instance, number))
    model.sets[name] = [*dict.fromkeys([*model.sets.get(name, []), *found])]


def nodes_named(path: Path, line: int, word: str, model: Model) -> list[tuple[int, int]]:
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
    return [(number, int(numbers_of(path, line, [inner], "a node or a set")[0]))]


def _take(path: Path, block: Block, part: Part) -> None:
    """Put what a block says into the part that it belongs to."""
    options = block.options
    if block.keyword == "INCLUDE" or "INPUT" in options:
        _log.warning("%s, line %d: the file included is not read", path, block.line)
    if block.keyword in GENERATING:
        need = "nodes and elements that are written out"
        raise line_error(path, block.line, f"*{block.keyword}", need)
    turned = block.keyword == "NODE" and options.get("SYSTEM", "R").upper() != "R"
    if turned or (block.keyword == "SYSTEM" and block.rows):
        found = "nodes in a coordinate system of their own"
        raise line_error(path, block.line, found, "the global one")
    if block.keyword == "TRANSFORM":
        told = "supports and loads are taken in the global coordinate system"
        _log.warning("%s, line %d: %s", path, block.line, told)
    if block.keyword == "NODE":
        for line, words in block.rows:
            if len(words) < 3 or not words[0]:
                raise line_error(path, line, f"{', '.join(words)!r} is too short", _NODE)
            numbers = numbers_of(path, line, [words[0], *(w or "0" for w in words[1:4])], _NODE)
            part.nodes[int(numbers[0])] = (line, numbers[1:])
            part.node_sets.setdefault(options.get("NSET", "").upper(), []).append(int(numbers[0]))
    elif block.keyword == "ELEMENT":
        _take_elements(path, block, part)
    elif block.keyword == "ELSET":
        _take_set(path, block, part, part.sets)
    elif block.keyword == "NSET":
        _take_set(path, block, part, part.node_sets)
    elif block.keyword in ("BEAMSECTION", "BEAMGENERALSECTION", "SOLIDSECTION", "FRAMESECTION"):
        part.sections.append((options.get("ELSET", "").upper(), _radius(path, block)))


def _take_set(path: Path, block: Block, part: Part, known: dict[str, list[int]]) -> None:
    """Add the members of a set to it, each once: sets may name each other again and again."""
    name = block.options.get(block.keyword, "").upper()
    known[name] = [*dict.fromkeys([*known.get(name, []), *_members(path, block, part, known)])]


def _take_elements(path: Path, block: Block, part: Part) -> None:
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
        numbers = [int(number) for number in numbers_of(path, line, words, _ELEMENT)]
        part.sets.setdefault(name, []).append(numbers[0])
        if not kind.startswith(BEAMS):
            continue
        if len(numbers) < 3:
            raise line_error(path, line, f"{', '.join(words)!r} is too short", _ELEMENT)
        # A third node is the middle, which comes second; beams in a plane may name a direction.
        count = 3 if kind.startswith(("B22", "B32", "PIPE22", "PIPE32", "T2D3", "T3D3")) else 2
        part.struts[numbers[0]] = (line, numbers[1 : 1 + count])


def _members(path: Path, block: Block, part: Part, known: dict[str, list[int]]) -> Iterator[int]:
    """Yield the members of a set: numbers, names of known sets, or first, last and step."""
    for line, words in block.rows:
        if "GENERATE" in block.options:
            numbers = [int(number) for number in numbers_of(path, line, words, "first, last, step")]
            first, last, step = [*numbers, 1, 1][:3] if len(numbers) > 1 else (0, -1, 1)
            if step < 1 or (last - first) // step > len(part.struts) + len(part.nodes) + 10**6:
                raise line_error(path, line, f"{', '.join(words)!r}", "a range of numbers")
            yield from range(first, last + 1, step)
            continue
        for word in filter(None, words):
            if word.upper() in known:
                yield from known[word.upper()]
            else:
                yield int(numbers_of(path, line, [word], "numbers")[0])


def _radius(path: Path, block: Block) -> float:
    """Return the radius of a section, NaN where it has none that is known."""
    if not block.rows:
        return math.nan
    line, words = block.rows[0]
    values = numbers_of(path, line, [w for w in words if w], "sizes of a section")
    if not values:
        return math.nan
    if block.keyword != "BEAMSECTION":
        return radius_of_area(values[0])
    kind = block.options.get("SECTION", "").upper()
    if kind == "CIRC" and len(values) > 1:  # CalculiX: its widths, not its radius
        return math.copysign(math.sqrt(abs(values[0] * values[1])) / 2, min(values[:2]))
    if kind in ("CIRC", "PIPE", "THICKPIPE"):
        return values[0]
    if kind in ("RECT", "BOX") and len(values) > 1:
        return radius_of_area(values[0] * values[1])
    _log.warning("%s, line %d: a section %s has no known radius", path, block.line, kind)
    return math.nan


def _placement(path: Path, block: Block) -> Floats:
    """Return the transform of an instance, shape (4, 3): it is moved, then turned."""
    matrix = np.eye(4, 3)
    for (line, words), count in zip(block.rows, (3, 7), strict=False):
        values = numbers_of(path, line, [word for word in words if word], "where an instance is")
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


def _blocks(path: Path) -> Iterator[Block]:
    """Yield the keywords of a file, in order, each with its data."""
    block: Block | None = None
    more = False
    for line, text in enumerate(read_text(path).split("\n"), start=1):
        text = text.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*"):
            if block is not None:
                yield block
            keyword, _, options = text[1:].partition(",")
            block = Block(line, keyword.upper().replace(" ", ""), _options(options))
            more = text.endswith(",")
        elif block is not None and more:  # parameters go on after a comma
            block.options |= _options(text)
            more = text.endswith(",")
        elif block is not None:
            block.rows.append((line, [word.strip() for word in text.split(",")]))
    if block is not None:
        yield block


def _options(text: str) -> dict[str, str]:
    """Return parameters between commas by their names."""
    named = [option.partition("=") for option in text.split(",")]
    return {name.strip().upper(): value.strip().strip('"') for name, _, value in named}


def numbers_of(path: Path, line: int, words: list[str], need: str) -> list[float]:
    """Return the words that are not empty as numbers, of which there must be one."""
    try:
        values = [float(word) for word in words if word]
    except ValueError:
        raise line_error(path, line, f"{', '.join(words)!r} holds no numbers", need) from None
    if not values or not all(abs(value) < 1e15 for value in values):
        raise line_error(path, line, f"{', '.join(words)!r}", need)
    return values
