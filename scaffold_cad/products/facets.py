"""Triangles as the plane faces of a B-rep: what a union of struts becomes in CAD formats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from scaffold_cad import brep
from scaffold_cad.brep.analytic import AnalyticBrep, Surface
from scaffold_cad.brep.facets import brep_of_triangles
from scaffold_cad.brep.joining import with_voids
from scaffold_cad.errors import BrepError
from scaffold_cad.mesh.pieces import pieces_of
from scaffold_cad.mesh.trianglemesh import TriangleMesh

if TYPE_CHECKING:
    from build123d import Shape

MOST_FACETS = 100_000
"""Most plane faces of a union: CAD programs are slow with more."""


def faceted(mesh: TriangleMesh) -> Shape:
    """Return a closed mesh as a B-rep, each triangle a plane face, see `facets_of`."""
    return brep.brep_of_faces(facets_of(mesh))


def facets_of(mesh: TriangleMesh) -> AnalyticBrep:
    """Return a plane face for each triangle of a closed mesh, a solid for each connected body.

    Raises
    ------
    BrepError
        If it has too many triangles, or one without area.
    """
    name = np.zeros(len(mesh.triangles), dtype=np.intp)
    faces = brep_of_triangles(mesh, name, ("union of struts",))
    check_facets(faces)
    pieces = pieces_of(mesh)
    void = np.zeros(len(faces.solid), dtype=np.bool_)
    void[faces.faces.shell[pieces.volumes[pieces.piece_of[mesh.triangles[:, 0]]] < 0]] = True
    return with_voids(faces, void)


def check_facets(faces: AnalyticBrep) -> None:
    """Raise if there are more plane faces than CAD programs work with."""
    count = int((faces.faces.kinds == Surface.PLANE).sum())
    if count > MOST_FACETS:
        raise BrepError(
            f"the union of the struts has {count} plane facets; need {MOST_FACETS} or less for a "
            "B-rep (to_mesh_shape(to_solid(...)) shows and exports any number)"
        )
