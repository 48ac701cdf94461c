"""Triangles as the plane faces of a B-rep: what a union of struts becomes in CAD formats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad.base.arrays import Ints
from scaffold_cad.base.backends import need
from scaffold_cad.base.topology import component_labels
from scaffold_cad.errors import BrepError
from scaffold_cad.mesh.trianglemesh import TriangleMesh

if TYPE_CHECKING:
    from build123d import Shape

MOST_TRIANGLES = 10_000
"""Most triangles of a union that become faces: CAD programs are slow with more."""


def faceted(mesh: TriangleMesh) -> Shape:
    """Return a closed mesh as a B-rep, each triangle a plane face.

    Raises
    ------
    BrepError
        If it has more than 10 000 triangles, or one without area.
    """
    if len(mesh.triangles) > MOST_TRIANGLES:
        raise BrepError(
            f"the union of the struts has {len(mesh.triangles)} triangles; need "
            f"{MOST_TRIANGLES} or less for a B-rep (to_mesh_shape(to_solid(...)) shows and "
            "exports any number)"
        )
    need("build123d", "a B-rep")
    from scaffold_cad.brep import occtmeshes

    return occtmeshes.solid_of_triangles(mesh.vertices, mesh.triangles, _shell_of_triangle(mesh))


def _shell_of_triangle(mesh: TriangleMesh) -> Ints:
    """Return the shell of each triangle, shape (t,)."""
    links = mesh.triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    part = component_labels(links, len(mesh.vertices))
    _, shell = np.unique(part[mesh.triangles[:, 0]], return_inverse=True)
    return shell.reshape(-1)
