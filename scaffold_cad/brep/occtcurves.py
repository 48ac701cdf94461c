"""Edges of OCCT as points, and the edges in CAD files; imports OCP, and not build123d."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepTools import BRepTools
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Shape

from scaffold_cad.base.arrays import Points

TURN = np.pi / 6
"""Largest turn from one joint to the next along a curve, rad: a circle gets 12 of them."""

CLOSEST = 1e-7
"""Least distance that chords are asked to keep from their curve, mm."""

as_edge = TopoDS.Edge_s if hasattr(TopoDS, "Edge_s") else TopoDS.Edge  # OCP 7 and 8

EDGE, FACE = TopAbs_ShapeEnum.TopAbs_EDGE, TopAbs_ShapeEnum.TopAbs_FACE


def sampled(edge: TopoDS_Edge, tolerance: float) -> Points:
    """Return points along an edge whose chords are within `tolerance` of it, (k, 3)."""
    sampler = GCPnts_TangentialDeflection(BRepAdaptor_Curve(edge), TURN, tolerance)
    inner = [sampler.Value(i) for i in range(2, sampler.NbPoints())]
    # Its ends where the edges that it meets have theirs.
    ends = [BRep_Tool.Pnt_s(end(edge)) for end in (TopExp.FirstVertex_s, TopExp.LastVertex_s)]
    points = [ends[0], *inner, ends[1]]
    return np.array([(point.X(), point.Y(), point.Z()) for point in points])


def free_edges(shape: TopoDS_Shape) -> list[TopoDS_Edge]:
    """Return each edge of a shape once that bounds no face and is not a single point."""
    known = _Shapes()
    for face in _parts(shape, FACE):
        for edge in _parts(face, EDGE):
            known.add(edge)
    edges = [as_edge(edge) for edge in _parts(shape, EDGE) if known.add(edge)]
    return [edge for edge in edges if not BRep_Tool.Degenerated_s(edge)]


def face_count(shape: TopoDS_Shape) -> int:
    """Return the number of faces of a shape."""
    return sum(1 for _ in _parts(shape, FACE))


def polylines(shape: TopoDS_Shape, sagitta: float) -> list[Points]:
    """Return points along each edge of a shape that bounds no face, each of shape (k, 3).

    Parameters
    ----------
    sagitta : how far a chord may be from its curve, as a fraction of the curve's size
    """
    found = []
    for edge in free_edges(shape):
        box = Bnd_Box()
        BRepBndLib.Add_s(edge, box)
        size = 0.0 if box.IsVoid() else float(np.sqrt(box.SquareExtent()))
        found.append(sampled(edge, max(sagitta * size, CLOSEST)))
    return found


def read_shape(path: Path) -> TopoDS_Shape:
    """Return what a STEP, IGES or BREP file holds, mm.

    Raises
    ------
    RuntimeError
        If OCCT cannot read it.
    """
    suffix = path.suffix.lower()
    if suffix == ".brep":
        shape = TopoDS_Shape()
        if not BRepTools.Read_s(shape, str(path), BRep_Builder()):
            raise RuntimeError("OCCT cannot read it")
    else:
        is_iges = suffix in (".igs", ".iges")
        shape = _exchanged(path, IGESControl_Reader if is_iges else STEPControl_Reader)
    if shape is None or shape.IsNull():
        raise RuntimeError("it holds no shape")
    return shape


def _exchanged(path: Path, reader_of: Callable[[], Any]) -> TopoDS_Shape:
    reader = reader_of()
    if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise RuntimeError("OCCT cannot read it")
    reader.TransferRoots()
    return reader.OneShape()


def _parts(shape: TopoDS_Shape, kind: Any) -> Iterator[TopoDS_Shape]:
    """Yield each part of a kind, as often as it is there."""
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


class _Shapes:
    """A set of shapes, in which a shape and its reverse are the same."""

    def __init__(self) -> None:
        self._by_hash: dict[int, list[TopoDS_Shape]] = {}

    def add(self, shape: TopoDS_Shape) -> bool:
        """Add a shape; return whether it is new."""
        alike = self._by_hash.setdefault(hash(shape), [])
        if any(shape.IsSame(other) for other in alike):
            return False
        alike.append(shape)
        return True
