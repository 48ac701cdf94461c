"""SVG drawings: the outlines of their paths and shapes, through svgelements."""

from __future__ import annotations

import re
from collections import Counter
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, tostring

import numpy as np

from scaffold_cad.base.arrays import LARGEST_COORDINATE, Floats, Points
from scaffold_cad.base.backends import need
from scaffold_cad.base.summaries import counted
from scaffold_cad.errors import FormatError
from scaffold_cad.io._curves import flattened
from scaffold_cad.io._raw import RawSkeleton, joined_polylines
from scaffold_cad.io._text import check_size, is_number
from scaffold_cad.io._units import length_of
from scaffold_cad.io._xml import xml_root
from scaffold_cad.io.register import register_reader

LARGEST_SVG = 2**26
"""Most bytes of a drawing: svgelements makes an object of each piece of a path."""

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
LENGTH = re.compile(rf"\s*(?:{NUMBER}\s*(?:[a-zA-Z]*|%)|auto|none)?\s*")
GAP = r"[\s,]*"
PATH_PIECES = re.compile(rf"{NUMBER}|[MmZzLlHhVvCcSsQqTtAa]|[\s,]+")
"""What path data are made of."""
COMMAND = re.compile(r"([MmLlTtHhVvSsQqCcAa])([^MmZzLlHhVvCcSsQqTtAa]*)")
"""A command of path data and its numbers."""
ARC = "".join(
    "[01]" + GAP if name == "flag" else rf"(?=(?P<{name}>{NUMBER}))(?P={name}){GAP}"
    for name in ("rx", "ry", "turn", "flag", "flag", "x", "y")
)
ARCS = re.compile(rf"(?:{ARC})+")
"""The numbers of arcs: flags may be one word with what follows.

A number is found by looking ahead and then repeated, so that none is tried in parts.
"""
OF_COMMAND = {"H": 1, "V": 1, "M": 2, "L": 2, "T": 2, "S": 4, "Q": 4, "C": 6}
"""How many numbers are a point or a piece, by command."""

SHAPES = {
    "path": (),
    "polyline": (),
    "polygon": (),
    "line": ("x1", "y1", "x2", "y2"),
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
}
"""The lengths of shapes; svgelements leaves out what it cannot read, or takes it as 0."""

PIXELS_PER_INCH = 25.4
"""So that a pixel is a millimeter: lengths without a unit are taken as mm."""


def _recognizes(head: bytes) -> bool:
    return b"<svg" in head and b"\0" not in head


@register_reader("SVG", ".svg", recognizes=_recognizes)
def read_svg(path: Path) -> RawSkeleton:
    """Read the outlines of paths, lines, polygons, circles and the like, which have no radii.

    They lie in the plane z = 0 with y upwards, and join where they have equal points; curves
    become edges within 1/1000 of their size. Transforms and the units of ``width`` and ``viewBox``
    are heeded; lengths without a unit are taken as mm. Text and pictures are left out.
    """
    need("svgelements", "an SVG file")
    check_size(path, LARGEST_SVG)
    data = path.read_bytes()
    # Document types and entities, which svgelements would follow, are refused.
    root = xml_root(path, data)
    _check_numbers(path, root)
    for side in ("width", "height"):  # its millimeters are short by 5e-7
        _make_plain(root, side)
    data = tostring(root)
    import svgelements

    try:
        drawing = svgelements.SVG.parse(BytesIO(data), ppi=PIXELS_PER_INCH, reify=True)
        lines = [
            line
            for element in drawing.elements()
            if isinstance(element, svgelements.Shape)
            for line in _polylines(svgelements.Path(element), svgelements)
        ]
    except (OSError, MemoryError):
        raise
    except Exception as error:  # of the many things that svgelements raises
        raise FormatError(f"{path} is not a sound drawing: {error!r:.200}; need one") from None
    if not lines:
        raise FormatError(f"{path} has no outlines; need paths, lines or shapes")
    return joined_polylines(lines)


def _check_numbers(path: Path, root: Element) -> None:
    """Check that the shapes of a drawing are given in numbers, as many as they take.

    Raises
    ------
    FormatError
        If there is another word, or a number is missing; it is named, and its shape.
    """
    counts: Counter[str] = Counter()
    for element in root.iter():
        tag = str(element.tag).rpartition("}")[2]
        if tag not in SHAPES:
            continue
        counts[tag] += 1
        where = f"{path}, {tag} {element.get('id', str(counts[tag]))[:80]},"
        rest = "" if SHAPES[tag] else element.get("d" if tag == "path" else "points", "")
        rest = "" if rest.strip() == "none" else rest
        bad = PATH_PIECES.sub(" ", rest).split()
        words = [element.get(name, "") for name in SHAPES[tag]]
        bad += [word for word in words if not LENGTH.fullmatch(word)]
        if bad:
            raise FormatError(f"{where} has {bad[0][:80]!r}; need numbers")
        if tag == "path":
            _check_path(where, rest)
            element.set("d", rest)  # svgelements takes no None
        elif rest:
            _check_count(where, "", rest, 2)


def _check_path(where: str, data: str) -> None:
    """Check that path data begin at a point, and that each command has numbers for whole pieces.

    Raises
    ------
    FormatError
        If not; svgelements leaves such pieces out. `where` names the shape.
    """
    if data.strip() and data.strip()[0] not in "Mm":
        raise FormatError(f"{where} begins with {data.strip()[:80]!r}; need M and a point")
    for command, numbers in COMMAND.findall(data):
        if command not in "Aa":
            _check_count(where, command, numbers, OF_COMMAND[command.upper()])
        elif not ARCS.fullmatch(numbers.strip()):
            shown = f"{command}{numbers}".strip()[:80]
            raise FormatError(
                f"{where} has {shown!r}; need seven numbers an arc, two of them 0 or 1"
            )


def _check_count(where: str, command: str, numbers: str, each: int) -> None:
    """Check that there are numbers for whole points or pieces.

    Raises
    ------
    FormatError
        If there are more or fewer.
    """
    count = len(re.findall(NUMBER, numbers))
    if count == 0 or count % each:
        shown = f"{command}{numbers}".strip()[:80]
        raise FormatError(
            f"{where} has {shown!r}, of {counted(count, 'number')}; need a multiple of {each}"
        )


def _make_plain(root: Element, name: str) -> None:
    """Replace a length with a unit by its millimeters."""
    found = re.fullmatch(r"\s*([-+.\deE]+?)\s*([a-zA-Z]+)\s*", root.get(name, ""))
    unit = length_of(found[2]) if found else None
    if found and unit is not None and is_number(found[1]):
        root.set(name, repr(float(found[1]) * unit))


def _polylines(outline: Any, svgelements: Any) -> list[Points]:
    """Return the points of each part of an outline, shape (k, 3), mm."""
    lines: list[list[Points]] = []
    for piece in outline:
        if isinstance(piece, svgelements.Move):
            lines.append([])
        elif piece.start is not None and piece.end is not None and piece.start != piece.end:
            if not lines:
                lines.append([])
            lines[-1].append(_points(piece, isinstance(piece, svgelements.Linear)))
    found = [np.concatenate([np.zeros((0, 3)), *line]) for line in lines]
    for points in found:
        if not (np.abs(points) <= LARGEST_COORDINATE).all():
            raise ValueError(f"an outline reaches beyond {LARGEST_COORDINATE:g} mm")
    return [points for points in map(_without_repeats, found) if len(points) > 1]


def _without_repeats(points: Points) -> Points:
    """Return points without those that equal the one before them."""
    kept: Points = points[np.append(True, (points[1:] != points[:-1]).any(axis=1))[: len(points)]]
    return kept


def _points(piece: Any, straight: bool) -> Points:
    """Return points along a piece of a path, shape (k, 3)."""

    def curve(parameters: Floats) -> Points:
        places = np.array([(point.x, -point.y, 0.0) for point in map(piece.point, parameters)])
        # The ends are those of its neighbors, to the last bit.
        places[0] = piece.start.x, -piece.start.y, 0.0
        places[-1] = piece.end.x, -piece.end.y, 0.0
        return places + 0.0  # no negative zeros

    return curve(np.array([0.0, 1.0])) if straight else flattened(curve)
