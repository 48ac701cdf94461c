"""PLY, text or binary: edges, or the edges of faces."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._mesh import Faces, skeleton_of_mesh, triangulated
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, as_indices, check_size, floats_of_words
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh

_TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}

_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}

_LARGEST_HEADER = 2**16  # bytes

_INDICES = ("vertex_indices", "vertex_index")


@dataclass
class _Element:
    """What the header tells of an element: its count, and a name and types a property."""

    name: str
    count: int
    properties: list[tuple[str, str, str]] = field(default_factory=list)
    """Name, type of a list's length or "", and type of its values."""

    @property
    def has_list(self) -> bool:
        return any(length for _, length, _ in self.properties)


@dataclass(frozen=True, eq=False)
class _Table:
    """The values of an element: a column a property; of a list, its values and their numbers."""

    columns: dict[str, Floats]
    sizes: dict[str, Ints]


_NOTHING = _Table({}, {})


def _recognizes(head: bytes) -> bool:
    return head[:3] == b"ply" and head[3:4].isspace()


@register_reader("PLY", ".ply", recognizes=_recognizes)
def read_ply(path: Path) -> RawSkeleton:
    """Read the elements ``edge`` of a PLY file, or the edges of its faces where it has none.

    Of faces, edges between triangles in a plane are left out. A property ``radius`` of vertices
    is their radius in mm.
    """
    tables = _tables(path)
    points, vertex = _points(path, tables)
    if "edge" in tables:
        edge = _table(path, tables, "edge", ("vertex1", "vertex2"))
        ends = [as_indices(path, edge.columns[name]) for name in ("vertex1", "vertex2")]
        return RawSkeleton(points, np.stack(ends, axis=1), vertex.columns.get("radius"))
    return skeleton_of_mesh(points, _faces(path, tables))


@register_mesh_reader("PLY", ".ply")
def read_ply_triangles(path: Path) -> TriangleMesh:
    """Read the faces of a PLY file as triangles; none if it has edges and no faces."""
    tables = _tables(path)
    points, _ = _points(path, tables)
    if "edge" in tables and not any(map(len, tables.get("face", _NOTHING).sizes.values())):
        return TriangleMesh(points, np.zeros((0, 3), dtype=np.intp))
    return triangulated(points, _faces(path, tables))


def _tables(path: Path) -> dict[str, _Table]:
    """Return the values of each element of a file."""
    check_size(path, LARGEST_FILE)
    data = path.read_bytes()
    order, elements, at = _header(path, data)
    if not order:
        return _text_tables(path, data[at:], elements)
    return _binary_tables(path, data[at:], elements, order)


def _points(path: Path, tables: dict[str, _Table]) -> tuple[Floats, _Table]:
    """Return the positions of the vertices, shape (v, 3), and their table of all properties."""
    vertex = _table(path, tables, "vertex", ("x", "y", "z"))
    return np.stack([vertex.columns[axis] for axis in "xyz"], axis=1), vertex


def _faces(path: Path, tables: dict[str, _Table]) -> Faces:
    face = _table(path, tables, "face", ())
    name = next((name for name in _INDICES if name in face.sizes), None)
    if name is None or not len(face.sizes[name]) or face.sizes[name].min() < 3:
        raise FormatError(f"{path} has no faces of 3 vertices or more; need edges or such faces")
    return Faces(as_indices(path, face.columns[name]), face.sizes[name])


def _header(path: Path, data: bytes) -> tuple[str, list[_Element], int]:
    """Return the byte order, "" for text; the elements; and where they begin."""
    stop = data.find(b"end_header", 0, _LARGEST_HEADER)
    begin = data.find(b"\n", stop) + 1
    if data[:3] != b"ply" or stop < 0 or begin == 0:
        raise FormatError(f"{path} has no PLY header, or no end of it; need both")
    order: str | None = None
    elements: list[_Element] = []
    for line in data[:stop].decode("ascii", errors="replace").splitlines()[1:]:
        words = line.split()
        kinds = words[2:-1] if words[1:2] == ["list"] else words[1:-1]
        if words[:1] == ["format"] and len(words) > 1:
            order = _ORDERS.get(words[1])
        elif words[:1] == ["element"] and len(words) == 3 and words[2].isdecimal():
            elements.append(_Element(words[1], int(words[2][:18])))
        elif words[:1] == ["property"] and elements and kinds and set(kinds) <= set(_TYPES):
            length = kinds[0] if len(kinds) == 2 else ""
            known = [name for name, _, _ in elements[-1].properties]
            if words[-1] in known or (length and _TYPES[length][0] == "f"):
                raise FormatError(f"{path} has {line[:80]!r} in its header; need another type")
            elements[-1].properties.append((words[-1], length, kinds[-1]))
        elif words and words[0] not in ("comment", "obj_info"):
            raise FormatError(f"{path} has {line[:80]!r} in its header; need what PLY has")
    if order is None or not all(element.properties for element in elements):
        raise FormatError(f"{path} has no format that is known, or an element without property")
    return order, elements, begin


def _table(path: Path, tables: dict[str, _Table], name: str, needed: tuple[str, ...]) -> _Table:
    found = tables.get(name)
    if found is None or not set(needed) <= set(found.columns) - set(found.sizes):
        raise FormatError(f"{path} has no element {name!r} with {', '.join(needed)}; need it")
    return found


def _text_tables(path: Path, body: bytes, elements: list[_Element]) -> dict[str, _Table]:
    words = body.split()
    values = floats_of_words(path, words, "numbers after the header")
    tables, at = {}, 0
    for element in elements:
        width = len(element.properties)
        if not element.has_list:
            stop = at + width * element.count
            _refuse_end(path, stop, len(values), element)
            rows = values[at:stop].reshape(-1, width)
            names = [name for name, _, _ in element.properties]
            tables[element.name] = _Table(dict(zip(names, rows.T, strict=True)), {})
            at = stop
            continue
        parts = _Parts(element)
        for _ in range(element.count):
            for name, length, _ in element.properties:
                _refuse_end(path, at + 1, len(values), element)
                size = 1
                if length:
                    size, at = _size(path, values[at], element), at + 1
                _refuse_end(path, at + size, len(values), element)
                parts.add(name, values[at : at + size])
                at += size
        tables[element.name] = parts.table()
    return tables


def _binary_tables(
    path: Path, body: bytes, elements: list[_Element], order: str
) -> dict[str, _Table]:
    tables, at = {}, 0
    for element in elements:
        if not element.has_list:
            row = np.dtype([(name, order + _TYPES[kind]) for name, _, kind in element.properties])
            stop = at + row.itemsize * element.count
            _refuse_end(path, stop, len(body), element)
            table = np.frombuffer(body[at:stop], dtype=row)
            columns = {name: as_doubles(table[name]) for name, _, _ in element.properties}
            tables[element.name] = _Table(columns, {})
            at = stop
            continue
        even = _even_rows(body, at, element, order)
        if even is not None:
            tables[element.name], at = even
            continue
        parts = _Parts(element)
        for _ in range(element.count):
            for name, length, kind in element.properties:
                size = 1
                if length:
                    counts = np.dtype(order + _TYPES[length])
                    _refuse_end(path, at + counts.itemsize, len(body), element)
                    size = _size(path, np.frombuffer(body, counts, 1, at)[0], element)
                    at += counts.itemsize
                values = np.dtype(order + _TYPES[kind])
                _refuse_end(path, at + size * values.itemsize, len(body), element)
                parts.add(name, np.frombuffer(body, values, size, at))
                at += size * values.itemsize
        tables[element.name] = parts.table()
    return tables


def _even_rows(body: bytes, at: int, element: _Element, order: str) -> tuple[_Table, int] | None:
    """Return an element of one list that is as long in each row, and where it ends.

    None if it is not like that. Meshes of triangles or of quads are, and reading them row by row
    would take a hundred times as long.
    """
    ((name, length, kind), *others) = element.properties
    counts = np.dtype(order + _TYPES[length or "char"])
    if others or not element.count or at + counts.itemsize > len(body):
        return None
    size = int(np.frombuffer(body, counts, 1, at)[0])
    if not 0 <= size <= len(body):
        return None
    row = np.dtype([("size", counts), ("values", order + _TYPES[kind], (size,))])
    stop = at + row.itemsize * element.count
    if stop > len(body):
        return None
    table = np.frombuffer(body[at:stop], dtype=row)
    if (table["size"] != size).any():
        return None
    values = as_doubles(table["values"]).reshape(-1)
    return _Table({name: values}, {name: np.full(element.count, size)}), stop


class _Parts:
    """The values of an element that has lists, gathered row by row."""

    def __init__(self, element: _Element) -> None:
        self._lists = [name for name, length, _ in element.properties if length]
        self._values: dict[str, list[Floats]] = {name: [] for name, _, _ in element.properties}

    def add(self, name: str, values: Floats) -> None:
        self._values[name].append(values)

    def table(self) -> _Table:
        columns = {
            name: np.concatenate([np.zeros(0), *parts]) for name, parts in self._values.items()
        }
        sizes = {name: np.array([*map(len, self._values[name])], np.intp) for name in self._lists}
        return _Table(columns, sizes)


def _size(path: Path, value: float, element: _Element) -> int:
    """Return the number of values in a list."""
    if not 0 <= value < 2**31 or value != int(value):
        raise FormatError(f"{path} has a list of {value:g} values in {element.name!r}; need 0, ...")
    return int(value)


def _refuse_end(path: Path, stop: int, total: int, element: _Element) -> None:
    if stop > total:
        raise FormatError(f"{path} ends within {element.count} elements {element.name!r}; need all")


HEADER = """\
ply
format binary_little_endian 1.0
comment scaffold_cad
comment unit: {unit}
element vertex {vertices}
property double x
property double y
property double z
element face {faces}
property list uchar int vertex_indices
end_header
"""

MOST_VERTICES = 2**31
"""Vertices that a PLY index can tell apart."""


@register_writer(".ply", name="PLY", skeletons=False)
def write_ply_content(content: Content, path: Path) -> None:
    """Write the faces of anything that has a surface."""
    write_ply(content.mesh(), path, content.unit)


def write_ply(mesh: QuadMesh | TriangleMesh, path: Path, unit: str = "mm") -> None:
    """Write the vertices and the faces of `mesh`.

    Raises
    ------
    FormatError
        If it has more vertices than PLY indices can tell apart.
    """
    _check_count(len(mesh.vertices))
    faces = mesh.fans if isinstance(mesh, QuadMesh) else mesh.triangles
    with path.open("wb") as file:
        _write_header(file, len(mesh.vertices), len(faces), unit)
        file.write(mesh.vertices.astype("<f8").tobytes())
        _write_faces(file, faces)


def _check_count(vertices: int) -> None:
    if vertices > MOST_VERTICES:
        raise FormatError(
            f"the surface has {vertices} vertices; a PLY file holds {MOST_VERTICES} at most "
            "(fewer sides)"
        )


def _write_header(file: BinaryIO, vertices: int, faces: int, unit: str = "mm") -> None:
    file.write(HEADER.format(vertices=vertices, faces=faces, unit=unit).encode("ascii"))


def _write_faces(file: BinaryIO, faces: Ints) -> None:
    corners = faces.shape[1]
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", corners)])
    rows["count"] = corners
    rows["corners"] = faces
    file.write(rows.tobytes())
