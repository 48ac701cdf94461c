"""Legacy VTK files, as text or binary: the lines of poly data and unstructured grids."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, as_count, as_indices, check_size, floats_of_words
from scaffold_cad.io.register import register_reader
from scaffold_cad.io.vtk.lines import Lines, checked, is_radii, line_cells, skeleton_of

_TYPES = {
    "unsigned_char": "u1",
    "char": "i1",
    "unsigned_short": "u2",
    "short": "i2",
    "unsigned_int": "u4",
    "int": "i4",
    "unsigned_long": "u8",
    "long": "i8",
    "vtktypeint64": "i8",
    "vtktypeint32": "i4",
    "vtkidtype": "i8",
    "float": "f4",
    "double": "f8",
}
"""Binary numbers, which are big-endian."""

_WIDTHS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6}
"""Numbers that data of these kinds have for each point."""

_WORD = re.compile(rb"\S+")

_CELLS = ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS")


def _recognizes(head: bytes) -> bool:
    return head.startswith(b"# vtk DataFile")


@register_reader("VTK", ".vtk", recognizes=_recognizes)
def read_vtk(path: Path) -> RawSkeleton:
    """Read the lines of a legacy VTK file; point data called "radius" are the radii.

    Lengths are taken as mm. Cells that are not lines are left out.
    """
    check_size(path, LARGEST_FILE)
    return _LegacyFile(path).skeleton()


class _LegacyFile:
    """A legacy file, read from its first byte to its last."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._data = path.read_bytes()
        self._at = 0
        self._points: Floats | None = None
        self._cells: dict[str, Lines] = {}
        self._types: Ints | None = None
        self._radii: Floats | None = None
        self._values_of = ("", 0)  # what attributes belong to: a keyword and how many
        for _ in range(2):
            self._line()
        self._binary = self._line().upper() == "BINARY"

    def skeleton(self) -> RawSkeleton:
        """Read all sections and return the graph."""
        while (words := self._line().split()) or self._at < len(self._data):
            if words:
                self._section(words)
        if self._points is None:
            raise FormatError(f"{self._path} has no POINTS; need them")
        if "CELLS" in self._cells:
            if self._types is None:
                raise FormatError(f"{self._path} has no CELL_TYPES; need them")
            cells = checked(self._path, self._cells["CELLS"], len(self._points))
            lines = line_cells(self._path, cells, self._types)
        elif "LINES" in self._cells:
            lines = checked(self._path, self._cells["LINES"], len(self._points))
        else:
            raise FormatError(f"{self._path} has no LINES; need them")
        return skeleton_of(self._points, lines, self._radii)

    def _section(self, words: list[str]) -> None:
        keyword = words[0].upper()
        if keyword == "DATASET":
            if self._word(words, 1).upper() not in ("POLYDATA", "UNSTRUCTURED_GRID"):
                raise self._error(words, "DATASET POLYDATA or UNSTRUCTURED_GRID")
        elif keyword == "POINTS":
            values = self._numbers(3 * self._count(words, 1), self._word(words, 2))
            self._points = as_doubles(values).reshape(-1, 3)
        elif keyword in _CELLS:
            self._cells[keyword] = self._lines(self._count(words, 1), self._count(words, 2))
        elif keyword == "CELL_TYPES":
            self._types = self._indices(self._count(words, 1), "int")
        elif keyword in ("POINT_DATA", "CELL_DATA"):
            self._values_of = (keyword, self._count(words, 1))
        elif keyword == "FIELD":
            self._field(self._count(words, 2))
        elif keyword == "METADATA":
            while self._line():  # ends with an empty line
                pass
        else:
            self._attributes(keyword, words)

    def _lines(self, first: int, second: int) -> Lines:
        """Return cells: of `first` cells and `second` numbers, or of offsets since version 5."""
        at = self._at
        words = self._line().split()
        if words[:1] != ["OFFSETS"]:
            self._at = at
            return self._counted_lines(first, self._indices(second, "int"))
        offsets = self._indices(first, self._word(words, 1))
        words = self._line().split()
        if words[:1] != ["CONNECTIVITY"]:
            raise self._error(words, "CONNECTIVITY after OFFSETS")
        connectivity = self._indices(second, self._word(words, 1))
        return Lines(connectivity, offsets[1:])

    def _counted_lines(self, count: int, values: Ints) -> Lines:
        """Return cells of which each begins with the number of its points."""
        if count > len(values):
            raise FormatError(f"{self._path} has {len(values)} numbers of {count} cells; need more")
        heads = np.zeros(count, dtype=np.intp)
        at = 0
        for cell in range(count):
            if not (at < len(values) and 0 <= values[at] < len(values) - at):
                raise FormatError(f"{self._path} has no whole cell {cell}; need its points")
            heads[cell] = at
            at += int(values[at]) + 1
        if at != len(values):
            raise FormatError(f"{self._path} has {len(values)} numbers of cells; need {at}")
        return Lines(np.delete(values, heads), np.cumsum(values[heads]))

    def _attributes(self, keyword: str, words: list[str]) -> None:
        """Read data of points or cells, of which only radii matter."""
        owner, count = self._values_of
        if keyword == "SCALARS":
            width = self._count(words, 3) if len(words) > 3 else 1
            at = self._at
            if not self._line().startswith("LOOKUP_TABLE"):
                self._at = at
            values = self._numbers(count * width, self._word(words, 2))
            self._keep_radii(words[1], owner, width, values)
        elif keyword in _WIDTHS:
            self._numbers(count * _WIDTHS[keyword], self._word(words, 2))
        elif keyword == "TEXTURE_COORDINATES":
            self._numbers(count * self._count(words, 2), self._word(words, 3))
        elif keyword == "COLOR_SCALARS":
            self._numbers(count * self._count(words, 2), "unsigned_char" if self._binary else "")
        elif keyword == "LOOKUP_TABLE":
            self._numbers(4 * self._count(words, 2), "unsigned_char" if self._binary else "")
        else:
            raise self._error(words, "a section of a legacy VTK file")

    def _field(self, count: int) -> None:
        for _ in range(count):
            while not (words := self._line().split()):
                if self._at >= len(self._data):
                    raise FormatError(f"{self._path} ends within a FIELD; need {count} arrays")
            width, number = self._count(words, 1), self._count(words, 2)
            values = self._numbers(width * number, self._word(words, 3))
            self._keep_radii(words[0], self._values_of[0], width, values)

    def _keep_radii(self, name: str, owner: str, width: int, values: Floats) -> None:
        if owner == "POINT_DATA" and width == 1 and is_radii(name):
            self._radii = as_doubles(values)

    def _line(self) -> str:
        """Return the next line without blanks at its ends; "" at the end of the file."""
        stop = self._data.find(b"\n", self._at)
        stop = len(self._data) if stop < 0 else stop
        line = self._data[self._at : min(stop, self._at + 1000)]
        self._at = min(stop + 1, len(self._data))
        return line.decode("utf-8", errors="replace").strip()

    def _numbers(self, count: int, kind: str) -> Floats:
        """Return the next `count` numbers, which begin on a line of their own."""
        if self._binary:
            return self._binary_numbers(count, kind)
        # A number takes two bytes and more: what can't be there is not asked for.
        here = _WORD.finditer(self._data, self._at) if count <= len(self._data) else iter(())
        words = list(islice(here, count))
        if len(words) < count:
            raise FormatError(f"{self._path} ends within {count} numbers; need the whole file")
        if words:
            self._at = words[-1].end()
            self._line()
        return floats_of_words(self._path, [word.group() for word in words], f"{count} numbers")

    def _indices(self, count: int, kind: str) -> Ints:
        return as_indices(self._path, as_doubles(self._numbers(count, kind)))

    def _binary_numbers(self, count: int, kind: str) -> Floats:
        if kind.lower() not in _TYPES:
            raise FormatError(f"{self._path} has numbers of type {kind[:80]!r}; need {[*_TYPES]}")
        dtype = np.dtype(">" + _TYPES[kind.lower()])
        stop = self._at + count * dtype.itemsize
        if stop > len(self._data):
            raise FormatError(f"{self._path} ends within {count} numbers; need the whole file")
        values = np.frombuffer(self._data[self._at : stop], dtype=dtype)
        self._at = stop
        return values

    def _count(self, words: list[str], at: int) -> int:
        count = as_count(self._word(words, at))
        if count is None:
            raise self._error(words, f"a count, 0 or more, as word {at + 1}")
        return count

    def _word(self, words: list[str], at: int) -> str:
        if len(words) <= at:
            raise self._error(words, f"{at + 1} words")
        return words[at]

    def _error(self, words: list[str], needed: str) -> FormatError:
        line = self._data.count(b"\n", 0, self._at)
        return FormatError(f"{self._path}, line {line}: {' '.join(words)[:80]!r}; need {needed}")
