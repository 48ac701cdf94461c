"""Text of BREP files, looked at before OCCT reads it: of damaged records it never ends reading."""

from __future__ import annotations

import re
from pathlib import Path

from scaffold_cad.errors import FormatError

SHAPE = re.compile(rb"[+-]\d+ \d+")
"""The last line of a file: a shape and where it is."""

RECORDS = re.compile(rb"^TShapes (\d{1,12})\s", re.MULTILINE)
"""The line that begins the records of shapes, and how many there are."""

PLACES = re.compile(rb"^Locations \d+((?:\s+[-+\d.eE]+)*)\s+Curve2ds ", re.MULTILINE)
"""The table of places of shapes, and what follows it."""

FORMAT = re.compile(rb"CASCADE Topology V(\d)")
"""The line that names the version of the format."""

KINDS = (b"Ve", b"Ed", b"Wi", b"Fa", b"Sh", b"So", b"CS", b"Co")
"""First words of records: vertex, edge, wire, face, shell, solid, compound solid and compound."""

STRANGE = re.compile(
    rb"(?<!\S)(?!(?:[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?:C[0-3N]|G[12])?"
    rb"|\*|[A-Z][a-zS]|C[0-3N]|G[12])(?!\S))\S+"
)
"""A word in these records that is no number, kind, continuity (OCCT also writes it right behind a
number) or end of a record: from there on, OCCT takes no word any more."""


WHOLE = r"\s+[+-]?\d+(?=\s)"
REAL = r"\s+[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?=\s)"
CONTINUITY = r"\s*(?:C[0-3N]|G[12])(?=\s)"
PAIR = r"\s+\d+\s+\d+"
"""Two numbers with a continuity after them, which may stand right behind the second."""
END = r"\s+[01]{7}(?:\s+[-+ie]\d+\s+\d+)*\s*"
"""Marks of a shape, and the shapes that it is made of, each with its place."""


PLACE = re.compile(
    rf"(?:\s+1(?=\s)(?:{REAL}){{12}}|\s+2(?=\s)(?:\s+-?[1-9]\d*{WHOLE})*\s+0(?=\s))*\s*".encode()
)
"""Places: a transform, or powers of others, which 0 ends."""


def _entry(kind: int, *parts: str) -> str:
    """Return the pattern of an entry of an edge or a vertex: its kind, then its parts."""
    return rf"\s+{kind}(?=\s){''.join(parts)}"


def _records(version: bytes) -> dict[bytes, re.Pattern[bytes]]:
    """Return what the record of each kind of shape looks like in a version of the format."""
    ends = REAL * 4 if version == b"2" else ""  # of a curve, on its surface
    edge = [
        _entry(1, WHOLE * 2, REAL * 2),
        _entry(2, WHOLE * 3, REAL * 2, ends),
        _entry(3, PAIR, CONTINUITY, WHOLE * 2, REAL * 2, ends),
        _entry(4, CONTINUITY, WHOLE * 4),
        *(_entry(kind, WHOLE * count) for kind, count in ((5, 2), (6, 3), (7, 4))),
    ]
    # A vertex on a curve, on a curve of a surface, on a surface.
    points = ((1, WHOLE * 2), (2, WHOLE * 3), (3, REAL + WHOLE * 2))
    vertex = "|".join(REAL + _entry(kind, parts) for kind, parts in points)
    whole = {
        "Ve": rf"{REAL * 4}(?:{vertex})*{REAL}{_entry(0)}",
        "Ed": rf"{REAL}{WHOLE * 3}(?:{'|'.join(edge)})*{_entry(0)}",
        "Fa": rf"{WHOLE}{REAL}{WHOLE * 2}[^\S\n]*\n(?:2{WHOLE})?[^\S\n]*(?=\n)",
    }
    return {
        kind: re.compile((kind.decode() + whole.get(kind.decode(), "") + END).encode())
        for kind in KINDS
    }


def check_brep_file(path: Path) -> None:
    """Raise unless the records of shapes in a BREP file are whole.

    Raises
    ------
    FormatError
        If the file is cut short, or a record has no kind of shape, a word that is no number, or
        other numbers than shapes of its kind have.
    """
    content = path.read_bytes().rstrip()
    if not SHAPE.fullmatch(content.rpartition(b"\n")[2].strip()):
        raise FormatError(f"{path} cannot be read: it was cut short; need the whole file")
    begin = RECORDS.search(content)
    if begin is None:
        raise FormatError(f"{path} cannot be read: it has no records of shapes; need a sound file")
    *records, _ = content[begin.end() :].split(b"*")
    if len(records) != int(begin[1]):
        raise FormatError(
            f"{path} cannot be read: it has {len(records)} records of shapes and names "
            f"{int(begin[1])}; need a sound file"
        )
    places = PLACES.search(content, 0, begin.start())
    if places is None or not PLACE.fullmatch(places[1] + b"\n"):
        raise FormatError(f"{path} cannot be read: its places are damaged; need a sound file")
    version = FORMAT.search(content, 0, begin.start())
    patterns = _records(version[1] if version else b"1")
    for number, record in enumerate(records, start=1):
        pattern = patterns.get(record.split(None, 1)[0] if record.strip() else b"")
        if pattern is None or not pattern.fullmatch(record.lstrip()):
            raise _damaged(path, content, begin.end(), number, known=pattern is not None)


def _damaged(path: Path, content: bytes, begin: int, number: int, *, known: bool) -> FormatError:
    """Return the error of a damaged record: the first strange word in all of them, or its number.

    Parameters
    ----------
    begin : of the records in the content
    known : whether the record has a kind of shape
    """
    strange = STRANGE.search(content, begin) if known else None
    if strange:
        line = content.count(b"\n", 0, strange.start()) + 1
        word = strange[0][:30].decode("ascii", errors="replace")
        return FormatError(
            f"{path} cannot be read: line {line} has {word!r} in a record of a shape; need a number"
        )
    what = "has more or fewer numbers than its shape" if known else "is damaged"
    return FormatError(
        f"{path} cannot be read: record {number} of its shapes {what}; need a sound file"
    )
