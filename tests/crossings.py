"""Whether triangles cross, by CGAL: in exact arithmetic, and without a line of this package."""

from __future__ import annotations

import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from scaffold_cad.base.arrays import Points, Triangles
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh

INSTALLED = find_spec("CGAL") is not None


def check_as_written(mesh: TriangleMesh) -> None:
    """Assert that a surface is closed, manifold and free of crossings in 32-bit coordinates.

    Without CGAL, as on platforms that it has no wheels for, the package's own exact test looks.
    """
    rounded = mesh.vertices.astype(np.float32).astype(np.float64)
    check_whole(TriangleMesh(rounded, mesh.triangles))


def check_whole(mesh: TriangleMesh) -> None:
    """Assert that a surface is closed, manifold and free of crossings as it is."""
    if INSTALLED:
        assert faults_by_cgal(mesh.vertices, mesh.triangles) == ""
    else:
        places, place = np.unique(mesh.vertices, axis=0, return_inverse=True)
        welded = TriangleMesh(places, place.reshape(-1)[mesh.triangles])
        welded.check_closed()
        assert len(self_intersections(welded)) == 0


def faults_by_cgal(vertices: Points, triangles: Triangles) -> str:
    """Return what CGAL finds wrong with a solid's surface, "" for nothing.

    Vertices at one place are one, as every reader of files without indices has them.
    """
    from CGAL.CGAL_Polygon_mesh_processing import does_self_intersect
    from CGAL.CGAL_Polyhedron_3 import Polyhedron_3

    places, place = np.unique(vertices + 0.0, axis=0, return_inverse=True)
    corners = place.reshape(-1)[triangles]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "surface.off"
        with path.open("w", encoding="ascii") as file:
            file.write(f"OFF\n{len(places)} {len(corners)} 0\n")
            np.savetxt(file, places, "%.17g")
            np.savetxt(file, np.column_stack([np.full(len(corners), 3), corners]), "%d")
        surface = Polyhedron_3(str(path))
    if surface.size_of_facets() != len(corners):
        return "no manifold"
    if not surface.is_closed():
        return "not closed"
    return "crosses itself" if does_self_intersect(surface) else ""
