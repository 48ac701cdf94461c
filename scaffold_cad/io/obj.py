"""Wavefront OBJ, and PyMesh's `.wire`: line elements, and Rhino's curves of degree 1."""

from __future__ import annotations

import re
from itertools import pairwise
from operator import itemgetter
from pathlib import Path
from typing import TextIO

import numpy as np

from scaffold_cad.base.arrays import Ints, Points, Triangles
from scaffold_cad.base.blocks import cut
from scaffold_cad.errors import FormatError
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import (
    Row,
    first_words,
    float_columns,
    line_error,
    read_rows,
    read_text,
    short_row,
)
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import register_mesh_reader, register_reader, register_writer
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton

_KEYWORDS = frozenset(
    ["v", "vt", "vn", "vp", "p", "l", "f", "o", "g", "s", "mtllib", "usemtl", "cstype", "deg"]
)
_VERTEX = "a vertex: v x y z"
_FACE = "a face: f i j k ..., with three vertices or more"
_V = re.compile(r"^[ \t]*v[ \t]+(.*)$", re.MULTILINE)
_F = re.compile(r"^[ \t]*f[ \t]+(.*)$", re.MULTILINE)
_PART = re.compile(r"/\S*")
"""What says where a corner's texture and normal are."""
_ELEMENTS = {
    "l": (1, "a line element: l i j ..., with two vertices or more"),
    "curv": (3, "a curve: curv u0 u1 i j ..., with two vertices or more"),
}
"""Where the vertices of an element begin among its words, and what it must be."""


def _recognizes(head: bytes) -> bool:
    return not _KEYWORDS.isdisjoint(first_words(head)[:1])


@register_mesh_reader("OBJ", ".obj")
def read_obj_triangles(path: Path) -> TriangleMesh:
    """Read the faces of an OBJ file, polygons as fans of triangles.

    All vertices stay as they are, whatever groups, materials and textures the faces have: so they
    share them across borders of those.
    """
    read = _quickly(read_text(path)) or _row_by_row(path)
    return TriangleMesh(*read)


def _quickly(text: str) -> tuple[Points, Triangles] | None:
    """Return vertices and triangles; None if faces differ in size, count back or are faulty."""
    whole = text.replace("\\\n", " ")
    vertices, faces = ([*map(itemgetter(1), kind.finditer(whole))] for kind in (_V, _F))
    if not vertices or not faces:
        return None
    try:
        points = np.loadtxt(vertices, usecols=(0, 1, 2), ndmin=2)
        plain = (_PART.sub("", face) if "/" in face else face for face in faces)
        corners = np.loadtxt(plain, dtype=np.intp, ndmin=2)
    except ValueError:
        return None
    if corners.shape[1] < 3 or corners.min() < 1 or corners.max() > len(points):
        return None
    return points, _fans(corners - 1)


def _fans(corners: Ints) -> Triangles:
    """Return the triangles of polygons (f, n) around their first corners, (f (n - 2), 3)."""
    after = np.stack([corners[:, 1:-1], corners[:, 2:]], axis=2)  # (f, n - 2, 2)
    first = np.broadcast_to(corners[:, :1, None], (*after.shape[:2], 1))
    return np.concatenate([first, after], axis=2).reshape(-1, 3)


def _row_by_row(path: Path) -> tuple[Points, Triangles]:
    """Return vertices and triangles of any OBJ file.

    Raises
    ------
    FormatError
        If a line is faulty; it is named.
    """
    rows = _joined(read_rows(path))
    vertices = [row for row in rows if row[1][0] == "v"]
    points = float_columns(path, vertices, 1, 3, _VERTEX)
    triangles, seen = [np.zeros((0, 3), dtype=np.intp)], 0
    for line, words in rows:
        if words[0] == "v":
            seen += 1
        elif words[0] == "f":
            if len(words) < 4:
                raise short_row(
                    path, line, words, "a face: f i j k ..., with three vertices or more"
                )
            corners = _vertices(path, line, words[1:], seen, len(points))
            triangles.append(_fans(np.array([corners])))
    return points, np.concatenate(triangles)


@register_reader("OBJ", ".obj", ".wire", recognizes=_recognizes)
def read_obj(path: Path) -> RawSkeleton:
    """Read the lines of an OBJ file, which has no radii.

    Those are the elements ``l`` and the curves ``curv`` of degree 1, as Rhino writes polylines.
    Vertices that no line uses, as those of faces, are left out, and so is all else. A ``.wire`` may
    have vertices x, y in the plane z = 0.
    """
    rows = _joined(read_rows(path))
    vertices = [row for row in rows if row[1][0] == "v"]
    edges = _edges(path, rows, len(vertices))
    if not edges:
        found = "only faces" if any(words[0] == "f" for _, words in rows) else "no elements"
        raise FormatError(f"{path} has {found}; need line elements ('l' or 'curv')")
    flat = path.name.lower().endswith(".wire") and {len(words) for _, words in vertices} == {3}
    if flat:  # a wire in the plane
        vertices = [(line, [*words, "0"]) for line, words in vertices]
    nodes = float_columns(path, vertices, 1, 3, _VERTEX)
    used, compact = np.unique(np.asarray(edges, dtype=np.intp), return_inverse=True)
    return RawSkeleton(nodes[used], compact.reshape(-1, 2))


def _joined(rows: list[Row]) -> list[Row]:
    """Return the rows with each that ends in a backslash joined to the next."""
    joined: list[Row] = []
    for line, words in rows:
        before = joined[-1][1] if joined else [""]
        if before[-1].endswith("\\"):
            before[-1:] = filter(None, [before[-1].removesuffix("\\"), *words])
        else:
            joined.append((line, words))
    return joined


def _edges(path: Path, rows: list[Row], total: int) -> list[tuple[int, int]]:
    """Return the pairs of vertices that the lines and curves join, counted from 0."""
    edges: list[tuple[int, int]] = []
    seen = 0  # vertices so far: what negative indices count back from
    degree = "unknown"
    for line, words in rows:
        keyword = words[0]
        if keyword == "v":
            seen += 1
        elif keyword == "deg":
            degree = " ".join(words[1:])
        elif keyword in _ELEMENTS:
            if keyword == "curv" and degree != "1":
                raise line_error(path, line, f"a curve of degree {degree}", "degree 1")
            first, need = _ELEMENTS[keyword]
            if len(words) < first + 2:
                raise short_row(path, line, words, need)
            edges += pairwise(_vertices(path, line, words[first:], seen, total))
    return edges


def _vertices(path: Path, line: int, words: list[str], seen: int, total: int) -> list[int]:
    """Return the vertices, counted from 0, that words such as ``i``, ``i/t`` and ``-i`` name."""
    try:
        numbers = [int(word.partition("/")[0]) for word in words]
    except ValueError:
        raise line_error(path, line, f"{' '.join(words)!r}", "numbers of vertices") from None
    if 0 in numbers:
        need = "1 or more: OBJ counts from 1, and this file seems to count from 0"
        raise line_error(path, line, "vertex 0", need)
    for number in (min(numbers), max(numbers)):
        if not -seen <= number <= total:
            need = f"1 to {total}, or -1 to -{seen}" if total else "lines 'v x y z' of vertices"
            raise line_error(path, line, f"vertex {number}", need)
    return [number - 1 if number > 0 else seen + number for number in numbers]


ROW_BYTES = 2048
"""What a row takes where it is formatted: its text and its numbers as Python's objects."""


@register_writer(".obj", name="OBJ", radii="none")
def write_obj_content(content: Content, path: Path) -> None:
    """Write a Skeleton as lines, and anything else that has a surface as its faces."""
    if isinstance(content.what, Skeleton):
        write_obj_lines(content.skeleton("an OBJ file"), path, content.unit)
    else:
        write_obj(content.mesh(), path, content.unit)


def write_obj(mesh: QuadMesh | TriangleMesh, path: Path, unit: str = "mm") -> None:
    """Write the vertices, exact to the last bit, and the faces of `mesh`."""
    faces = mesh.fans if isinstance(mesh, QuadMesh) else mesh.triangles
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"# scaffold_cad\n# unit: {unit}\n")
        _write_rows(file, "v %r %r %r\n", mesh.vertices)
        _write_rows(file, "f" + " %d" * faces.shape[1] + "\n", faces + 1)


def write_obj_lines(skeleton: Skeleton, path: Path, unit: str = "mm") -> None:
    """Write the nodes, exact to the last bit, and the edges; OBJ has no place for radii."""
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"# scaffold_cad\n# unit: {unit}\n")
        _write_rows(file, "v %r %r %r\n", skeleton.nodes)
        _write_rows(file, "l %d %d\n", skeleton.edges + 1)


def _write_rows(file: TextIO, template: str, rows: np.ndarray) -> None:
    for some in cut(rows, ROW_BYTES):
        file.write(template * len(some) % tuple(some.reshape(-1).tolist()))
