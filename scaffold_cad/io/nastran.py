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
from scaffold_cad.io._text import line_error, read_text
from scaffold_cad.io.register import register_reader

Card: TypeAlias = tuple[int, list[str]]
"""Number of the first line of an entry, and its fields, the name first."""

STRUTS = {"CBAR": 3, "CBEAM": 3, "CBEND": 3, "CROD": 3, "CTUBE": 3, "CONROD": 2}
"""Entries of struts, and the field of their first node."""

_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")
"""An exponent without its E, as in 7.-3."""

_CARD = re.compile(rb"^(GRID|CBAR|CBEAM|CROD|CONROD|CTUBE)[\s*,]", re.MULTILINE)

_log = logging.getLogger(__name__)


def _recognises(head: bytes) -> bool:
    return b"\0" not in head and bool(_CARD.search(head.upper().replace(b"\r", b"\n")))


@register_reader("Nastran bulk data", ".bdf", ".nas", ".dat", recognises=_recognises)
def read_nastran(path: Path) -> RawSkeleton:
    """Read bars, beams, rods and tubes, in fields of 8 or 16 characters or between commas.

    The radius of a member is that of its rod or tube, or of the circle of its section's area.
    Lengths are taken as mm. Positions must be in the basic coordinate system.
    """
    cards = _cards(path)
    radii = _radii(path, cards)
    graph = NamedGraph(path)
    for line, fields in cards:
        if fields[0] == "GRID":
            if _whole(path, line, fields, 2, 0) != 0:
                found = f"a node in the coordinate system {fields[2]}"
                raise line_error(path, line, found, "the basic one, 0")
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
    return graph.skeleton()


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
    _log.warning("%s, line %d: a section %s has no radius that is known", path, line, kind)
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
        name = fields[0].strip().rstrip("*").upper()
        if not name or name.startswith("+"):
            if cards:
                cards[-1][1].extend(fields[1:])
            continue
        cards.append((line + (1 if begin else 0), [name, *fields[1:]]))
    if begin and not whole:
        raise FormatError(f"{path} does not end with ENDDATA: need the whole file")
    return cards


def _fields(text: str) -> list[str]:
    """Return the fields of a line without the mark of its continuation."""
    if "," in text:
        fields = [field.strip() for field in text.split(",")]
        return [*fields[:9], *[""] * (9 - len(fields))]
    text = text.expandtabs(8)
    wide = text[:8].rstrip().endswith("*")
    width, count = (16, 4) if wide else (8, 8)
    starts = [8 + width * k for k in range(count)]
    return [text[:8], *(text[at : at + width].strip() for at in starts)]


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
