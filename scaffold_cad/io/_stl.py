"""STL, text or binary: triangles, of which the edges are read."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Points
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._formats import HEAD_SIZE, register_reader
from scaffold_cad.io._mesh import Faces, skeleton_of_mesh
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, check_size

_HEADER = 84
"""Bytes before the facets of a binary file."""

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def _is_text(head: bytes) -> bool:
    # Some binary files begin with "solid" too.
    return head.lstrip()[:5].lower() == b"solid" and b"facet" in head.lower()


def _recognises(head: bytes) -> bool:
    count = int.from_bytes(head[80:84], "little")
    return _is_text(head) or (
        count > 0 and len(head) < HEAD_SIZE and len(head) == _HEADER + count * _FACET.itemsize
    )


@register_reader("STL", ".stl", recognises=_recognises)
def read_stl(path: Path) -> RawSkeleton:
    """Read the edges of an STL file, without those that cut a flat face in triangles.

    A text file may hold several solids. Corners that are not exactly equal stay apart until
    they are welded.
    """
    check_size(path, LARGEST_FILE)
    data = path.read_bytes()
    points = _of_text(path, data) if _is_text(data[:HEAD_SIZE]) else _of_binary(path, data)
    count = len(points) // 3
    return skeleton_of_mesh(points, Faces(np.arange(3 * count), np.full(count, 3)))


def _of_binary(path: Path, data: bytes) -> Points:
    """Return the corners of the facets, shape (3 t, 3)."""
    count = int.from_bytes(data[80:84], "little")
    size = _HEADER + count * _FACET.itemsize
    if len(data) != size or not count:
        raise FormatError(f"{path} has {len(data)} bytes; need {size}, as its header says")
    corners = np.frombuffer(data, dtype=_FACET, offset=_HEADER)["corners"]
    return as_doubles(corners).reshape(-1, 3)


def _of_text(path: Path, data: bytes) -> Points:
    """Return the corners of the facets, shape (3 t, 3)."""
    if not data.lower().rstrip().rpartition(b"\n")[2].lstrip().startswith(b"endsolid"):
        raise FormatError(f"{path} does not end with 'endsolid': need the whole file")
    rows = _VERTEX.findall(data)
    facets = len(re.findall(rb"\bendfacet\b", data, re.IGNORECASE))
    if len(rows) != 3 * facets or not facets:
        raise FormatError(f"{path} has {len(rows)} vertices of {facets} facets; need 3 a facet")
    try:
        return np.array(rows, dtype=np.float64)
    except ValueError as error:
        raise FormatError(f"{path}: {error}; need a vertex: vertex x y z") from None
