"""What OCCT tells of round struts in a STEP file as read back: joins, axes and walls."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from build123d import Edge, Face, GeomType, Shape
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.TopAbs import TopAbs_IN, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scaffold_cad import Skeleton, TriangleMesh, to_trimesh
from scaffold_cad.base.arrays import Floats, Points
from tests.solid.field.judges import distances

ALONG_EDGES = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Where on an edge normals are looked at."""
ALONG_AXES = np.linspace(0.02, 0.98, 25)
"""Where on a strut's axis the solid is looked for."""
SAG = 0.01
"""Distance of triangles from the surface that walls are measured to, over the wall."""


def worst_join(shape: Shape) -> float:
    """Return the largest angle between normals of two faces at an edge, degrees.

    Edges of flat faces are sharp on purpose and do not count.
    """
    worst = 0.0
    for (edge, one), (_, other) in _shared_edges(shape):
        sides = [BRepAdaptor_Curve2d(edge.wrapped, face.wrapped) for face in (one, other)]
        first, last = sides[0].FirstParameter(), sides[0].LastParameter()
        for share in ALONG_EDGES:
            at = (1 - share) * first + share * last
            one_way, other_way = (
                _normal(face, side.Value(at))
                for face, side in zip((one, other), sides, strict=True)
            )
            sine = np.linalg.norm(np.cross(one_way, other_way))
            worst = max(worst, float(np.degrees(np.arctan2(sine, one_way @ other_way))))
    return worst


def axes_outside(shape: Shape, skeleton: Skeleton) -> int:
    """Return how many points of the struts' axes are not inside the solids."""
    start, end = np.moveaxis(skeleton.nodes[skeleton.edges], 1, 0)
    share = ALONG_AXES[:, None, None]
    points = ((1 - share) * start + share * end).reshape(-1, 3)
    left = list(range(len(points)))
    for solid in shape.solids():
        judge = BRepClass3d_SolidClassifier(solid.wrapped)
        missed = []
        for number in left:
            judge.Perform(gp_Pnt(*points[number].tolist()), 1e-7)
            if judge.State() != TopAbs_IN:
                missed.append(number)
        left = missed
    return len(left)


def least_wall(shape: Shape, wall: float) -> float:
    """Return the least distance from the inner to the outer faces of hollow struts, over `wall`.

    Flat faces, the rings at open ends, part the inner faces from the outer ones.
    """
    curved = [face for face in shape.faces() if face.geom_type != GeomType.PLANE]
    number = {face: k for k, face in enumerate(curved)}
    pairs = [(number[one], number[other]) for (_, one), (_, other) in _shared_edges(shape)]
    rows, columns = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(curved), len(curved)))
    count, label = connected_components(graph, directed=False)
    meshes = [_triangles([curved[k] for k in np.flatnonzero(label == part)], SAG * wall)
              for part in range(count)]  # fmt: skip
    sizes = [float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) for mesh in meshes]
    outer = meshes.pop(int(np.argmax(sizes)))
    points = np.concatenate([mesh.vertices for mesh in meshes])
    found: Floats = distances(points, to_trimesh(outer))
    return float(found.min()) / wall


def _shared_edges(shape: Shape) -> Iterator[list[tuple[Edge, Face]]]:
    """Yield the two uses of each edge that two faces share, neither of which is flat."""
    uses: dict[Edge, list[tuple[Edge, Face]]] = {}
    for face in shape.faces():
        if face.geom_type != GeomType.PLANE:
            for edge in face.edges():
                uses.setdefault(edge, []).append((edge, face))
    yield from (pair for pair in uses.values() if len(pair) == 2 and pair[0][1] != pair[1][1])


def _normal(face: Face, place: gp_Pnt2d) -> Floats:
    """Return the unit normal of a face at the parameters of one of its points, outward."""
    point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    BRepAdaptor_Surface(face.wrapped).D1(place.X(), place.Y(), point, along_u, along_v)
    normal = along_u.Crossed(along_v)
    across = np.array([normal.X(), normal.Y(), normal.Z()])
    found: Floats = across / np.linalg.norm(across)
    return -found if face.wrapped.Orientation() == TopAbs_REVERSED else found


def _triangles(faces: list[Face], sag: float) -> TriangleMesh:
    """Return triangles of faces, each by itself."""
    points: list[Points] = []
    triangles, count = [], 0
    for face in faces:
        BRepMesh_IncrementalMesh(face.wrapped, sag, False, 0.3)
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face.wrapped, place)
        own = [mesh.Node(k + 1).Transformed(place.Transformation()) for k in range(mesh.NbNodes())]
        points.append(np.array([[one.X(), one.Y(), one.Z()] for one in own]))
        corners = [mesh.Triangle(k + 1).Get() for k in range(mesh.NbTriangles())]
        triangles.append(np.array(corners) - 1 + count)
        count += len(own)
    return TriangleMesh(np.concatenate(points), np.concatenate(triangles))
