"""Sampled fields in files: VTK images, VTK meshes with point data, and tables of points."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from scaffold_cad.base.arguments import as_path, checks_keywords, did_you_mean
from scaffold_cad.base.arrays import Floats
from scaffold_cad.base.fields import Field, PointField
from scaffold_cad.base.files import reading
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._columns import cells_of, plain_name, unit_name, unit_of
from scaffold_cad.io._text import (
    LARGEST_FILE,
    Row,
    check_size,
    float_columns,
    is_number,
    read_text,
    short_row,
)
from scaffold_cad.io._units import MILLIMETERS
from scaffold_cad.io.vtk.xml import XmlFile

_ROW = "x, y, z and a value"
_PLACES = tuple(
    (axis, f"{axis}coord", f"{axis}coordinate", f"{axis}location", f"{axis}position", f"points{k}")
    for k, axis in enumerate("xyz")
)
"""Names of the columns of x, of y and of z; the last are those of ParaView."""

TABLES = (".csv", ".txt", ".dat")
"""Suffixes of tables: x, y, z and a value in each line, between commas, semicolons or blanks."""

FIELD_SUFFIXES = (".vti", ".vtu", ".vtp", *TABLES)
"""Suffixes of the files that hold fields."""


@checks_keywords()
def read_field(path: str | Path, name: str | None = None) -> Field | PointField:
    """Return the numbers that a file holds, as a function of positions; lengths are taken as mm.

    Parameters
    ----------
    path : a VTK image (.vti, with point or cell data); a VTK mesh with point data (.vtu, .vtp),
        such as a result of finite elements; or a table (.csv, .txt, .dat) of x, y, z and a value:
        in this order, or in that of a line of headings, which may name units, as in ``x [m]``
    name : of the data in a VTK file, or of a column; by default the only one

    Raises
    ------
    FormatError
        If the suffix is not one of these, or the file does not hold what it must.
    """
    source = as_path(path)
    suffix = source.suffix.lower()
    if suffix not in FIELD_SUFFIXES:
        hint = did_you_mean(suffix, FIELD_SUFFIXES)
        raise FormatError(
            f"{source} is of no format of fields; need one of {', '.join(FIELD_SUFFIXES)}{hint}"
        )
    with reading(source):
        check_size(source, LARGEST_FILE)
        if suffix in TABLES:
            return _table(source, name)
        return _image(source, name) if suffix == ".vti" else _mesh(source, name)


def _table(path: Path, name: str | None) -> PointField:
    """Return the field of a table."""
    rows: list[Row] = []
    headings: list[str] = []
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        cells = _cells(line.split("#")[0])
        if not any(cells):
            continue
        if rows or all(map(is_number, filter(None, cells[:4]))):
            rows.append((number, cells))
        else:
            headings = cells
    if not rows:
        raise FormatError(f"{path} has no line of numbers; need x, y, z and a value in each")
    if len(rows[0][1]) < 4:
        raise short_row(path, *rows[0], _ROW)
    chosen, units = _columns(path, headings, len(rows[0][1]), name)
    short = next((row for row in rows if len(row[1]) <= max(chosen)), None)
    if short is not None:
        raise short_row(path, *short, _ROW)
    picked = [(line, [cells[k] for k in chosen]) for line, cells in rows]
    columns = float_columns(path, picked, 0, 4, _ROW) * units
    return PointField(columns[:, :3], columns[:, 3])


def _cells(line: str) -> list[str]:
    """Return the cells of a line, which blanks part where nothing else does."""
    parted = any(mark in line for mark in ",;\t")
    return [cell.strip() for cell in cells_of(line)] if parted else line.split()


def _columns(
    path: Path, headings: list[str], count: int, name: str | None
) -> tuple[list[int], list[float]]:
    """Return the columns of x, y, z and a value, and mm in the unit of each."""
    names = [plain_name(heading) for heading in headings]
    places = [next((k for k, one in enumerate(names) if one in known), -1) for known in _PLACES]
    if len(headings) != count and min(places) < 0:  # a title, or nothing
        places, names, headings = [0, 1, 2], [""] * count, [""] * count
    if len(headings) != count or min(places) < 0:
        raise FormatError(
            f"{path} has the headings {', '.join(headings)[:80]!r} above {count} columns; need one "
            "for each, x, y and z among them"
        )
    others = [k for k in range(count) if k not in places and (names[k] or not any(names))]
    known = ", ".join(repr(headings[k]) for k in others if headings[k])
    if name is not None:
        others = [k for k in others if plain_name(name) == names[k] != ""]
    elif not any(names):
        others = others[:1]
    if len(others) != 1:
        given = "" if name is None else f"no data {name!r}, but "
        raise FormatError(f"{path} has {given}the data {known or 'none'}; need name= one of them")
    chosen = [*places, *others]
    for k in places:
        if unit_name(headings[k]) and unit_of(headings[k]) is None:
            raise FormatError(
                f"{path}: column {headings[k]!r} has no unit of length; need one of "
                f"{', '.join(MILLIMETERS)}, or none"
            )
    return chosen, [unit_of(headings[k]) or 1.0 for k in chosen]


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
