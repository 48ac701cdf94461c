"""Text of BREP files, looked at before OCCT reads it: of damaged records it never ends reading."""

from __future__ import annotations

import re
from pathlib import Path

from scaffold_cad.errors import FormatError

SHAPE = re.compile(rb"[+-]\d+ \d+")
"""The last line of a file: a shape and where it is."""

RECORDS = re.compile(rb"^TShapes (\d{1,12})\s", re.MULTILINE)
"""The line that begins the records of shapes, and how many there are."""

KINDS = frozenset({b"Ve", b"Ed", b"Wi", b"Fa", b"Sh", b"So", b"CS", b"Co"})
"""First words of records: vertex, edge, wire, face, shell, solid, compound solid and compound."""

STRANGE = re.compile(
    rb"(?<!\S)(?!(?:[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?:C[0-3N]|G[12])?"
    rb"|\*|[A-Z][a-zS]|C[0-3N]|G[12])(?!\S))\S+"
)
"""A word in these records that is no number, kind, continuity (OCCT also writes it right behind a
number) or end of a record: from there on, OCCT takes no word any more."""


def check_brep_file(path: Path) -> None:
    """Raise unless the records of shapes in a BREP file are whole.

    Raises
    ------
    FormatError
        If the file is cut short, or a record has no kind of shape or a word that is no number.
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
    for number, record in enumerate(records, start=1):
        if not KINDS.intersection(record.split(None, 1)[:1]):
            raise FormatError(
                f"{path} cannot be read: record {number} of its shapes is damaged; need a sound "
                "file"
            )
    strange = STRANGE.search(content, begin.end())
    if strange:
        line = content.count(b"\n", 0, strange.start()) + 1
        word = strange[0][:30].decode("ascii", errors="replace")
        raise FormatError(
            f"{path} cannot be read: line {line} has {word!r} in a record of a shape; need a number"
        )
