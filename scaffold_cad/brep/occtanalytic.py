"""Shapes of OCCT from a B-rep in arrays; imports build123d and its OCP, as `occt` does.

Edges are made once and shared. On planes OCCT works out curves in the parameters of faces by
itself; on all other surfaces they are given: straight lines, and splines for circles at the side
of a patch, whose parameter is not the circle's angle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from build123d import Compound, Shape, Shell, Solid
from OCP.BRep import BRep_Builder
from OCP.Geom import (
    Geom_BezierCurve,
    Geom_BezierSurface,
    Geom_BSplineCurve,
    Geom_BSplineSurface,
    Geom_Circle,
    Geom_ConicalSurface,
    Geom_Curve,
    Geom_CylindricalSurface,
    Geom_Ellipse,
    Geom_Line,
    Geom_Plane,
    Geom_SphericalSurface,
    Geom_Surface,
    Geom_ToroidalSurface,
)
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Solid, TopoDS_Vertex, TopoDS_Wire

from scaffold_cad.base.arrays import Floats
from scaffold_cad.brep.analytic import AnalyticBrep, BrepFaces, Curve, Knots, Surface
from scaffold_cad.brep.arcsides import arc_parameters
from scaffold_cad.brep.occt import (
    TOLERANCE,
    Integers,
    PlanePointRow,
    PointGrid,
    PointRow,
    Reals,
    collector_paused,
    shell_of,
)

POLE = 1e-9
"""Distance of a latitude from ±π/2 at which it is that of a pole, rad."""

OFF_FACES = 2e-9
"""How far edges are off their faces at most, in radii of the edge or the face: the sides of patches
off their circles, for example (see `ARC_ERROR` of `struts.blending.quarter`)."""


def make_shape(brep: AnalyticBrep, kind: str) -> Shape:
    """Return a build123d Solid or Shell, or a Compound of several, of closed shells.

    Parameters
    ----------
    kind : "solid", or "shell" for the shells that bound the solids
    """
    with collector_paused():
        faces = _faces(brep)
    builder = BRep_Builder()
    of_shell = [np.flatnonzero(brep.faces.shell == shell) for shell in range(len(brep.solid))]
    shells = [shell_of([faces[face] for face in chosen.tolist()], True) for chosen in of_shell]
    shapes: list[Shape] = []
    if kind == "shell":
        shapes += [Shell(shell) for shell in shells]
    else:
        for solid in range(int(brep.solid.max()) + 1):
            shape = TopoDS_Solid()
            builder.MakeSolid(shape)
            for shell in np.flatnonzero(brep.solid == solid).tolist():
                builder.Add(shape, shells[shell])
            shapes.append(Solid(shape))
    return shapes[0] if len(shapes) == 1 else Compound(shapes)


def _faces(brep: AnalyticBrep) -> list[TopoDS_Face]:
    """Return the faces, each turned so that it is seen from outside."""
    builder, faces = BRep_Builder(), brep.faces
    tolerances = _tolerances(brep)
    vertices = _vertices(brep, tolerances)
    edges = _edges(brep, vertices, tolerances)
    splines = {**dict(_arc_splines(brep)), **dict(_traces(brep))}
    starts, loops = faces.uses.tolist(), faces.loops.tolist()
    made = []
    for number, surface in enumerate(_surfaces(faces)):
        face = TopoDS_Face()
        builder.MakeFace(face, surface, TOLERANCE)
        is_plane = faces.kinds[number] == Surface.PLANE
        for loop in range(loops[number], loops[number + 1]):
            uses = range(starts[loop], starts[loop + 1])
            if not is_plane:
                _add_parameters(brep, face, list(uses), edges, splines)
            wire = TopoDS_Wire()
            builder.MakeWire(wire)
            for use in uses:
                edge = edges[faces.edge[use]]
                builder.Add(wire, edge if faces.forward[use] else edge.Reversed())
                tip = None if is_plane else _tip(brep, face, use, list(uses), vertices)
                if tip is not None:
                    builder.Add(wire, tip)
            wire.Closed(True)
            builder.Add(face, wire)
        made.append(face if faces.outward[number] else face.Reversed())
    return made


def _tolerances(brep: AnalyticBrep) -> Floats:
    """Return the tolerance of each vertex, (v,), mm; that of an edge is the larger of its ends'."""
    edges, faces = brep.edges, brep.faces
    radii = np.zeros(len(faces.kinds))
    radii[: len(faces.sizes)] = faces.sizes[:, 0]
    size = np.zeros(len(edges.ends))
    size[edges.kinds == Curve.CIRCLE] = edges.radii
    np.maximum.at(size, faces.edge, radii[faces.face_of_use])
    found = np.full(len(brep.vertices), TOLERANCE)
    np.maximum.at(found, edges.ends, OFF_FACES * size[:, None])
    return found + brep.slacks


def _vertices(brep: AnalyticBrep, tolerances: Floats) -> list[tuple[TopoDS_Vertex, TopoDS_Vertex]]:
    """Return each vertex as it begins an edge, and as it ends one."""
    builder = BRep_Builder()
    vertices = []
    for (x, y, z), tolerance in zip(brep.vertices.tolist(), tolerances.tolist(), strict=True):
        vertex = TopoDS_Vertex()
        builder.MakeVertex(vertex, gp_Pnt(x, y, z), tolerance)
        vertices.append((vertex, vertex.Reversed()))
    return vertices


def _edges(
    brep: AnalyticBrep, vertices: list[tuple[TopoDS_Vertex, TopoDS_Vertex]], tolerances: Floats
) -> list[TopoDS_Edge]:
    """Return the edges; they share their vertices."""
    builder = BRep_Builder()
    edges = []
    greatest = tolerances[brep.edges.ends].max(axis=1)
    for (start, end), tolerance, (curve, first, last) in zip(
        brep.edges.ends.tolist(), greatest.tolist(), _curves(brep), strict=True
    ):
        edge = TopoDS_Edge()
        builder.MakeEdge(edge, curve, tolerance)
        builder.Range(edge, first, last)
        builder.Add(edge, vertices[start][0])
        builder.Add(edge, vertices[end][1])
        edges.append(edge)
    return edges


def _curves(brep: AnalyticBrep) -> Iterator[tuple[Geom_Curve, float, float]]:
    """Yield the curve of each edge, and its first and last parameter."""
    edges = brep.edges
    lines = edges.counts[0]
    points = brep.vertices[edges.ends[:lines]]  # (l, 2, 3)
    spans = points[:, 1] - points[:, 0]
    lengths = np.linalg.norm(spans, axis=1)
    for start, span, last in zip(
        points[:, 0].tolist(), spans.tolist(), lengths.tolist(), strict=True
    ):
        yield Geom_Line(gp_Pnt(*start), gp_Dir(*span)), 0.0, last
    circles = edges.circles
    for origin, z, x, radius, lesser, (first, last) in zip(
        circles.origin.tolist(),
        circles.z.tolist(),
        circles.x.tolist(),
        edges.radii.tolist(),
        edges.lesser_radii.tolist(),
        edges.angles.tolist(),
        strict=True,
    ):
        place = gp_Ax2(gp_Pnt(*origin), gp_Dir(*z), gp_Dir(*x))
        is_circle = lesser == radius
        yield (
            Geom_Circle(place, radius) if is_circle else Geom_Ellipse(place, radius, lesser),
            first,
            last,
        )
    for table in edges.curves:
        row = PointRow(1, table.knots.count)
        knots = _knots(table.knots)
        for poles in table.control.tolist():
            for i, pole in enumerate(poles, start=1):
                row.SetValue(i, gp_Pnt(*pole))
            if table.knots.is_bezier:
                yield Geom_BezierCurve(row), 0.0, 1.0
            else:
                yield Geom_BSplineCurve(row, *knots, table.knots.degree), 0.0, 1.0


def _knots(knots: Knots) -> tuple[Reals, Integers]:
    """Return knots and how often each counts as OCCT takes them."""
    values, counts = Reals(1, len(knots.values)), Integers(1, len(knots.values))
    for i, (value, count) in enumerate(
        zip(knots.values.tolist(), knots.counts.tolist(), strict=True), start=1
    ):
        values.SetValue(i, value)
        counts.SetValue(i, count)
    return values, counts


def _surfaces(faces: BrepFaces) -> Iterator[Geom_Surface]:
    """Yield the surface of each face."""
    axes = faces.axes
    for kind, origin, z, x, (size, other) in zip(
        faces.kinds[: len(axes.origin)].tolist(),
        axes.origin.tolist(),
        axes.z.tolist(),
        axes.x.tolist(),
        faces.sizes.tolist(),
        strict=True,
    ):
        place = gp_Ax3(gp_Pnt(*origin), gp_Dir(*z), gp_Dir(*x))
        if kind == Surface.PLANE:
            yield Geom_Plane(place)
        elif kind == Surface.CYLINDER:
            yield Geom_CylindricalSurface(place, size)
        elif kind == Surface.CONE:
            yield Geom_ConicalSurface(place, other, size)
        elif kind == Surface.SPHERE:
            yield Geom_SphericalSurface(place, size)
        else:
            yield Geom_ToroidalSurface(place, size, other)
    for table in faces.patches:
        wide, high = table.u.count, table.v.count
        grid = PointGrid(1, wide, 1, high)
        places = [(i, j) for i in range(1, wide + 1) for j in range(1, high + 1)]
        (across, across_counts), (along, along_counts) = _knots(table.u), _knots(table.v)
        for patch in table.control.reshape(len(table.control), -1, 3):
            for (i, j), pole in zip(places, patch.tolist(), strict=True):
                grid.SetValue(i, j, gp_Pnt(*pole))
            if table.u.is_bezier and table.v.is_bezier:
                yield Geom_BezierSurface(grid)
                continue
            yield Geom_BSplineSurface(
                grid, across, along, across_counts, along_counts, table.u.degree, table.v.degree
            )


def _add_parameters(
    brep: AnalyticBrep,
    face: TopoDS_Face,
    uses: list[int],
    edges: list[TopoDS_Edge],
    splines: dict[int, Geom2d_Curve],
) -> None:
    """Give the edges of a loop their curves in the parameters of the face."""
    builder, faces = BRep_Builder(), brep.faces
    first_of: dict[int, int] = {}
    for use in uses:
        edge = int(faces.edge[use])
        curve = splines.get(use) or _line(brep, use)
        if edge not in first_of:
            first_of[edge] = use
            builder.UpdateEdge(edges[edge], curve, face, TOLERANCE)
            continue
        # A seam: one curve for the edge as it is, one for the edge reversed.
        other = _line(brep, first_of[edge])
        both = (curve, other) if faces.forward[use] else (other, curve)
        builder.UpdateEdge(edges[edge], *both, face, TOLERANCE)


def _line(brep: AnalyticBrep, use: int) -> Geom2d_Line:
    """Return the line in the parameters of a face that goes along with the edge of a use."""
    faces = brep.faces
    start, end = faces.parameters[use]
    edge = int(faces.edge[use])
    first = _first_parameter(brep, edge)
    along = (end - start) / np.linalg.norm(end - start)
    origin = start - first * along
    return Geom2d_Line(gp_Pnt2d(*origin.tolist()), gp_Dir2d(*along.tolist()))


def _first_parameter(brep: AnalyticBrep, edge: int) -> float:
    edges = brep.edges
    circle = edge - edges.counts[0]
    return float(edges.angles[circle, 0]) if 0 <= circle < len(edges.radii) else 0.0


def _arc_splines(brep: AnalyticBrep) -> Iterator[tuple[int, Geom2d_Curve]]:
    """Yield the uses of circles at the sides of patches, and their curves in the parameters."""
    faces, edges = brep.faces, brep.edges
    face = faces.face_of_use
    is_arc = edges.kinds[faces.edge] == Curve.CIRCLE
    first_patch = len(faces.axes.origin)
    for table in faces.patches:
        in_table = (face >= first_patch) & (face < first_patch + len(table.control))
        uses = np.flatnonzero(is_arc & in_table)
        circle = faces.edge[uses] - edges.counts[0]
        x, z = edges.circles.x[circle], edges.circles.z[circle]
        v = faces.parameters[uses, 0, 1]  # circles are at v = 0 or v = 1
        row = np.where(v > 0.5, table.v.count - 1, 0)
        coefficients = arc_parameters(
            table.control[face[uses] - first_patch, :, row],
            table.u,
            edges.circles.origin[circle],
            x,
            np.cross(z, x),
            edges.angles[circle],
            faces.parameters[uses][:, :, 0],
        )
        for use, poles, height, (first, last) in zip(
            uses.tolist(),
            coefficients.tolist(),
            v.tolist(),
            edges.angles[circle].tolist(),
            strict=True,
        ):
            yield use, _spline(poles, height, first, last)
        first_patch += len(table.control)


def _traces(brep: AnalyticBrep) -> Iterator[tuple[int, Geom2d_Curve]]:
    """Yield the uses that have a trace, and that curve over the parameter of their edge."""
    faces, edges = brep.faces, brep.edges
    first, last = np.zeros(len(edges.ends)), np.ones(len(edges.ends))
    round_ones = slice(edges.counts[0], edges.counts[0] + edges.counts[1])
    first[round_ones], last[round_ones] = edges.angles.T
    for table in faces.traces:
        count = table.knots.count
        for use, control in zip(table.use.tolist(), table.control.tolist(), strict=True):
            start, end = first[faces.edge[use]], last[faces.edge[use]]
            values = start + (end - start) * table.knots.values
            poles = PlanePointRow(1, count)
            for i, (u, v) in enumerate(control, start=1):
                poles.SetValue(i, gp_Pnt2d(u, v))
            knots = _knots(Knots(values, table.knots.counts))
            yield use, Geom2d_BSplineCurve(poles, *knots, table.knots.degree)


def _spline(row: list[float], v: float, first: float, last: float) -> Geom2d_BSplineCurve:
    """Return the curve at a height `v` whose u is a polynomial on [first, last]."""
    count = len(row)
    poles, knots, multiplicities = PlanePointRow(1, count), Reals(1, 2), Integers(1, 2)
    for i, u in enumerate(row, start=1):
        poles.SetValue(i, gp_Pnt2d(u, v))
    for i, knot in ((1, first), (2, last)):
        knots.SetValue(i, knot)
        multiplicities.SetValue(i, count)
    return Geom2d_BSplineCurve(poles, knots, multiplicities, count - 1)


def _tip(
    brep: AnalyticBrep,
    face: TopoDS_Face,
    use: int,
    uses: list[int],
    vertices: list[tuple[TopoDS_Vertex, TopoDS_Vertex]],
) -> TopoDS_Edge | None:
    """Return the edge without length at the pole of a sphere that a loop passes after a use."""
    faces = brep.faces
    following = uses[(uses.index(use) + 1) % len(uses)]
    here = faces.parameters[use, 1 if faces.forward[use] else 0]
    there = faces.parameters[following, 0 if faces.forward[following] else 1]
    at_pole = abs(abs(here[1]) - np.pi / 2) < POLE and abs(here[1] - there[1]) < POLE
    if not at_pole or abs(here[0] - there[0]) < POLE:
        return None
    edge_ends = brep.edges.ends[faces.edge[use]]
    number = int(edge_ends[1] if faces.forward[use] else edge_ends[0])
    builder, tip = BRep_Builder(), TopoDS_Edge()
    builder.MakeEdge(tip)
    span = float(there[0] - here[0])
    line = Geom2d_Line(gp_Pnt2d(*here.tolist()), gp_Dir2d(np.sign(span), 0.0))
    builder.UpdateEdge(tip, line, face, TOLERANCE)
    builder.Range(tip, 0.0, abs(span))
    builder.Add(tip, vertices[number][0])
    builder.Add(tip, vertices[number][1])
    builder.Degenerated(tip, True)
    return tip
