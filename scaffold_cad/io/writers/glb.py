"""GLB files (binary glTF 2.0) through trimesh."""

from __future__ import annotations

from pathlib import Path

from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.solid.manifolds import to_trimesh

METRES_PER_MM = 0.001


def write_glb(mesh: TriangleMesh, path: Path) -> None:
    """Write `mesh` as glTF has it: in metres, y up, so (x, y, z) mm is at (x, z, -y) / 1000."""
    turned = mesh.vertices[:, [0, 2, 1]] * (METRES_PER_MM, METRES_PER_MM, -METRES_PER_MM)
    path.write_bytes(to_trimesh(TriangleMesh(turned, mesh.triangles)).export(file_type="glb"))
