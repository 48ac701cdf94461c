"""Binary PLY files: quads stay quads, coordinates keep their 64 bits."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from scaffold_cad.base.arrays import Ints
from scaffold_cad.errors import FormatError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.smooth import FineSurface

HEADER = """\
ply
format binary_little_endian 1.0
comment scaffold_cad
comment unit: mm
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


def write_ply(mesh: QuadMesh | TriangleMesh, path: Path) -> None:
    """Write the vertices and the faces of `mesh`.

    Raises
    ------
    FormatError
        If it has more vertices than PLY indices can tell apart.
    """
    _check_count(len(mesh.vertices))
    faces = mesh.quads if isinstance(mesh, QuadMesh) else mesh.triangles
    with path.open("wb") as file:
        _write_header(file, len(mesh.vertices), len(faces))
        file.write(mesh.vertices.astype("<f8").tobytes())
        _write_faces(file, faces)


def write_ply_slabs(surface: FineSurface, slabs: int | None, path: Path) -> None:
    """Write the vertices and the quads of `surface` slab by slab.

    Raises
    ------
    FormatError
        If it has more vertices than PLY indices can tell apart.
    """
    _check_count(surface.vertex_count)
    runs = surface.cut(slabs)
    with path.open("wb") as file:
        _write_header(file, surface.vertex_count, surface.quad_count)
        for rows in runs:
            file.write(surface.vertices(rows).astype("<f8").tobytes())
        for rows in runs:
            _write_faces(file, surface.quads(rows))


def _check_count(vertices: int) -> None:
    if vertices > MOST_VERTICES:
        raise FormatError(
            f"the surface has {vertices} vertices; a PLY file holds {MOST_VERTICES} at most "
            "(lower the levels)"
        )


def _write_header(file: BinaryIO, vertices: int, faces: int) -> None:
    file.write(HEADER.format(vertices=vertices, faces=faces).encode("ascii"))


def _write_faces(file: BinaryIO, faces: Ints) -> None:
    corners = faces.shape[1]
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", corners)])
    rows["count"] = corners
    rows["corners"] = faces
    file.write(rows.tobytes())
