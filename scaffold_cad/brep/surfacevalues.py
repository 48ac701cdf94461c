"""Positions and derivatives of OCCT surfaces at many parameters: in arrays where that can be."""

from __future__ import annotations

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Pnt, gp_Vec
from scipy.interpolate import BSpline

from scaffold_cad.base.arrays import Floats, Points
from scaffold_cad.base.blocks import blocks

MOST_POLES = 4096
"""Most poles of a spline surface that is evaluated in arrays."""

PARAMETER_BYTES = 2048
"""What a parameter takes where it is looked at."""


def values_of(surface: BRepAdaptor_Surface, parameters: Floats) -> tuple[Points, Floats, Floats]:
    """Return positions and derivatives along u and v at parameters (n, 2), each (n, 3)."""
    kind = surface.GetType()
    if kind == GeomAbs_SurfaceType.GeomAbs_Plane:
        return _of_plane(surface, parameters)
    if kind == GeomAbs_SurfaceType.GeomAbs_BSplineSurface and _is_plain(surface, parameters):
        return _of_spline(surface, parameters)
    return _one_by_one(surface, parameters)


def _of_plane(surface: BRepAdaptor_Surface, parameters: Floats) -> tuple[Points, Floats, Floats]:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    corners, _, _ = _one_by_one(surface, places)
    across = np.stack([corners[1] - corners[0], corners[2] - corners[0]])
    points: Points = corners[0] + parameters @ across
    shape = (len(points), 3)
    return points, np.broadcast_to(across[0], shape), np.broadcast_to(across[1], shape)


def _is_plain(surface: BRepAdaptor_Surface, parameters: Floats) -> bool:
    """Return whether a spline does not repeat, has few poles and the parameters are within it."""
    if surface.IsUPeriodic() or surface.IsVPeriodic():
        return False
    if surface.NbUPoles() * surface.NbVPoles() > MOST_POLES or len(parameters) < 100:
        return False
    low = (surface.FirstUParameter(), surface.FirstVParameter())
    high = (surface.LastUParameter(), surface.LastVParameter())
    return bool((parameters >= low).all() and (parameters <= high).all())


def _of_spline(surface: BRepAdaptor_Surface, parameters: Floats) -> tuple[Points, Floats, Floats]:
    """Return the values of a B-spline surface, rational or not."""
    spline = surface.BSpline()
    rows, columns = spline.NbUPoles(), spline.NbVPoles()
    poles = np.empty((rows, columns, 4))  # homogeneous
    for i in range(rows):
        for j in range(columns):
            pole, weight = spline.Pole(i + 1, j + 1), spline.Weight(i + 1, j + 1)
            poles[i, j] = (pole.X() * weight, pole.Y() * weight, pole.Z() * weight, weight)
    u_knots = _knots(spline.NbUKnots(), spline.UKnot, spline.UMultiplicity)
    v_knots = _knots(spline.NbVKnots(), spline.VKnot, spline.VMultiplicity)
    u_basis = BSpline(u_knots, np.eye(rows), spline.UDegree())
    v_basis = BSpline(v_knots, np.eye(columns), spline.VDegree())
    found = np.empty((3, len(parameters), 4))
    for block in blocks(len(parameters), PARAMETER_BYTES):
        u, v = parameters[block].T
        in_u, in_v = u_basis(u), v_basis(v)  # (b, rows), (b, columns)
        for k, (a, b) in enumerate(((in_u, in_v), (u_basis(u, 1), in_v), (in_u, v_basis(v, 1)))):
            across = np.tensordot(a, poles, axes=1)  # (b, columns, 4)
            found[k, block] = np.einsum("bcx,bc->bx", across, b)
    weight = found[0, :, 3:]
    points: Points = found[0, :, :3] / weight
    across_u, across_v = ((one[:, :3] - points * one[:, 3:]) / weight for one in found[1:])
    return points, across_u, across_v


def _knots(count: int, knot: object, multiplicity: object) -> Floats:
    """Return the knots of a spline, each as often as it counts."""
    values = [knot(k) for k in range(1, count + 1)]  # type: ignore[operator]
    times = [multiplicity(k) for k in range(1, count + 1)]  # type: ignore[operator]
    return np.repeat(np.array(values, dtype=np.float64), times)


def _one_by_one(surface: BRepAdaptor_Surface, parameters: Floats) -> tuple[Points, Floats, Floats]:
    """Return what OCCT finds at each of the parameters."""
    point, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()
    evaluate = surface.D1
    rows = []
    for u, v in parameters.tolist():
        evaluate(u, v, point, du, dv)
        rows.append(
            (
                point.X(), point.Y(), point.Z(),
                du.X(), du.Y(), du.Z(),
                dv.X(), dv.Y(), dv.Z(),
            )
        )  # fmt: skip
    values = np.array(rows).reshape(-1, 3, 3)
    return values[:, 0], values[:, 1], values[:, 2]
