"""B-rep topology and files by OCCT.

Importing build123d and its OCP takes seconds: `brep.py` imports this module in its functions.

Neighboring faces share their `TopoDS_Edge` and `TopoDS_Vertex` from the start: there is nothing
to sew, and every tolerance is `TOLERANCE`.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from build123d import Compound, PrecisionMode, Shape, Shell, Solid, Unit
from build123d import export_brep as write_brep_file
from build123d import export_step as write_step_file
from build123d import import_brep as read_brep_file
from build123d import import_step as read_step_file
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.Geom import (
    Geom_BezierCurve,
    Geom_BezierSurface,
    Geom_Curve,
    Geom_Line,
    Geom_Plane,
    Geom_Surface,
)
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.IMeshTools import IMeshTools_Parameters
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
from OCP.STEPControl import STEPControl_Controller
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import (
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)

from scaffold_cad.base.arrays import Edges, Points, Triangles
from scaffold_cad.base.blocks import blocks
from scaffold_cad.base.vectors import length
from scaffold_cad.brep.beziermesh import BezierMesh
from scaffold_cad.errors import BrepError

try:  # OCP 8, of build123d 0.13
    from OCP.collections import Array1_double as Reals
    from OCP.collections import Array1_gp_Pnt as PointRow
    from OCP.collections import Array1_gp_Pnt2d as PlanePointRow
    from OCP.collections import Array1_int as Integers
    from OCP.collections import Array2_gp_Pnt as PointGrid
except ImportError:  # OCP 7.9, of build123d 0.12
    from OCP.TColgp import TColgp_Array1OfPnt as PointRow
    from OCP.TColgp import TColgp_Array1OfPnt2d as PlanePointRow
    from OCP.TColgp import TColgp_Array2OfPnt as PointGrid
    from OCP.TColStd import TColStd_Array1OfInteger as Integers
    from OCP.TColStd import TColStd_Array1OfReal as Reals

TOLERANCE = 1e-7
"""Tolerance of every vertex, edge and face, mm: OCCT's Precision::Confusion."""

UNCERTAINTY = 2.0
"""What STEP files say of how exact they are, over the greatest tolerance of a shape."""

UNIT_SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
"""Parameters (u, v) of a patch's corners in the order of its quad."""

__all__ = [
    "Integers",
    "PlanePointRow",
    "PointGrid",
    "PointRow",
    "Reals",
]

OBJECT_BYTES = 40
"""What a number takes as a Python object in a list."""


def make_shape(
    patches: BezierMesh, shells: Sequence[Sequence[int]], closed: Sequence[bool], kind: str
) -> Shape:
    """Return a `kind` of each shell, and a Compound of several.

    Parameters
    ----------
    patches : the surfaces
    shells : the quads of each shell
    closed : whether each shell is closed
    kind : "solid" or "shell"
    """
    with collector_paused():
        faces = _faces(patches)
    shapes = []
    for quads, is_closed in zip(shells, closed, strict=True):
        shell = shell_of([faces[quad] for quad in quads], is_closed)
        # `Solid(Shell)` would run a repair that takes longer than all the rest.
        shapes.append(Solid(solid_of(shell)) if kind == "solid" else Shell(shell))
    return shapes[0] if len(shapes) == 1 else Compound(shapes)


def _faces(patches: BezierMesh) -> list[TopoDS_Face]:
    """Return a face on each patch; neighbors share their edges."""
    builder = BRep_Builder()
    mesh = patches.mesh
    edges = edges_between(mesh.vertices, mesh.edges, _curves(patches))
    turned = [(edge, edge.Reversed()) for edge in edges]
    uses = 2 * patches.mesh.edge_of_half_edge.reshape(-1, 4) + ~patches.runs_forward
    side_curve = _side_curves(patches)
    faces = []
    for (surface, needs_curves), sides in zip(_surfaces(patches), uses.tolist(), strict=True):
        face = TopoDS_Face()
        builder.MakeFace(face, surface, TOLERANCE)
        wire = TopoDS_Wire()
        builder.MakeWire(wire)
        for side, use in enumerate(sides):
            if needs_curves:
                builder.UpdateEdge(edges[use >> 1], side_curve(side, use), face, TOLERANCE)
            builder.Add(wire, turned[use >> 1][use & 1])
        wire.Closed(True)
        builder.Add(face, wire)
        faces.append(face)
    return faces


def edges_between(
    points: Points, pairs: Edges, curves: Iterable[tuple[Geom_Curve, float]]
) -> list[TopoDS_Edge]:
    """Return the edges between `pairs` (m, 2) of points; they share their vertices.

    Parameters
    ----------
    curves : of each edge, and its last parameter; the first is 0
    """
    builder = BRep_Builder()
    starts, ends = [], []
    for x, y, z in points.tolist():
        vertex = TopoDS_Vertex()
        builder.MakeVertex(vertex, gp_Pnt(x, y, z), TOLERANCE)
        starts.append(vertex)
        ends.append(vertex.Reversed())
    edges = []
    for (start, end), (curve, last) in zip(pairs.tolist(), curves, strict=True):
        edge = TopoDS_Edge()
        builder.MakeEdge(edge, curve, TOLERANCE)
        builder.Range(edge, 0.0, last)
        builder.Add(edge, starts[start])
        builder.Add(edge, ends[end])
        edges.append(edge)
    return edges


def _curves(patches: BezierMesh) -> Iterator[tuple[Geom_Curve, float]]:
    """Yield the curve of each edge and its last parameter; the first is 0."""
    points = patches.edge_control_points
    if patches.degree == 1:
        yield from lines(points[:, 0], points[:, 1])
        return
    row = PointRow(1, patches.degree + 1)
    poles: list[list[float]]
    for poles in points.tolist():
        for i, (x, y, z) in enumerate(poles, start=1):
            row.SetValue(i, gp_Pnt(x, y, z))
        yield Geom_BezierCurve(row), 1.0


def lines(starts: Points, ends: Points) -> Iterator[tuple[Geom_Line, float]]:
    """Yield the line from each start to its end (m, 3), and its parameter there."""
    spans = ends - starts
    for (x, y, z), (dx, dy, dz), last in zip(
        starts.tolist(), spans.tolist(), length(spans).tolist(), strict=True
    ):
        yield Geom_Line(gp_Pnt(x, y, z), gp_Dir(dx, dy, dz)), last


def _surfaces(patches: BezierMesh) -> Iterator[tuple[Geom_Surface, bool]]:
    """Yield the surface of each patch, and whether its edges need curves in its parameters.

    On a plane OCCT works them out by itself.
    """
    count = patches.degree + 1
    grid = PointGrid(1, count, 1, count)
    places = [(i, j) for i in range(1, count + 1) for j in range(1, count + 1)]
    points = patches.control_points.reshape(-1, count**2, 3)
    normals = patches.plane_normals
    for chunk in blocks(len(points), 3 * len(places) * OBJECT_BYTES):
        for poles, normal in zip(points[chunk].tolist(), normals[chunk].tolist(), strict=True):
            if any(normal):
                yield _plane(poles[0], poles[2], normal), False
                continue
            for (i, j), (x, y, z) in zip(places, poles, strict=True):
                grid.SetValue(i, j, gp_Pnt(x, y, z))
            yield Geom_BezierSurface(grid), True


def _plane(origin: list[float], along: list[float], normal: list[float]) -> Geom_Plane:
    """Return the plane through `origin` with x toward `along` and z along `normal`."""
    x = gp_Dir(*(b - a for a, b in zip(origin, along, strict=True)))
    return Geom_Plane(gp_Ax3(gp_Pnt(*origin), gp_Dir(*normal), x))


def _side_curves(patches: BezierMesh) -> Callable[[int, int], Geom2d_Curve]:
    """Return what gives the curve of an edge along a side of the unit square.

    It takes the side and 2 e for edge e, or 2 e + 1 where the side runs against it; the curve has
    the edge's own parameter.
    """
    sides = list(zip(UNIT_SQUARE, UNIT_SQUARE[1:] + UNIT_SQUARE[:1], strict=True))
    if patches.degree > 1:
        lines = [(_unit_line(start, end), _unit_line(end, start)) for start, end in sides]
        return lambda side, use: lines[side][use & 1]

    splines = [(_linear_spline(start, end), _linear_spline(end, start)) for start, end in sides]
    spans = patches.edge_control_points[:, 1] - patches.edge_control_points[:, 0]
    lengths = length(spans).tolist()

    def stretched(side: int, use: int) -> Geom2d_Curve:
        spline = splines[side][use & 1].Copy()
        spline.SetKnot(2, lengths[use >> 1])
        return spline

    return stretched


def _unit_line(start: tuple[float, float], end: tuple[float, float]) -> Geom2d_Line:
    """Return the line that is at `start` for 0 and at `end`, 1 away, for 1."""
    return Geom2d_Line(gp_Pnt2d(*start), gp_Dir2d(end[0] - start[0], end[1] - start[1]))


def _linear_spline(start: tuple[float, float], end: tuple[float, float]) -> Geom2d_BSplineCurve:
    """Return the spline of degree 1 from `start` for 0 to `end` for 1."""
    poles, knots, multiplicities = PlanePointRow(1, 2), Reals(1, 2), Integers(1, 2)
    for i, point in ((1, start), (2, end)):
        poles.SetValue(i, gp_Pnt2d(*point))
        knots.SetValue(i, i - 1.0)
        multiplicities.SetValue(i, 2)
    return Geom2d_BSplineCurve(poles, knots, multiplicities, 1)


def shell_of(faces: list[TopoDS_Face], is_closed: bool) -> TopoDS_Shell:
    """Return the shell that faces make."""
    builder = BRep_Builder()
    shell = TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    shell.Closed(is_closed)
    return shell


def solid_of(shell: TopoDS_Shell) -> TopoDS_Solid:
    """Return the solid inside a closed shell."""
    builder = BRep_Builder()
    solid = TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def tessellate(shape: Shape, distance: float, angle: float) -> tuple[Points, Triangles]:
    """Return vertices (v, 3), mm, and triangles (t, 3) of `shape`, each face with its own vertices.

    Triangles that `shape` may already have, as from a viewer, are neither used nor changed.

    Parameters
    ----------
    shape : a build123d shape with faces
    distance : largest distance of a triangle from its face that OCCT aims at, mm
    angle : largest angle between neighboring triangles of a face, rad

    Raises
    ------
    BrepError
        If OCCT finds no triangles for a face; it is named.
    """
    asked = IMeshTools_Parameters()
    # `Shape.mesh` would take the distance as a part of each edge's length, not in mm.
    asked.Deflection, asked.Angle, asked.Relative, asked.InParallel = distance, angle, False, True
    bare = BRepBuilderAPI_Copy(shape.wrapped, False, False).Shape()
    BRepMesh_IncrementalMesh(bare, asked)
    vertices, triangles, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.intp)], 0
    for number, face in enumerate(Shape.cast(bare).faces()):
        place = TopLoc_Location()
        found = BRep_Tool.Triangulation_s(face.wrapped, place)
        if found is None:
            raise BrepError(f"OCCT finds no triangles for face {number}; need a finite face")
        move = place.Transformation()
        nodes = [found.Node(i).Transformed(move) for i in range(1, found.NbNodes() + 1)]
        vertices.append(np.array([(node.X(), node.Y(), node.Z()) for node in nodes]))
        rows = np.array([triangle.Get() for triangle in found.Triangles()], dtype=np.intp)
        is_reversed = face.wrapped.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
        triangles.append((rows[:, ::-1] if is_reversed else rows) - 1 + count)
        count += len(nodes)
    return np.concatenate(vertices), np.concatenate(triangles)


def import_step(path: Path) -> Shape:
    """Return the shapes of a STEP file, in mm."""
    with _quiet():
        return read_step_file(path)


def import_brep(path: Path) -> Shape:
    """Return the shape in a BREP file."""
    with _quiet():
        return read_brep_file(path)


def export_step(shape: Shape, path: Path, *, write_pcurves: bool) -> bool:
    """Write `shape` to a STEP file in mm; return whether that worked.

    The file says how exact it is: ends of edges that a boolean left some nanometers apart are one
    vertex of the shape, and readers must take them for one too. OCCT by default says less.
    """
    greatest = ShapeAnalysis_ShapeTolerance().Tolerance(shape.wrapped, 1)
    with _quiet(), _restored("write.surfacecurve.mode", "write.precision.mode"):
        Interface_Static.SetRVal_s("write.precision.val", UNCERTAINTY * greatest)
        try:
            return bool(
                write_step_file(
                    shape,
                    path,
                    Unit.MM,
                    write_pcurves=write_pcurves,
                    precision_mode=PrecisionMode.SESSION,
                )
            )
        except RuntimeError:
            return False


def export_brep(shape: Shape, path: Path) -> bool:
    """Write `shape` to a BREP file; return whether that worked."""
    return bool(write_brep_file(shape, path))


@contextmanager
def collector_paused() -> Iterator[None]:
    """Keep Python from looking for cycles, which OCCT's objects never form, as they are made.

    It would look at all that exists again and again, and take a third of the time.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@contextmanager
def _restored(*settings: str) -> Iterator[None]:
    """Give OCCT's integer `settings`, which all of a process shares, back their values.

    The precision that files are written with, too.
    """
    STEPControl_Controller.Init_s()  # before it they have no values
    before = {name: Interface_Static.IVal_s(name) for name in settings}
    precision = Interface_Static.RVal_s("write.precision.val")
    try:
        yield
    finally:
        for name, value in before.items():
            Interface_Static.SetIVal_s(name, value)
        Interface_Static.SetRVal_s("write.precision.val", precision)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep OCCT from printing: on standard output, where results go; its failures are raised."""
    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    try:
        for printer in printers:
            messenger.RemovePrinter(printer)
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)
