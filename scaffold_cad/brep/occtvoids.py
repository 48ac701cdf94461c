"""Solids with voids by OCCT: a solid moved inwards, cut by others, and taken out of a solid.

Imports build123d, as `occt` does.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

import numpy as np
from build123d import Face, Kind, Location, Shape, Solid
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepClass3d import BRepClass3d
from OCP.BRepLib import BRepLib
from OCP.BRepTools import BRepTools
from OCP.Geom import (
    Geom_OffsetSurface,
    Geom_RectangularTrimmedSurface,
    Geom_Surface,
    Geom_ToroidalSurface,
)
from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideAngle
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Solid

try:  # OCP 8, of build123d 0.13
    from OCP.collections import List_TopoDS_Shape as Shapes
except ImportError:  # OCP 7.9, of build123d 0.12
    from OCP.TopTools import TopTools_ListOfShape as Shapes

LOOSEST = 1e-3
"""Largest tolerance that edges of a solid moved inwards may have, mm. Where OCCT cannot make faces
meet it sets a larger one, and booleans of these go wrong, or end the process."""

SAME = 1e-7
"""Greatest distance of surfaces that are taken to be the same, mm."""
SECTOR = np.pi / 2
"""Greatest angle that a curved face goes around, rad. On whole cylinders and spheres, with a seam
and hundreds of holes where struts meet them, OCCT's booleans lose pieces, and its integrals of
volume are off."""


def moved_inwards(solid: Solid, distance: float) -> list[Solid]:
    """Return what OCCT makes of a solid whose faces are moved inwards, in the order to be tried.

    Where faces meet in an inner corner they are extended first, and joined by rounds second. Faces
    that go around an axis are parted in sectors. OCCT moves the faces of one shell: voids are made
    larger by themselves and cut out.
    """
    outer = BRepClass3d.OuterShell_s(solid.wrapped)
    voids = [shell for shell in solid.shells() if not shell.wrapped.IsSame(outer)]
    if not voids:
        return _moved(solid, -distance)
    found = []
    grown = [_moved(_filled(void), distance)[:1] for void in voids]
    for inner in _moved(_filled(Shape.cast(outer)), -distance):
        left = without(inner, [one for some in grown for one in some])
        if all(grown) and len(left) == 1 and left[0].is_valid:
            found += left
    return found


def _filled(shell: Shape) -> Solid:
    """Return the solid that a shell encloses, whichever way it faces."""
    made = BRep_Builder(), TopoDS_Solid()
    made[0].MakeSolid(made[1])
    made[0].Add(made[1], shell.wrapped)
    BRepLib.OrientClosedSolid_s(made[1])
    return Solid(made[1])


def _moved(solid: Solid, distance: float) -> list[Solid]:
    """Return what OCCT makes of a solid of one shell whose faces are moved outwards.

    It fails for whole spheres whose center is not at the origin: the solid is brought there.
    """
    found, center = [], solid.center()
    centered = solid.moved(Location(-center))
    for kind in (Kind.INTERSECTION, Kind.ARC):
        try:
            inner = centered.offset_3d(None, distance, kind=kind)
        except (RuntimeError, ValueError, AssertionError, AttributeError):  # OCCT gives up
            continue
        loosest = ShapeAnalysis_ShapeTolerance().Tolerance(inner.wrapped, 1)
        if len(inner.solids()) == 1 and inner.is_valid and loosest <= LOOSEST:
            found.append(_in_sectors(inner.solids()[0]).moved(Location(center)))
    return found


def _in_sectors(solid: Solid) -> Solid:
    """Return a solid whose curved faces are parted in sectors; as it is where OCCT fails."""
    divided = ShapeUpgrade_ShapeDivideAngle(SECTOR, solid.wrapped)
    divided.Perform()
    solids = Shape.cast(divided.Result()).solids()
    return solids[0] if len(solids) == 1 and solids[0].is_valid else solid


def without(solid: Solid, tools: Iterable[Shape]) -> list[Solid]:
    """Return the solids that are left of a solid without `tools`; none where OCCT gives up."""
    cut = BRepAlgoAPI_Cut()
    arguments, others = Shapes(), Shapes()
    arguments.Append(solid.wrapped)
    for tool in tools:
        others.Append(tool.wrapped)
    cut.SetArguments(arguments)
    cut.SetTools(others)
    cut.SetRunParallel(True)
    cut.SetNonDestructive(True)
    cut.SetUseOBB(True)
    cut.SetToFillHistory(False)
    try:
        cut.Build()
    except RuntimeError:
        return []
    return list(Shape.cast(cut.Shape()).solids()) if cut.IsDone() else []


def with_voids(solid: Solid, voids: Iterable[Solid]) -> tuple[Solid, int]:
    """Return a solid with voids in it, and how many loose pieces in the voids are left out.

    No boolean: the outer surfaces of the voids, turned inside out, become surfaces of the solid.
    """
    builder = BRep_Builder()
    made = TopoDS_Solid()
    builder.MakeSolid(made)
    for shell in solid.shells():
        builder.Add(made, shell.wrapped)
    loose = 0
    for void in voids:
        outer = BRepClass3d.OuterShell_s(void.wrapped)
        builder.Add(made, outer.Reversed())
        loose += len(void.shells()) - 1
    part = Solid(made)
    _make_tori(part)
    return part, loose


def _make_tori(shape: Shape) -> None:
    """Put faces of a shape that lie on offset surfaces of tori on the tori that these are.

    OCCT offsets a fillet that is wider than the corner it goes around as a surface of its own, and
    takes it for another one when it reads it from a STEP file. Its booleans come before: they lose
    pieces of tori that cross themselves. Faces are changed in place, those of the body too, whose
    surfaces stay where they are.
    """
    for face in shape.faces():
        place = TopLoc_Location()
        surface = BRep_Tool.Surface_s(face.wrapped, place)
        if not isinstance(surface, Geom_OffsetSurface):
            continue
        torus = surface.BasisSurface()
        if isinstance(torus, Geom_RectangularTrimmedSurface):  # a sector
            torus = torus.BasisSurface()
        if not isinstance(torus, Geom_ToroidalSurface):
            continue
        bounds = BRepTools.UVBounds_s(face.wrapped)
        for radius in torus.MinorRadius() + surface.Offset() * np.array([1.0, -1.0]):
            if radius > 0:
                other = Geom_ToroidalSurface(torus.Position(), torus.MajorRadius(), radius)
                if _gap(surface, other, bounds) < SAME:
                    _put_on(face, surface, other, place)


def _gap(one: Geom_Surface, other: Geom_Surface, bounds: tuple[float, ...]) -> float:
    """Return the greatest distance of two surfaces at equal parameters within `bounds`, mm."""
    lowest_u, highest_u, lowest_v, highest_v = bounds
    grid = product(np.linspace(lowest_u, highest_u, 5), np.linspace(lowest_v, highest_v, 5))
    return float(max(one.Value(u, v).Distance(other.Value(u, v)) for u, v in grid))


def _put_on(face: Face, surface: Geom_Surface, other: Geom_Surface, place: TopLoc_Location) -> None:
    """Put a face and its edges from a surface on another one that is equal at all parameters."""
    builder = BRep_Builder()
    builder.UpdateFace(face.wrapped, other, place, BRep_Tool.Tolerance_s(face.wrapped))
    for edge in face.edges():
        forward, backward = (
            Shape.cast(edge.wrapped.Oriented(way)).wrapped
            for way in (TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED)
        )
        tolerance = BRep_Tool.Tolerance_s(forward)
        is_seam = BRep_Tool.IsClosed_s(forward, surface, place)
        sides = (forward, backward) if is_seam else (forward,)
        curves = [BRep_Tool.CurveOnSurface_s(side, surface, place, 0.0, 0.0) for side in sides]
        builder.UpdateEdge(forward, *curves, other, place, tolerance)
