"""Nastran bulk data (.bdf, .nas): bars, beams, rods and tubes with their sections."""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from scaffold_cad.errors import FormatError
from scaffold_cad.io._nodes import NamedGraph, radius_of_area
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import as_count, line_error, read_text
from scaffold_cad.io.register import register_reader

Card: TypeAlias = tuple[int, list[str]]
"""Number of the first line of an entry, and its fields, the name first."""

STRUTS = {"CBAR": 3, "CBEAM": 3, "CBEND": 3, "CROD": 3, "CTUBE": 3, "CONROD": 2}
"""Entries of struts, and the field of their first node."""

_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")
"""An exponent without its E, as in 7.-3."""

_SELECTION = re.compile(r"\s*(SPC|LOAD)\s*=\s*([0-9]+)\s*$", re.IGNORECASE)
"""A set of supports or loads that the case control selects."""

MOST_THRU = 10**6
"""Most nodes that an entry names by its first and last one."""

_CARD = re.compile(rb"^(GRID|CBAR|CBEAM|CROD|CONROD|CTUBE)[\s*,]", re.MULTILINE)

_log = logging.getLogger(__name__)


def _recognizes(head: bytes) -> bool:
    return b"\0" not in head and bool(_CARD.search(head.upper().replace(b"\r", b"\n")))


@register_reader("Nastran bulk data", ".bdf", ".nas", ".dat", recognizes=_recognizes)
def read_nastran(path: Path) -> RawSkeleton:
    """Read bars, beams, rods and tubes, in fields of 8 or 16 characters or between commas.

    The radius of a member is that of its rod or tube, or of the circle of its section's area.
    Lengths are taken as mm, forces as N. Positions must be in the basic coordinate system.
    Supports (SPC, SPC1, those of GRID) and loads (FORCE, MOMENT) are kept: those that the case
    control selects first, or all if it selects none.
    """
    cards = _cards(path)
    radii = _radii(path, cards)
    graph = NamedGraph(path)
    for line, fields in cards:
        if fields[0] in ("GRID", "GRDSET") and _whole(path, line, fields, 2, 0) != 0:
            found = f"a node in the coordinate system {fields[2]}"
            raise line_error(path, line, found, "the basic one, 0")
        if fields[0].startswith("INCLUDE"):
            _log.warning("%s, line %d: the file included is not read", path, line)
        if fields[0] == "GRID":
            point = [_number(path, line, fields, k, 0.0) for k in (3, 4, 5)]
            graph.add_node(_whole(path, line, fields, 1), point, where=f"line {line}")
    for line, fields in cards:
        if fields[0] in STRUTS:
            first = STRUTS[fields[0]]
            ends = [_whole(path, line, fields, first + k) for k in (0, 1)]
            if fields[0] == "CONROD":
                radius = radius_of_area(_number(path, line, fields, 5, 0.0))
            else:
                of = _whole(path, line, fields, 2, _whole(path, line, fields, 1))
                radius = radii.get(of, math.nan)
            graph.add_edge(ends[0], ends[1], radius, f"line {line}")
    if not len(graph):
        raise FormatError(f"{path} has no GRID; need nodes")
    _add_loading(path, cards, graph)
    return graph.skeleton()


def _add_loading(path: Path, cards: list[Card], graph: NamedGraph) -> None:
    """Add the supports and loads that count to their nodes."""
    supports, factors = _selected(path, cards)
    for line, fields in cards:
        name, where = fields[0], f"line {line}"
        if name == "GRID":
            freedoms = _freedoms(path, line, fields, 7)
            graph.hold(_whole(path, line, fields, 1), freedoms, where=where)
        elif name == "SPC" and (supports is None or _whole(path, line, fields, 1) in supports):
            for k in (2, 5):
                if _field(fields, k):
                    value = _number(path, line, fields, k + 2, 0.0)
                    freedoms = _freedoms(path, line, fields, k + 1)
                    graph.hold(_whole(path, line, fields, k), freedoms, value, where)
        elif name == "SPC1" and (supports is None or _whole(path, line, fields, 1) in supports):
            for node in _listed(path, line, fields, 3):
                graph.hold(node, _freedoms(path, line, fields, 2), where=where)
        elif name in ("FORCE", "MOMENT"):
            number = _whole(path, line, fields, 1)
            factor = 1.0 if factors is None else factors.get(number, 0.0)
            if factor == 0.0:
                continue
            if _whole(path, line, fields, 3, 0) != 0:
                raise line_error(path, line, f"a {name} in the system {fields[3]}", "the basic one")
            size = factor * _number(path, line, fields, 4, 0.0)
            for axis in range(3):
                part = size * _number(path, line, fields, 5 + axis, 0.0)
                if part:
                    freedom = axis + (3 if name == "MOMENT" else 0)
                    graph.pull(_whole(path, line, fields, 2), freedom, part, where)


def _selected(path: Path, cards: list[Card]) -> tuple[set[int] | None, dict[int, float] | None]:
    """Return the sets of supports that count, and those of loads with their factors.

    None stands for all, where the case control selects none.
    """
    chosen: dict[str, int] = {}
    for text in read_text(path).split("\n"):
        if text.strip().upper().startswith("BEGIN"):
            break
        found = _SELECTION.match(text)
        number = as_count(found[2]) if found else None
        if found and number is not None:
            chosen.setdefault(found[1].upper(), number)
    else:  # no case control
        chosen = {}
    supports = {chosen["SPC"]} if "SPC" in chosen else None
    factors = {chosen["LOAD"]: 1.0} if "LOAD" in chosen else None
    for line, fields in cards:
        if fields[0] not in ("SPCADD", "LOAD"):
            continue
        number = _whole(path, line, fields, 1)
        if fields[0] == "SPCADD" and supports == {number}:
            supports = set(_listed(path, line, fields, 2))
        elif fields[0] == "LOAD" and factors == {number: 1.0}:
            whole = _number(path, line, fields, 2, 1.0)
            pairs = [k for k in range(3, len(fields) - 1, 2) if _field(fields, k + 1)]
            factors = {
                _whole(path, line, fields, k + 1): whole * _number(path, line, fields, k, 1.0)
                for k in pairs
            }
    return supports, factors


def _freedoms(path: Path, line: int, fields: list[str], k: int) -> list[int]:
    """Return the freedoms 0..5 that a field names by digits 1..6."""
    text = _field(fields, k)
    if set(text) <= set("0123456"):
        return [int(digit) - 1 for digit in text if digit != "0"]
    raise line_error(path, line, f"field {k + 1} is {text!r}", "freedoms such as 123")


def _listed(path: Path, line: int, fields: list[str], first: int) -> list[int]:
    """Return the numbers from a field on, or those from one THRU another."""
    if _field(fields, first + 1).upper() == "THRU":
        last = _whole(path, line, fields, first + 2)
        begin = _whole(path, line, fields, first)
        if last - begin > MOST_THRU:
            raise line_error(path, line, f"nodes {begin} to {last}", f"{MOST_THRU} at most")
        return list(range(begin, last + 1))
    places = [k for k in range(first, len(fields)) if _field(fields, k)]
    return [_whole(path, line, fields, k) for k in places]


def _radii(path: Path, cards: list[Card]) -> dict[int, float]:
    """Return the radius of each property of struts."""
    radii = {}
    for line, fields in cards:
        name = fields[0]
        if name in ("PBAR", "PROD", "PBEAM"):
            radius = radius_of_area(_number(path, line, fields, 3, 0.0))
        elif name == "PTUBE":
            radius = _number(path, line, fields, 3, 0.0) / 2
        elif name in ("PBARL", "PBEAML"):
            radius = _radius_of_shape(path, line, fields)
        else:
            continue
        radii[_whole(path, line, fields, 1)] = radius
    return radii


def _radius_of_shape(path: Path, line: int, fields: list[str]) -> float:
    """Return the radius of a section that is named: its sizes begin in the second line."""
    kind = _field(fields, 4).upper()
    sizes = [_number(path, line, fields, k, 0.0) for k in (9, 10)]
    if kind in ("ROD", "TUBE", "TUBE2"):
        return sizes[0]
    if kind in ("BAR", "BOX"):
        return radius_of_area(sizes[0] * sizes[1])
    _log.warning("%s, line %d: a section %s has no known radius", path, line, kind)
    return math.nan


def _cards(path: Path) -> list[Card]:
    """Return the entries of the bulk data, those over several lines joined."""
    cards: list[Card] = []
    lines = read_text(path).split("\n")
    whole = any(text.strip().upper().startswith("ENDDATA") for text in lines)
    begin = [k for k, text in enumerate(lines) if text.strip().upper().startswith("BEGIN")]
    for line, text in enumerate(lines[begin[0] + 1 :] if begin else lines, 1 + sum(begin[:1], 0)):
        text = text.partition("$")[0].rstrip()
        if not text.strip():
            continue
        if text.strip().upper().startswith("ENDDATA"):
            break
        fields = _fields(text)
        name = fields[0].upper()
        if not name or name[0] in "+*":
            if cards:
                cards[-1][1].extend(fields[1:])
            continue
        cards.append((line + (1 if begin else 0), [name.rstrip("*"), *fields[1:]]))
    if begin and not whole:
        raise FormatError(f"{path} does not end with ENDDATA: need the whole file")
    return cards


def _fields(text: str) -> list[str]:
    """Return the fields of a line, 8 or 4 wide ones, without the mark of its continuation."""
    text = text if "," in text else text.expandtabs(8)
    first = text.partition(",")[0] if "," in text else text[:8]
    width, count = (16, 4) if "*" in first else (8, 8)
    if "," in text:
        fields = [field.strip() for field in text.split(",")][: count + 1]
        return [*fields, *[""] * (count + 1 - len(fields))]
    starts = [8 + width * k for k in range(count)]
    return [first.strip(), *(text[at : at + width].strip() for at in starts)]


def _field(fields: Sequence[str], k: int) -> str:
    return fields[k].strip() if k < len(fields) else ""


def _number(path: Path, line: int, fields: list[str], k: int, default: float) -> float:
    text = _field(fields, k)
    if not text:
        return default
    plain = text.upper().replace("D", "E")
    try:
        return float(plain if "E" in plain else _EXPONENT.sub(r"E\1", plain))
    except ValueError:
        raise line_error(path, line, f"field {k + 1} is {text!r}", "a number") from None


def _whole(path: Path, line: int, fields: list[str], k: int, default: int | None = None) -> int:
    text = _field(fields, k)
    if not text and default is not None:
        return default
    try:
        return int(text)
    except ValueError:
        raise line_error(path, line, f"field {k + 1} is {text!r}", "a whole number") from None
