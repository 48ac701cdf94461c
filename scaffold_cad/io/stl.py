"""STL, text or binary: triangles, of which the edges are read."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Points
from scaffold_cad.base.blocks import CACHE, cut
from scaffold_cad.base.counts import counting
from scaffold_cad.errors import FormatError
from scaffold_cad.io._binary import as_doubles
from scaffold_cad.io._mesh import Faces, skeleton_of_mesh
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import LARGEST_FILE, check_size, is_number, line_error
from scaffold_cad.io.content import Content
from scaffold_cad.io.register import (
    HEAD_SIZE,
    register_mesh_reader,
    register_reader,
    register_writer,
)
from scaffold_cad.mesh.trianglemesh import TriangleMesh

_HEADER = 84
"""Bytes before the facets of a binary file."""

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def _is_text(head: bytes) -> bool:
    # Some binary files begin with "solid" too.
    return head.lstrip()[:5].lower() == b"solid" and b"facet" in head.lower()


def _recognizes(head: bytes) -> bool:
    count = int.from_bytes(head[80:84], "little")
    return _is_text(head) or (
        count > 0 and len(head) < HEAD_SIZE and len(head) == _HEADER + count * _FACET.itemsize
    )


@register_reader("STL", ".stl", recognizes=_recognizes)
def read_stl(path: Path) -> RawSkeleton:
    """Read the edges of an STL file, without those that cut a flat face in triangles.

    A text file may hold several solids. Corners that are not exactly equal stay apart until
    they are welded.
    """
    points = _corners(path)
    count = len(points) // 3
    return skeleton_of_mesh(points, Faces(np.arange(3 * count), np.full(count, 3)))


@register_mesh_reader("STL", ".stl")
def read_stl_triangles(path: Path) -> TriangleMesh:
    """Read the triangles of an STL file, each with three vertices of its own."""
    points = _corners(path)
    return TriangleMesh(points, np.arange(len(points)).reshape(-1, 3))


def _corners(path: Path) -> Points:
    """Return the corners of the facets of a file, shape (3 t, 3)."""
    check_size(path, LARGEST_FILE)
    data = path.read_bytes()
    return _of_text(path, data) if _is_text(data[:HEAD_SIZE]) else _of_binary(path, data)


def _of_binary(path: Path, data: bytes) -> Points:
    """Return the corners of the facets, shape (3 t, 3)."""
    if len(data) < _HEADER:
        raise FormatError(f"{path} has {len(data)} bytes; need an STL file, of {_HEADER} and more")
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
        raise FormatError(f"{path} has {len(rows)} vertices of {facets} facets; need 3 per facet")
    try:
        return np.array(rows, dtype=np.float64)
    except ValueError:
        found = _VERTEX.finditer(data)
        bad = next(vertex for vertex in found if not all(map(is_number, vertex.groups())))
        line, text = data.count(b"\n", 0, bad.start()) + 1, bad[0].decode(errors="replace")
        raise line_error(path, line, repr(text), "a vertex: vertex x y z") from None


HEADER = "scaffold_cad binary STL, unit: {}"  # a header that starts with "solid" means text

TRIANGLE_BYTES = 36
"""What a triangle takes where it is worked on."""

MOST_TRIANGLES = 2**32 - 1
"""Triangles that the 32-bit number in the header can count."""


@register_writer(".stl", name="STL", skeletons=False)
def write_stl_content(content: Content, path: Path) -> None:
    """Write the triangles of anything that has a surface."""
    write_stl(content.triangles(), path, content.unit)


def write_stl(mesh: TriangleMesh, path: Path, unit: str = "mm") -> None:
    """Write `mesh` with 32-bit coordinates; a triangle without area has the normal 0.

    Raises
    ------
    FormatError
        If it has more triangles than the header can count.
    """
    _check_count(len(mesh.triangles))
    _write(_chunks(mesh), path, unit)


def _check_count(triangles: int) -> None:
    if triangles > MOST_TRIANGLES:
        raise FormatError(
            f"the surface has {triangles} triangles; an STL file holds {MOST_TRIANGLES} at most "
            "(fewer sides)"
        )


def _write(blocks: Iterable[np.ndarray], path: Path, unit: str = "mm") -> None:
    """Write triangles given by blocks of their corners (t, 3, 3), 32-bit."""
    count = 0
    with path.open("wb") as file:
        file.write(HEADER.format(unit).encode("ascii")[:80].ljust(80) + bytes(4))
        for corners in blocks:
            file.write(_records(corners))
            count += len(corners)
        file.seek(80)
        file.write(np.uint32(count).astype("<u4").tobytes())


def _records(corners: np.ndarray) -> bytes:
    """Return the records of facets with 32-bit corners (t, 3, 3)."""
    facets = np.zeros(len(corners), dtype=_FACET)
    facets["corners"] = corners
    facets["normal"] = _normals(corners)
    data: bytes = facets.tobytes()
    return data


def facets_of(corners: np.ndarray) -> bytes:
    """Return the content of a binary file of triangles with 32-bit corners (t, 3, 3), in mm."""
    _check_count(len(corners))
    count: bytes = np.uint32(len(corners)).astype("<u4").tobytes()
    return HEADER.format("mm").encode("ascii").ljust(80) + count + _records(corners)


COPIED = 1 << 22
"""Bytes copied at a time."""


def join_stl(files: Iterable[Path], path: Path) -> None:
    """Write the triangles of binary files in mm into one, in the order of the files.

    Raises
    ------
    FormatError
        If a file is not whole, or there are more triangles than the header can count.
    """
    count = 0
    with path.open("wb") as joined:
        joined.write(HEADER.format("mm").encode("ascii").ljust(80) + bytes(4))
        for file in files:
            with file.open("rb") as part:
                facets = int.from_bytes(part.read(_HEADER)[80:], "little")
                copied = 0
                while piece := part.read(COPIED):
                    joined.write(piece)
                    copied += len(piece)
            if copied != facets * _FACET.itemsize:
                raise FormatError(
                    f"{file} has {copied} bytes of triangles; need {facets * _FACET.itemsize}, as "
                    "its header says"
                )
            count += facets
            _check_count(count)
        joined.seek(80)
        joined.write(np.uint32(count).astype("<u4").tobytes())


def _chunks(mesh: TriangleMesh) -> Iterator[np.ndarray]:
    vertices = mesh.vertices.astype("<f4")
    with counting("triangles written", len(mesh.triangles)) as count:
        for triangles in cut(mesh.triangles, TRIANGLE_BYTES, CACHE):
            yield vertices[triangles]
            count.done += len(triangles)


def _normals(corners: np.ndarray) -> np.ndarray:
    """Return the unit normals (t, 3) of the triangles with `corners` (t, 3, 3)."""
    a, b, c = (np.ascontiguousarray(corners[:, k].T) for k in range(3))  # (3, t)
    first, second = b - a, c - a
    normals = np.empty_like(a)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        normals[k] = first[i] * second[j] - first[j] * second[i]
    lengths = np.sqrt((normals * normals).sum(axis=0))
    np.divide(normals, lengths, out=normals, where=lengths > 0)
    return normals.T
