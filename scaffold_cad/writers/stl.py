"""Binary STL files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.trianglemesh import TriangleMesh

HEADER = b"scaffold_cad binary STL, unit: mm"  # a header that starts with "solid" means text

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

CHUNK = 1 << 16
"""Triangles at a time: what is worked on stays in the processor's cache."""


def write_stl(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` with 32-bit coordinates; a triangle without area has the normal 0."""
    vertices = mesh.vertices.astype("<f4")
    with path.open("wb") as file:
        file.write(HEADER.ljust(80))
        file.write(np.uint32(len(mesh.triangles)).astype("<u4").tobytes())
        for start in range(0, len(mesh.triangles), CHUNK):
            corners = vertices[mesh.triangles[start : start + CHUNK]]
            facets = np.zeros(len(corners), dtype=FACET)
            facets["corners"] = corners
            facets["normal"] = _normals(corners)
            file.write(facets.tobytes())


def _normals(corners: np.ndarray) -> np.ndarray:
    """Return the unit normals (t, 3) of the triangles with `corners` (t, 3, 3)."""
    first = corners[:, 1] - corners[:, 0]
    second = corners[:, 2] - corners[:, 0]
    normals = np.cross(first, second)
    lengths = np.sqrt(np.einsum("ti,ti->t", normals, normals))[:, None]
    np.divide(normals, lengths, out=normals, where=lengths > 0)
    return normals
