"""Meshes by their edges: STL, PLY and OFF, through trimesh."""

from __future__ import annotations

import logging
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from scaffold_cad.arrays import Edges, Points, Triangles
from scaffold_cad.backends import need
from scaffold_cad.errors import FormatError
from scaffold_cad.io._formats import HEAD_SIZE, register_reader
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io._text import check_size, first_words
from scaffold_cad.repair import equal_positions

LARGEST_MESH = 2**28
"""Most bytes of a mesh file: five million triangles of STL."""

FLAT = 1e-3
"""Angle, rad, below which two triangles are one face that was cut: STL rounds to 32 bits."""

_STL_HEADER, _STL_FACET = 84, 50  # bytes

_log = logging.getLogger(__name__)


def _recognises_stl(head: bytes) -> bool:
    if head.lstrip().startswith(b"solid") and b"facet" in head:
        return True
    facets = int.from_bytes(head[80:84], "little")
    size = _STL_HEADER + _STL_FACET * facets
    return facets > 0 and size == len(head) and len(head) < HEAD_SIZE


def _recognises_ply(head: bytes) -> bool:
    return head.split(maxsplit=1)[:1] == [b"ply"]


def _recognises_off(head: bytes) -> bool:
    return first_words(head)[:1] == ["OFF"]


@register_reader("STL", ".stl", recognises=_recognises_stl)
def read_stl(path: Path) -> RawSkeleton:
    """Read the edges of an STL file, without those that cut a flat face in triangles."""
    return _edges_of(path, "stl")


@register_reader("PLY", ".ply", recognises=_recognises_ply)
def read_ply(path: Path) -> RawSkeleton:
    """Read the elements ``edge`` of a PLY file, or the edges of its faces where it has none."""
    return _edges_of(path, "ply")


@register_reader("OFF", ".off", recognises=_recognises_off)
def read_off(path: Path) -> RawSkeleton:
    """Read the edges of an OFF file, without those inside flat faces."""
    return _edges_of(path, "off")


def _edges_of(path: Path, kind: str) -> RawSkeleton:
    """Return the edges of a mesh, its radii unknown, lengths taken as mm.

    Corners at equal positions are one node. An edge between two triangles in a plane is left
    out: it is a diagonal of a face that the format, or trimesh, cut in triangles. So a flat
    plate that was meshed finely has only its border; a curved surface keeps all its edges.
    """
    need("trimesh", "a mesh file")
    check_size(path, LARGEST_MESH)
    import trimesh

    data = path.read_bytes()
    if kind == "stl":
        _check_stl(path, data)
    try:
        # Without a resolver: a mesh file may name others, which are nobody's business here.
        loaded = trimesh.load(BytesIO(data), file_type=kind, process=False)
        if kind == "ply" and not isinstance(loaded, trimesh.Trimesh):
            return RawSkeleton(loaded.vertices, _ply_edges(loaded))
        points, triangles = np.asarray(loaded.vertices), np.asarray(loaded.faces)
    # trimesh raises whatever a damaged file makes it raise, Exception itself included.
    except Exception as error:
        raise FormatError(f"{path} is no sound {kind.upper()} file: {error}; need one") from None
    if triangles.ndim != 2 or triangles.shape[1] != 3 or len(triangles) == 0:
        raise FormatError(f"{path} has no faces; need at least one")
    if triangles.min() < 0 or triangles.max() >= len(points):
        raise FormatError(f"{path} has a face with vertex {triangles.max()} of {len(points)}")
    node, first = equal_positions(points)
    edges = _sharp_edges(points[first], node[triangles])
    _log.info("%s: edges inside flat faces are left out", path)
    return RawSkeleton(points[first], edges)


def _check_stl(path: Path, data: bytes) -> None:
    """Raise if a binary STL is shorter than it says, or a text one has no end."""
    if data.lstrip().startswith(b"solid") and b"facet" in data[:HEAD_SIZE]:
        if b"endsolid" not in data[-HEAD_SIZE:]:
            raise FormatError(f"{path} has no 'endsolid': it was cut short; need the whole file")
        return
    size = _STL_HEADER + _STL_FACET * int.from_bytes(data[80:84], "little")
    if len(data) < _STL_HEADER or size != len(data):
        raise FormatError(f"{path} has {len(data)} bytes; need {size}, as its header says")


def _ply_edges(loaded: Any) -> Edges:
    columns = loaded.metadata["_ply_raw"]["edge"]["data"]
    ends = [np.asarray(columns[name]).reshape(-1) for name in ("vertex1", "vertex2")]
    return np.stack(ends, axis=1).astype(np.intp)


def _sharp_edges(points: Points, triangles: Triangles) -> Edges:
    """Return the edges (m, 2) of triangles (t, 3) that are not inside a flat face."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(area > 0, area, 1.0)[:, None]
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, edge, uses = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(edge.reshape(-1), kind="stable") // 3  # triangles, edge by edge
    start = np.cumsum(uses) - uses
    pair = np.stack([order[start], order[start + np.minimum(uses, 2) - 1]], axis=1)
    bend = np.linalg.norm(normals[pair[:, 0]] - normals[pair[:, 1]], axis=1)
    solid = (area[pair] > 0).all(axis=1)
    inside = (uses == 2) & solid & (bend < FLAT) & (edges[:, 0] != edges[:, 1])
    sharp: Edges = edges[~inside]
    return sharp
