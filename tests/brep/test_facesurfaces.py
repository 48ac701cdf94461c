"""Faces of build123d over the unit square: closed forms, seams, borders, normals."""

from __future__ import annotations

import numpy as np
import pytest
from build123d import Axis, Box, Cone, Cylinder, Face, GeomType, Pos, Rot, Sphere, Torus, Vector
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace

from scaffold_cad.base.arrays import Floats
from scaffold_cad.brep import surfacevalues
from scaffold_cad.brep.facesurfaces import FaceSurface
from scaffold_cad.brep.surfacevalues import values_of
from scaffold_cad.errors import OptionError


def grid(count: int = 7) -> Floats:
    steps = np.linspace(0, 1, count)
    return np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)


def only(shape: object, kind: GeomType) -> Face:
    return max(shape.faces().filter_by(kind), key=lambda face: face.area)  # type: ignore[attr-defined]


SHAPES = {
    "cylinder": (only(Cylinder(5, 10), GeomType.CYLINDER), (True, False)),
    "cone": (only(Cone(10, 4, 10), GeomType.CONE), (True, False)),
    "sphere": (only(Sphere(10), GeomType.SPHERE), (True, False)),
    "torus": (only(Torus(20, 6), GeomType.TORUS), (True, True)),
    "plane": (Box(4, 5, 6).faces().sort_by(Axis.X)[0], (False, False)),
    "half": (only(Cylinder(5, 10, arc_size=180), GeomType.CYLINDER), (False, False)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_places_are_on_the_face_and_normals_are_the_faces(name: str) -> None:
    face, wraps = SHAPES[name]
    surface = FaceSurface.of(face)
    assert surface.wraps == wraps
    assert surface.loops == ()
    places = 0.1 + 0.8 * grid(4)
    points, normals = surface.at(places, np.zeros(len(places), dtype=np.intp))
    for point, normal in zip(points, normals, strict=True):
        assert face.distance_to(Vector(*point)) < 1e-6
        np.testing.assert_allclose(tuple(face.normal_at(Vector(*point))), normal, atol=1e-6)


def test_normals_at_the_poles_of_a_sphere_point_outwards() -> None:
    surface = FaceSurface.of(SHAPES["sphere"][0])
    points, normals = surface.at(grid(), np.zeros(49, dtype=np.intp))
    np.testing.assert_allclose(normals, points / 10, atol=1e-4)


def test_the_face_of_a_bore_looks_into_it() -> None:
    bore = only(Box(20, 20, 5) - Cylinder(4, 9), GeomType.CYLINDER)
    points, normals = FaceSurface.of(bore).at(grid(), np.zeros(49, dtype=np.intp))
    np.testing.assert_allclose(normals[:, :2], -points[:, :2] / 4, atol=1e-12)


def test_borders_that_are_not_the_square_trim() -> None:
    plate = Box(40, 30, 5) - Pos(8, 3, 0) * Cylinder(5, 9)
    surface = FaceSurface.of(plate.faces().sort_by(Axis.Z)[-1])
    assert len(surface.loops) == 2
    areas = [
        abs((one[:, 0] * np.roll(one[:, 1], -1) - one[:, 1] * np.roll(one[:, 0], -1)).sum())
        / 2
        * 40
        * 30
        for one in surface.loops
    ]
    assert max(areas) == pytest.approx(1200)
    assert min(areas) == pytest.approx(np.pi * 25, rel=1e-3)


def test_a_turned_and_moved_face_is_evaluated_where_it_is() -> None:
    face = only(Pos(3, 4, 5) * Rot(30, 40, 50) * Cylinder(5, 10), GeomType.CYLINDER)
    points, _ = FaceSurface.of(face).at(grid(), np.zeros(49, dtype=np.intp))
    assert max(face.distance_to(Vector(*point)) for point in points) < 1e-6


@pytest.mark.parametrize("rational", [False, True])
def test_splines_in_arrays_are_what_occt_finds_one_by_one(rational: bool) -> None:
    if rational:
        face = Face.make_surface_from_array_of_points(
            [[Vector(x, y, np.sin(x) * y) for x in range(0, 9, 2)] for y in range(0, 13, 3)]
        )
        adaptor = BRepAdaptor_Surface(face.wrapped)
        spline = adaptor.BSpline()
        spline.SetWeight(2, 3, 2.5)
        face = Face(BRepBuilderAPI_MakeFace(spline, 1e-6).Face())
    else:
        face = Face.make_bezier_surface(
            [[Vector(x, y, x * y / 9) for x in (0, 3, 6, 9)] for y in (0, 4, 8)]
        )
    adaptor = BRepAdaptor_Surface(face.wrapped)
    low = np.array([adaptor.FirstUParameter(), adaptor.FirstVParameter()])
    high = np.array([adaptor.LastUParameter(), adaptor.LastVParameter()])
    places = np.concatenate([grid(13), np.random.default_rng(0).random((200, 2))])
    found = values_of(adaptor, low + places * (high - low))
    expected = surfacevalues._one_by_one(adaptor, low + places * (high - low))
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)


def test_what_is_no_face_is_refused() -> None:
    with pytest.raises(OptionError, match="need a Face"):
        FaceSurface.of(Box(1, 1, 1))
