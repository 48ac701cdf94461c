"""Sampled fields in files: VTK images, VTK meshes with point data, and tables of points."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from scaffold_cad.base.arguments import as_path
from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.fields import Field, PointField
from scaffold_cad.base.files import reading
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._text import LARGEST_FILE, Row, check_size, float_columns, is_number, read_text
from scaffold_cad.io.vtk.xml import XmlFile

TABLES = (".csv", ".txt", ".dat")
"""Suffixes of tables: x, y, z and a value in each line, between commas, semicolons or blanks."""

FIELD_SUFFIXES = (".vti", ".vtu", ".vtp", *TABLES)
"""Suffixes of the files that hold fields."""

_SEPARATORS = str.maketrans(",;", "  ")


def read_field(path: str | Path, name: str | None = None) -> Field | PointField:
    """Return the numbers that a file holds, as a function of positions; lengths are taken as mm.

    Parameters
    ----------
    path : a VTK image (.vti, with point or cell data); a VTK mesh with point data (.vtu, .vtp),
        such as a result of finite elements; or a table (.csv, .txt, .dat) of x, y, z and a value,
        with a line of headings or none
    name : of the data in a VTK file; by default the only one

    Raises
    ------
    FormatError
        If the suffix is none of these, or the file does not hold what it must.
    """
    source = as_path(path)
    suffix = source.suffix.lower()
    if suffix not in FIELD_SUFFIXES:
        raise FormatError(f"{source} holds no field; need one of {', '.join(FIELD_SUFFIXES)}")
    with reading(source):
        check_size(source, LARGEST_FILE)
        if suffix in TABLES:
            return _table(source)
        return _image(source, name) if suffix == ".vti" else _mesh(source, name)


def _table(path: Path) -> PointField:
    """Return the field of a table."""
    rows: list[Row] = []
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        words = line.split("#")[0].translate(_SEPARATORS).split()
        if words and (rows or all(map(is_number, words[:4]))):
            rows.append((number, words))
    if not rows:
        raise FormatError(f"{path} has no line of numbers; need x, y, z and a value in each")
    columns = float_columns(path, rows, 0, 4, "x, y, z and a value")
    return PointField(columns[:, :3], columns[:, 3])


def _mesh(path: Path, name: str | None) -> PointField:
    """Return the field of the point data of a mesh."""
    file = XmlFile(path)
    points, values = [np.zeros((0, 3))], [np.zeros(0)]
    for piece in file.root.iter("Piece"):
        places = as_doubles(file.array(file.element(piece, "Points/DataArray"))).reshape(-1, 3)
        points.append(places)
        values.append(_numbers(path, file, piece, "PointData", name, len(places)))
    if sum(map(len, points)) == 0:
        raise FormatError(f"{path} has no points; need them")
    return PointField(np.concatenate(points), np.concatenate(values))


def _image(path: Path, name: str | None) -> Field:
    """Return the field of an image."""
    file = XmlFile(path, ("ImageData",))
    image = file.element(file.root, "ImageData")
    pieces = image.findall("Piece")
    if len(pieces) != 1:
        raise FormatError(f"{path} has {len(pieces)} pieces; need one")
    (piece,) = pieces
    extent = _row(path, piece, "Extent", 6).reshape(3, 2)
    origin, spacing = _row(path, image, "Origin", 3), _row(path, image, "Spacing", 3)
    counts = np.diff(extent, axis=1)[:, 0].astype(np.intp) + 1
    low = origin + extent[:, 0] * spacing
    high = origin + extent[:, 1] * spacing
    kind = "PointData" if piece.find("PointData/DataArray") is not None else "CellData"
    if kind == "CellData":  # in the middle of each voxel
        counts = np.maximum(counts - 1, 1)
        low, high = low + spacing / 2, high - spacing / 2
    values = _numbers(path, file, piece, kind, name, int(counts.prod()))
    # VTK counts along x first.
    grid = values.reshape(counts[::-1]).transpose(2, 1, 0)
    return Field(grid, [np.minimum(low, high), np.maximum(low, high)])


def _row(path: Path, element: Element, name: str, count: int) -> Floats:
    """Return the numbers of an attribute."""
    words = element.get(name, "").split()
    if len(words) != count or not all(map(is_number, words)):
        raise FormatError(f"{path} has {name} {' '.join(words)[:80]!r}; need {count} numbers")
    return np.array(words, dtype=np.float64)


def _numbers(
    path: Path, file: XmlFile, piece: Element, kind: str, name: str | None, count: int
) -> Floats:
    """Return the data of a name, or the only one, shape (count,)."""
    arrays = {array.get("Name", ""): array for array in piece.findall(f"{kind}/DataArray")}
    known = ", ".join(map(repr, arrays)) or "none"
    if name is None and len(arrays) != 1:
        raise FormatError(f"{path} has the data {known} in {kind}; need name= one of them")
    if name is not None and name not in arrays:
        raise FormatError(f"{path} has no data {name!r} in {kind}, but {known}; need one of them")
    found = arrays[name] if name is not None else next(iter(arrays.values()))
    values = as_doubles(file.array(found))
    if len(values) != count:
        raise FormatError(
            f"{path} has {len(values)} numbers in {found.get('Name', '')!r}; need {count}, one each"
        )
    return values
