"""Triangles and straight lines as OCCT shapes; imports build123d and its OCP, as `occt.py` does.

Modules that are imported without being asked for a shape import this one inside their functions.
"""

from __future__ import annotations

import numpy as np
from build123d import Compound, Face, Shape, Solid
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Plane
from OCP.gp import gp_Dir, gp_Pnt
from OCP.Poly import Poly_Triangle, Poly_Triangulation
from OCP.TopoDS import (
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Wire,
)

from scaffold_cad.base.arrays import Edges, Ints, Points, Triangles, UnitVectors
from scaffold_cad.base.vectors import normalize
from scaffold_cad.brep.occt import TOLERANCE, edges_between, lines, shell_of, solid_of
from scaffold_cad.errors import BrepError


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


def solid_of_triangles(points: Points, triangles: Triangles, shell: Ints) -> Shape:
    """Return a solid of each closed shell of triangles, one plane face a triangle.

    Neighboring faces share their edges. Several solids are a Compound.

    Parameters
    ----------
    points, triangles : (p, 3) float64, mm, and (t, 3) intp
    shell : (t,) intp, shell of each triangle, numbered from 0

    Raises
    ------
    BrepError
        If a triangle has no area, and so no plane; it is named.
    """
    corners = points[triangles]
    normals = normalize(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    flat = np.flatnonzero(~normals.any(axis=1))
    if len(flat):
        raise BrepError(
            f"triangle {flat[0]} with vertices {triangles[flat[0]].tolist()} has no area; need "
            "some for a plane face"
        )
    solids = []
    for number in range(int(shell.max()) + 1):
        rows = shell == number
        faces = _faces(points, triangles[rows], normals[rows])
        solids.append(Solid(solid_of(shell_of(faces, True))))
    return solids[0] if len(solids) == 1 else Compound(solids)


def line_edges(points: Points, pairs: Edges) -> list[TopoDS_Edge]:
    """Return the straight edges between `pairs` (m, 2) of points; they share their vertices."""
    return edges_between(points, pairs, lines(points[pairs[:, 0]], points[pairs[:, 1]]))


def _faces(points: Points, triangles: Triangles, normals: UnitVectors) -> list[TopoDS_Face]:
    """Return a plane face on each triangle; neighbors share their edges."""
    builder = BRep_Builder()
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    used, index = np.unique(sides, return_inverse=True)
    index = index.reshape(-1, 2)
    pairs, edge_of_side = np.unique(np.sort(index, axis=1), axis=0, return_inverse=True)
    edges = line_edges(points[used], pairs)
    turned = [(edge, edge.Reversed()) for edge in edges]
    uses = 2 * edge_of_side.reshape(-1, 3) + (index[:, 0] > index[:, 1]).reshape(-1, 3)
    faces = []
    for (x, y, z), normal, three in zip(
        points[triangles[:, 0]].tolist(), normals.tolist(), uses.tolist(), strict=True
    ):
        face = TopoDS_Face()
        builder.MakeFace(face, Geom_Plane(gp_Pnt(x, y, z), gp_Dir(*normal)), TOLERANCE)
        wire = TopoDS_Wire()
        builder.MakeWire(wire)
        for use in three:
            builder.Add(wire, turned[use >> 1][use & 1])
        wire.Closed(True)
        builder.Add(face, wire)
        faces.append(face)
    return faces
