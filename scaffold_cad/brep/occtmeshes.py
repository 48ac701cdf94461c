"""Triangles and straight lines as OCCT shapes; imports build123d and its OCP, as `occt.py` does.

Modules that are imported without being asked for a shape import this one inside their functions.
"""

from __future__ import annotations

from build123d import Face
from OCP.BRep import BRep_Builder
from OCP.gp import gp_Pnt
from OCP.Poly import Poly_Triangle, Poly_Triangulation
from OCP.TopoDS import (
    TopoDS_Edge,
    TopoDS_Face,
)

from scaffold_cad.base.arrays import Edges, Points, Triangles
from scaffold_cad.brep.occt import edges_between, lines


def triangulated_face(points: Points, triangles: Triangles) -> Face:
    """Return one face without a surface that carries triangles (t, 3), as of an STL file."""
    # Triangles share their corners: OCCT would draw sides that belong to one triangle in black.
    mesh = Poly_Triangulation(len(points), len(triangles), False)
    for i, (x, y, z) in enumerate(points.tolist(), start=1):
        mesh.SetNode(i, gp_Pnt(x, y, z))
    for i, (a, b, c) in enumerate((triangles + 1).tolist(), start=1):
        mesh.SetTriangle(i, Poly_Triangle(a, b, c))
    mesh.ComputeNormals()  # so that viewers need not work them out
    face = TopoDS_Face()
    BRep_Builder().MakeFace(face, mesh)
    return Face(face)


def line_edges(points: Points, pairs: Edges) -> list[TopoDS_Edge]:
    """Return the straight edges between `pairs` (m, 2) of points; they share their vertices."""
    return edges_between(points, pairs, lines(points[pairs[:, 0]], points[pairs[:, 1]]))
