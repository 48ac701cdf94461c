"""VTK's XML files: the lines of poly data (.vtp) and unstructured grids (.vtu)."""

from __future__ import annotations

import binascii
import zlib
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from scaffold_cad.base.arrays import Bools, Floats, Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, as_count, as_indices, check_size, floats_of_words
from scaffold_cad.io._xml import xml_root
from scaffold_cad.io.register import register_reader
from scaffold_cad.io.vtk.lines import (
    LINE_CELLS,
    Lines,
    checked,
    is_radii,
    line_cells,
    radii_among,
    skeleton_of,
)

_TYPES = {
    "Int8": "i1",
    "UInt8": "u1",
    "Int16": "i2",
    "UInt16": "u2",
    "Int32": "i4",
    "UInt32": "u4",
    "Int64": "i8",
    "UInt64": "u8",
    "Float32": "f4",
    "Float64": "f8",
}

MOST_UNPACKED = 2**28
"""Most bytes that an array may be unpacked to."""


def _recognizes(head: bytes) -> bool:
    return b"<VTKFile" in head


@register_reader("VTK XML", ".vtp", ".vtu", recognizes=_recognizes)
def read_vtk_xml(path: Path) -> RawSkeleton:
    """Read the lines of a .vtp or .vtu file; point or cell data called "radius" are the radii.

    Arrays may be text, base64, or appended, raw or base64; packed by zlib or not. Lengths are
    taken as mm. Cells that are not lines are left out.
    """
    check_size(path, LARGEST_FILE)
    reader = XmlFile(path)
    pieces = [reader.piece(piece) for piece in reader.root.iter("Piece")]
    if not pieces:
        raise FormatError(f"{path} has no Piece; need one of PolyData or UnstructuredGrid")
    shift = np.cumsum([0, *(len(piece.points) for piece in pieces)])
    size = np.cumsum([0, *(len(piece.lines.connectivity) for piece in pieces)])
    lines = Lines(
        np.concatenate(
            [piece.lines.connectivity + n for piece, n in zip(pieces, shift, strict=False)]
        ),
        np.concatenate([piece.lines.ends + n for piece, n in zip(pieces, size, strict=False)]),
    )
    radii = [piece.radii for piece in pieces if piece.radii is not None]
    of_lines = [piece.of_lines for piece in pieces if piece.of_lines is not None]
    return skeleton_of(
        np.concatenate([piece.points for piece in pieces]),
        lines,
        np.concatenate(radii) if len(radii) == len(pieces) else None,
        np.concatenate(of_lines) if len(of_lines) == len(pieces) else None,
    )


@dataclass(frozen=True, eq=False)
class _Piece:
    """What a piece of a file holds."""

    points: Floats
    lines: Lines
    radii: Floats | None
    of_lines: Floats | None


class XmlFile:
    """A file of XML, and the bytes appended to it, which need not be XML."""

    def __init__(
        self, path: Path, kinds: tuple[str, ...] = ("PolyData", "UnstructuredGrid")
    ) -> None:
        self._path = path
        data = path.read_bytes()
        self._appended = b""
        element = data.find(b"<AppendedData")
        if element >= 0:
            start = data.find(b"_", data.find(b">", element))  # the first byte before the data
            stop = data.rfind(b"</AppendedData>")
            if not element < start < stop:
                raise FormatError(f"{path} ends within its appended data; need the whole file")
            self._appended = data[start + 1 : stop]
            data = data[:start] + data[stop:]
        self.root = xml_root(path, data)
        if self.root.get("type") not in kinds:
            raise FormatError(f"{path} holds {self.root.get('type')}; need {' or '.join(kinds)}")
        self._is_poly_data = self.root.get("type") == "PolyData"
        self._order = ">" if self.root.get("byte_order") == "BigEndian" else "<"
        self._header = np.dtype(
            self._order + ("u8" if self.root.get("header_type") == "UInt64" else "u4")
        )
        compressor = self.root.get("compressor")
        if compressor not in (None, "", "vtkZLibDataCompressor"):
            raise FormatError(f"{path} is packed by {compressor[:80]}; need vtkZLibDataCompressor")
        self._packed = bool(compressor)
        data_of = self.root.find("AppendedData")
        self._raw = data_of is not None and data_of.get("encoding") == "raw"

    def piece(self, piece: Element) -> _Piece:
        """Return what a piece holds."""
        points = as_doubles(self.array(self.element(piece, "Points/DataArray")))
        if len(points) % 3:
            raise FormatError(f"{self._path} has {len(points)} coordinates; need 3 per point")
        points = points.reshape(-1, 3)
        cells = "Lines" if self.root.get("type") == "PolyData" else "Cells"
        lines = Lines(
            self._indices(self.element(piece, f"{cells}/DataArray[@Name='connectivity']")),
            self._indices(self.element(piece, f"{cells}/DataArray[@Name='offsets']")),
        )
        lines = checked(self._path, lines, len(points))
        kept = np.ones(len(lines.ends), dtype=np.bool_)
        if cells == "Cells":
            types = self._indices(self.element(piece, "Cells/DataArray[@Name='types']"))
            lines = line_cells(self._path, lines, types)
            kept = np.isin(types, LINE_CELLS)
        radii = None
        for array in piece.findall("PointData/DataArray"):
            if is_radii(array.get("Name", "")):
                radii = as_doubles(self.array(array))
        count = piece.get("NumberOfPoints", "")
        if count.strip() != str(len(points)):
            raise FormatError(f"{self._path} has {len(points)} points; need {count[:80]}")
        if radii is not None and len(radii) != len(points):
            raise FormatError(f"{self._path} has {len(radii)} radii; need {len(points)}")
        return _Piece(points, lines, radii, self._of_lines(piece, kept))

    def _of_lines(self, piece: Element, kept: Bools) -> Floats | None:
        """Return the radius of each line, from data of all cells, of which some are lines."""
        data = {}
        for array in piece.findall("CellData/DataArray"):
            name = array.get("Name", "")
            if radii_among({name: np.zeros(1)}) is not None:
                data[name] = as_doubles(self.array(array))
        found = radii_among(data)
        if found is None:
            return None
        # Cells of poly data come with vertices before lines, and polygons after them.
        before = _count(piece.get("NumberOfVerts")) if self._is_poly_data else 0
        found = found[before : before + len(kept)]
        if len(found) != len(kept):
            raise FormatError(f"{self._path} has {len(found)} radii of {len(kept)} cells")
        return found[kept]

    def element(self, piece: Element, where: str) -> Element:
        """Return what is at a path in a piece.

        Raises
        ------
        FormatError
            If there is nothing.
        """
        found = piece.find(where)
        if found is None:
            raise FormatError(f"{self._path} has no {where} in a Piece; need it")
        return found

    def _indices(self, array: Element) -> Ints:
        return as_indices(self._path, as_doubles(self.array(array)))

    def array(self, array: Element) -> Floats:
        """Return the numbers of an array, flat."""
        kind = array.get("type", "")
        if kind not in _TYPES:
            raise FormatError(f"{self._path} has numbers of type {kind[:80]!r}; need {[*_TYPES]}")
        dtype = np.dtype(self._order + _TYPES[kind])
        name = array.get("Name", "of points")[:80]
        form = array.get("format", "ascii")
        if form == "ascii":
            words = (array.text or "").encode().split()
            return floats_of_words(self._path, words, f"numbers in the array {name!r}")
        try:
            if form == "binary":
                data = self._decoded((array.text or "").strip().encode("ascii"), raw=False)
            else:
                offset = int(array.get("offset", ""))
                if not 0 <= offset < len(self._appended):
                    raise ValueError(f"offset {offset} of {len(self._appended)}")
                data = self._decoded(self._appended[offset:], self._raw)
            return np.frombuffer(data, dtype=dtype)
        except (ValueError, zlib.error) as error:  # base64 errors are ValueErrors
            raise FormatError(f"{self._path}, array {name!r}: {error}; need numbers") from None

    def _decoded(self, text: bytes, raw: bool) -> bytes:
        """Return the bytes of an array that begins `text`."""
        source = _Source(text, raw)
        width = self._header.itemsize
        if not self._packed:
            (size,) = self._header_numbers(source.peek(width), 1)
            return source.take(width + size)[width:]
        (blocks,) = self._header_numbers(source.peek(width), 1)
        if blocks > len(text):
            raise ValueError(f"{blocks} blocks in {len(text)} bytes")
        header = self._header_numbers(source.take((3 + blocks) * width), 3 + blocks)
        full, last, sizes = header[1], header[2], header[3:]
        unpacked = [full] * blocks
        if last and blocks:
            unpacked[-1] = last
        if sum(unpacked) > MOST_UNPACKED:
            raise ValueError(f"{sum(unpacked)} bytes, more than {MOST_UNPACKED}")
        packed = source.take(sum(sizes))
        parts, at = [], 0
        for size, length in zip(sizes, unpacked, strict=True):
            part = zlib.decompressobj().decompress(packed[at : at + size], length + 1)
            if len(part) != length:
                raise ValueError(f"a block of {len(part)} bytes instead of {length}")
            parts.append(part)
            at += size
        return b"".join(parts)

    def _header_numbers(self, data: bytes, count: int) -> list[int]:
        return [int(value) for value in np.frombuffer(data, dtype=self._header, count=count)]


def _count(text: str | None) -> int:
    return as_count((text or "").strip()) or 0


class _Source:
    """Bytes that are raw, or base64 in parts of which each is padded."""

    def __init__(self, text: bytes, raw: bool) -> None:
        self._text = text
        self._raw = raw
        self._at = 0

    def peek(self, count: int) -> bytes:
        """Return the next `count` bytes, which stay."""
        return self._read(count)[0]

    def take(self, count: int) -> bytes:
        """Return the next `count` bytes, which are a part of their own."""
        data, self._at = self._read(count)
        return data

    def _read(self, count: int) -> tuple[bytes, int]:
        length = count if self._raw else 4 * ((count + 2) // 3)
        text = self._text[self._at : self._at + length]
        if len(text) < length:
            raise ValueError(f"it ends within {count} bytes")
        data = text if self._raw else binascii.a2b_base64(text)
        if len(data) < count:
            raise ValueError(f"{len(data)} bytes instead of {count}")
        return data[:count], self._at + length
