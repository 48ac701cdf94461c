"""OFF: a mesh of polygons as text, of which the edges are read."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.io._mesh import Faces, skeleton_of_mesh
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import (
    first_words,
    float_columns,
    index_columns,
    line_error,
    read_rows,
    whole_number,
)
from scaffold_cad.io.register import register_reader

_KINDS = ("OFF", "COFF", "NOFF", "STOFF", "CNOFF")
"""Headers: vertices may have colors, normals and texture after their coordinates."""

_COUNTS = "the numbers of vertices, faces and edges"
_FACE = "a face: N, then its N vertices, 3 or more"


def _recognizes(head: bytes) -> bool:
    return first_words(head)[:1] != [] and first_words(head)[0] in _KINDS


@register_reader("OFF", ".off", recognizes=_recognizes)
def read_off(path: Path) -> RawSkeleton:
    """Read the edges of an OFF file, without those between triangles in a plane.

    The counts may follow the header on its line; their number of edges is ignored.
    """
    rows = read_rows(path)
    if not rows or rows[0][1][0] not in _KINDS:
        raise FormatError(f"{path} does not begin with OFF; need a text file that does")
    head = [(rows[0][0], rows[0][1][1:])] if len(rows[0][1]) > 1 else rows[1:2]
    rest = rows[1 if len(rows[0][1]) > 1 else 2 :]
    line, words = head[0] if head else (rows[0][0], [])
    if len(words) < 2:
        raise line_error(path, line, f"{' '.join(words)!r}", _COUNTS)
    vertices, faces = (whole_number(path, line, word, _COUNTS) for word in words[:2])
    if vertices < 0 or faces < 1 or len(rest) != vertices + faces:
        found = f"{len(rest)} lines of {vertices} vertices and {faces} faces"
        raise line_error(path, line, found, "a line each")
    points = float_columns(path, rest[:vertices], 0, 3, "a vertex: x y z")
    sizes, corners = [], []
    for row in rest[vertices:]:
        count = whole_number(path, row[0], row[1][0], _FACE)
        if not 3 <= count < len(row[1]):
            raise line_error(path, row[0], f"{' '.join(row[1])!r}", _FACE)
        sizes.append(count)
        corners.append(index_columns(path, [row], 1, count, vertices, _FACE)[0])
    return skeleton_of_mesh(points, Faces(np.concatenate(corners), np.asarray(sizes)))
