"""Wavefront OBJ files: quads stay quads, and the edges of skeletons are lines."""

from __future__ import annotations

from pathlib import Path
from typing import TextIO

import numpy as np

from scaffold_cad.mesh.quadmesh import QuadMesh
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.skeleton import Skeleton

CHUNK = 1 << 15
"""Rows that are formatted at once: bounds the memory that their texts take."""


def write_obj(mesh: QuadMesh | TriangleMesh, path: Path) -> None:
    """Write the vertices, exact to the last bit, and the faces of `mesh`."""
    faces = mesh.quads if isinstance(mesh, QuadMesh) else mesh.triangles
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("# scaffold_cad\n# unit: mm\n")
        _write_rows(file, "v %r %r %r\n", mesh.vertices)
        _write_rows(file, "f" + " %d" * faces.shape[1] + "\n", faces + 1)


def write_obj_lines(skeleton: Skeleton, path: Path) -> None:
    """Write the nodes, exact to the last bit, and the edges; OBJ has no place for radii."""
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("# scaffold_cad\n# unit: mm\n")
        _write_rows(file, "v %r %r %r\n", skeleton.nodes)
        _write_rows(file, "l %d %d\n", skeleton.edges + 1)


def _write_rows(file: TextIO, template: str, rows: np.ndarray) -> None:
    for start in range(0, len(rows), CHUNK):
        chunk = rows[start : start + CHUNK]
        file.write(template * len(chunk) % tuple(chunk.reshape(-1).tolist()))
