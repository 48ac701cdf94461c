"""Binary PLY files: quads stay quads, coordinates keep their 64 bits."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scaffold_cad.quadmesh import QuadMesh
from scaffold_cad.trianglemesh import TriangleMesh

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


def write_ply(mesh: QuadMesh | TriangleMesh, path: Path) -> None:
    """Write the vertices and the faces of `mesh`."""
    faces = mesh.quads if isinstance(mesh, QuadMesh) else mesh.triangles
    corners = faces.shape[1]
    rows = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", corners)])
    rows["count"] = corners
    rows["corners"] = faces
    with path.open("wb") as file:
        header = HEADER.format(vertices=len(mesh.vertices), faces=len(faces))
        file.write(header.encode("ascii"))
        file.write(mesh.vertices.astype("<f8").tobytes())
        file.write(rows.tobytes())
