"""The surface of a build123d face over the unit square, for maps of cells on it.

Imports build123d and its OCP: who makes lattices on faces does so when one is given.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from build123d import Face
from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.GeomAbs import GeomAbs_CurveType
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

from scaffold_cad.base.arguments import check_kind
from scaffold_cad.base.arrays import Floats, Frozen, Ints, Points, UnitVectors
from scaffold_cad.base.positions import equal_positions
from scaffold_cad.base.vectors import length, normalize
from scaffold_cad.brep.surfacevalues import values_of
from scaffold_cad.errors import BrepError

BORDER_SAMPLES = 128
"""Sides of the polygon that a curved edge of a face is trimmed along."""

SAME_PARAMETER = 1e-7
"""Difference below which two parameters are the same, in ranges of the face."""

BESIDE = 1e-5
"""How far from a pole normals are taken, in ranges of the face."""

AROUND = 16
"""How many normals are taken around a pole."""


@dataclass(frozen=True, eq=False)
class FaceSurface(Frozen):
    """A face over the unit square of its own parameters.

    It closes where the face does, and is trimmed to its borders unless these are the square.
    """

    face: Face
    """The face, trimmed or not."""
    low: Floats
    """Parameters u and v of the face at (0, 0), shape (2,)."""
    high: Floats
    """Parameters at (1, 1), shape (2,)."""
    wraps: tuple[bool, bool]
    """Whether the face closes along u and along v."""
    loops: tuple[Floats, ...]
    """Its borders in the unit square, closed polygons (k, 2); none if they are the square."""

    patches = 1

    @classmethod
    def of(cls, face: Face) -> FaceSurface:
        """Return the surface of a face.

        Raises
        ------
        OptionError
            If it is not a face of build123d.
        BrepError
            If an edge of the face has no curve in its parameters, or the face has no area there.
        """
        check_kind(face, Face)
        borders = _borders(face)
        corners = np.concatenate(borders)
        low, high = corners.min(axis=0), corners.max(axis=0)
        if not (high > low).all():
            raise BrepError(
                f"the face has parameters from {low.tolist()} to {high.tolist()}; need an area"
            )
        unit = [(border - low) / (high - low) for border in borders]
        on_square = all(
            bool((np.minimum(np.abs(one), np.abs(one - 1)).min(axis=1) < SAME_PARAMETER).all())
            for one in unit
        )
        surface = BRepAdaptor_Surface(face.wrapped)
        wraps = (
            _closes(surface.IsUClosed(), surface, 0, low, high),
            _closes(surface.IsVClosed(), surface, 1, low, high),
        )
        return cls(face, low, high, wraps, () if on_square else tuple(unit))

    def at(self, places: Floats, patch: Ints) -> tuple[Points, UnitVectors]:  # noqa: ARG002
        """Return positions (n, 3) and outward unit normals (n, 3) at places (n, 2)."""
        parameters = self.low + places * (self.high - self.low)
        points, across_u, across_v = values_of(BRepAdaptor_Surface(self.face.wrapped), parameters)
        normals = np.cross(across_u, across_v)
        size = length(normals)
        poles = np.flatnonzero(size <= 1e-9 * size.max(initial=0.0))
        if len(poles):
            normals[poles] = self._normals_at_poles(places[poles], points[poles])
        if self.face.wrapped.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            normals = -normals
        return points, normalize(normals)

    def _normals_at_poles(self, places: Floats, points: Points) -> Floats:
        """Return a normal (n, 3) at each of several poles: the mean of those around it."""
        around = (np.arange(AROUND) + 0.5) / AROUND
        normals = np.empty_like(points)
        pole, first = equal_positions(np.round(points, 9))
        for k, row in enumerate(first.tolist()):
            beside = places[row] + BESIDE * np.sign(0.5 - places[row])  # (2,)
            # The side that is a point is the one at an end of its parameter.
            along = 0 if min(places[row, 1], 1 - places[row, 1]) < SAME_PARAMETER else 1
            ring = np.tile(beside, (AROUND, 1))
            ring[:, along] = around
            _, du, dv = values_of(
                BRepAdaptor_Surface(self.face.wrapped), self.low + ring * (self.high - self.low)
            )
            normals[pole == k] = normalize(np.cross(du, dv)).sum(axis=0)
        return normals


def _closes(
    closed: bool, surface: BRepAdaptor_Surface, axis: int, low: Floats, high: Floats
) -> bool:
    """Return whether the face goes all the way around its closed surface."""
    if not closed:
        return False
    if axis == 0:
        whole = surface.UPeriod() if surface.IsUPeriodic() else _range(surface, 0)
    else:
        whole = surface.VPeriod() if surface.IsVPeriodic() else _range(surface, 1)
    return bool(abs(high[axis] - low[axis] - whole) < SAME_PARAMETER * whole)


def _range(surface: BRepAdaptor_Surface, axis: int) -> float:
    if axis == 0:
        return float(surface.LastUParameter() - surface.FirstUParameter())
    return float(surface.LastVParameter() - surface.FirstVParameter())


def _borders(face: Face) -> list[Floats]:
    """Return the wires of a face as closed polygons in its parameters, each (k, 2)."""
    borders = []
    for wire in face.wires():
        explorer = BRepTools_WireExplorer(wire.wrapped, face.wrapped)
        points: list[tuple[float, float]] = []
        while explorer.More():
            points += _sampled(explorer.Current(), face.wrapped)
            explorer.Next()
        if points:
            borders.append(np.array(points))
    if not borders:
        raise BrepError("the face has no borders in its parameters; need a wire around it")
    return borders


def _sampled(edge: TopoDS_Edge, face: TopoDS_Face) -> list[tuple[float, float]]:
    """Return points along an edge in the parameters of its face, all but the last."""
    curve = BRepAdaptor_Curve2d(edge, face)
    count = 1 if curve.GetType() == GeomAbs_CurveType.GeomAbs_Line else BORDER_SAMPLES
    ends = [curve.FirstParameter(), curve.LastParameter()]
    if edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
        ends.reverse()
    along = np.linspace(ends[0], ends[1], count, endpoint=False)
    points = [curve.Value(one) for one in along.tolist()]
    return [(point.X(), point.Y()) for point in points]
