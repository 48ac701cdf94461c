"""Binary STL files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from scaffold_cad.errors import FormatError
from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.smooth import FineSurface

HEADER = b"scaffold_cad binary STL, unit: mm"  # a header that starts with "solid" means text

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

CHUNK = 1 << 16
"""Triangles at a time: what is worked on stays in the processor's cache."""


MOST_TRIANGLES = 2**32 - 1
"""Triangles that the 32-bit number in the header can count."""


def write_stl(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` with 32-bit coordinates; a triangle without area has the normal 0.

    Raises
    ------
    FormatError
        If it has more triangles than the header can count.
    """
    _check_count(len(mesh.triangles))
    _write(_chunks(mesh), path)


def write_stl_slabs(surface: FineSurface, slabs: int | None, path: Path) -> None:
    """Write `surface` slab by slab, with 32-bit coordinates.

    Triangles two of whose corners fall on one place are left out, as in
    `TriangleMesh.single_precision`.

    Raises
    ------
    FormatError
        If it has more triangles than the header can count.
    """
    _check_count(2 * surface.quad_count)
    _write(_slab_chunks(surface, slabs), path)


def _check_count(triangles: int) -> None:
    if triangles > MOST_TRIANGLES:
        raise FormatError(
            f"the surface has {triangles} triangles; an STL file holds {MOST_TRIANGLES} at most "
            "(lower the levels)"
        )


def _write(blocks: Iterable[np.ndarray], path: Path) -> None:
    """Write triangles given by blocks of their corners (t, 3, 3), 32-bit."""
    count = 0
    with path.open("wb") as file:
        file.write(HEADER.ljust(80) + bytes(4))
        for corners in blocks:
            facets = np.zeros(len(corners), dtype=FACET)
            facets["corners"] = corners
            facets["normal"] = _normals(corners)
            file.write(facets.tobytes())
            count += len(corners)
        file.seek(80)
        file.write(np.uint32(count).astype("<u4").tobytes())


def _chunks(mesh: TriangleMesh) -> Iterator[np.ndarray]:
    vertices = mesh.vertices.astype("<f4")
    for start in range(0, len(mesh.triangles), CHUNK):
        yield vertices[mesh.triangles[start : start + CHUNK]]


def _slab_chunks(surface: FineSurface, slabs: int | None) -> Iterator[np.ndarray]:
    for rows in surface.cut(slabs):
        corners = surface.corners(rows)
        quads = np.arange(4 * len(corners)).reshape(-1, 4)
        slab = QuadMesh(corners.reshape(-1, 3), quads)
        for chunk in _chunks(TriangleMesh(slab.vertices, slab.triangles)):
            yield chunk[(chunk != np.roll(chunk, 1, axis=1)).any(axis=2).all(axis=1)]


def _normals(corners: np.ndarray) -> np.ndarray:
    """Return the unit normals (t, 3) of the triangles with `corners` (t, 3, 3)."""
    first = corners[:, 1] - corners[:, 0]
    second = corners[:, 2] - corners[:, 0]
    normals = np.cross(first, second)
    lengths = np.sqrt(np.einsum("ti,ti->t", normals, normals))[:, None]
    np.divide(normals, lengths, out=normals, where=lengths > 0)
    return normals
