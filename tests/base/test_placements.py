"""Vectors, axes, planes and places of build123d are taken where numbers are."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import pytest
from build123d import (
    Axis,
    Box,
    Face,
    Location,
    Plane,
    PolarLocations,
    Pos,
    Rot,
    Vector,
    Vertex,
    split,
)

from scaffold_cad import (
    BoxMap,
    CylinderMap,
    PeriodicLattice,
    Skeleton,
    SphereMap,
    cut,
    fill,
    self_supporting,
    tile,
)
from scaffold_cad.base.placements import numbers_of, origin_of, placement_of
from scaffold_cad.errors import OptionError
from scaffold_cad.mechanics import homogenized

STRUT = Skeleton([[1, 2, 3], [7, 5, 4]], [[0, 1]], 0.5)
LEANING = Plane((3, -2, 5), x_dir=(1, 2, 0), z_dir=(2, -1, 4))
"""A plane along no axis."""


@pytest.mark.parametrize(
    ("moved", "same"),
    [
        (STRUT.moved_by(Vector(1, 2, 3)), STRUT.moved_by([1, 2, 3])),
        (STRUT.moved_by(Vertex(1, 2, 3)), STRUT.moved_by([1, 2, 3])),
        (STRUT.moved_by(Pos(1, 2, 3)), STRUT.moved_by([1, 2, 3])),
        (STRUT.moved([Vector(), Vector(0, 0, 9)]), STRUT.moved([[0, 0, 0], [0, 0, 9]])),
        (STRUT.moved([Pos(), Pos(2, 0, 9) * Rot(0, 0, 45)]), STRUT.moved([[0, 0, 0], [2, 0, 9]])),
        (STRUT.turned(0.4, Axis.X), STRUT.turned(0.4, [1, 0, 0])),
        (STRUT.turned(0.4, Axis((5, 0, 1), (0, 3, 0))), STRUT.turned(0.4, [0, 1, 0], [5, 0, 1])),
        (STRUT.turned(0.4, Axis.Y, Vector(5, 0, 1)), STRUT.turned(0.4, [0, 1, 0], [5, 0, 1])),
        (STRUT.mirrored(Plane.XY), STRUT.mirrored([0, 0, 1])),
        (STRUT.mirrored(LEANING), STRUT.mirrored([2, -1, 4], [3, -2, 5])),
        (STRUT.oriented(Axis.X), STRUT.oriented([1, 0, 0])),
        (self_supporting(STRUT, 0.1, Axis.Z), self_supporting(STRUT, 0.1, [0, 0, 1])),
        (cut(STRUT, Box(9, 9, 9).bounding_box()), cut(STRUT, Box(9, 9, 9))),
        (STRUT.cut(Box(9, 9, 9).bounding_box()), cut(STRUT, Box(9, 9, 9))),
    ],
)
def test_skeletons_are_edited_by_objects_of_build123d(moved: Skeleton, same: Skeleton) -> None:
    np.testing.assert_allclose(moved.nodes, same.nodes, atol=1e-12)
    assert np.array_equal(moved.edges, same.edges)


@pytest.mark.parametrize("place", [Location((1, 2, 3), (10, 20, 30)), Rot(0, 0, 90), LEANING])
def test_places_move_skeletons_as_they_move_shapes(place: Location | Plane) -> None:
    expected = [tuple((place * Pos(*node)).position) for node in STRUT.nodes]
    for moved in (place * STRUT, STRUT.moved(place), STRUT.moved_by(place)):
        np.testing.assert_allclose(moved.nodes, expected, atol=1e-12)
        assert np.array_equal(moved.edge_radii, STRUT.edge_radii)


def test_a_skeleton_is_not_multiplied_by_else() -> None:
    for other in (2.0, Vector(1, 0, 0)):
        with pytest.raises(TypeError):
            other * STRUT


@pytest.mark.parametrize("place", [LEANING, LEANING.location])
def test_planes_and_locations_are_axes_and_origins(place: Plane | Location) -> None:
    frame = [tuple(axis) for axis in (LEANING.x_dir, LEANING.y_dir, LEANING.z_dir)]
    rows, box = np.array(frame), BoxMap([4, 5, 6], axes=place)
    same_box = BoxMap(Vector(4, 5, 6), Vector(3, -2, 5), rows)
    np.testing.assert_allclose(box.axes, same_box.axes, atol=1e-12)
    np.testing.assert_allclose(box.origin, same_box.origin, atol=1e-12)
    assert BoxMap([4, 5, 6], (1, 1, 1), place).origin.tolist() == [1, 1, 1]
    lattice = PeriodicLattice("bcc", 2.0, 2, 0.2, axes=place)
    np.testing.assert_allclose(lattice.origin, [3, -2, 5], atol=1e-12)
    np.testing.assert_allclose(lattice.axes, rows, atol=1e-12)
    turned, same = (fill([[0] * 3, [9] * 3], "bcc", 3, 0.2, axes=axes) for axes in (place, rows))
    np.testing.assert_allclose(turned.nodes, same.nodes, atol=1e-9)


@pytest.mark.parametrize("place", [LEANING, LEANING.location])
def test_a_place_given_as_the_origin_gives_the_axes_too(place: Plane | Location) -> None:
    tube, same_tube = CylinderMap(9, 6, 3, origin=place), CylinderMap(9, 6, 3, axis=place)
    ball = SphereMap(9, 3, origin=place, latitudes=[0, 1])
    box, lattice = BoxMap([4, 5, 6], place), PeriodicLattice("bcc", 2.0, 2, 0.2, origin=place)
    filled = fill([[0] * 3, [9] * 3], "bcc", 3, 0.2, origin=place)
    same = fill([[0] * 3, [9] * 3], "bcc", 3, 0.2, origin=(3, -2, 5), axes=place)
    np.testing.assert_allclose(filled.nodes, same.nodes, atol=1e-9)
    rows = [tuple(axis) for axis in (LEANING.x_dir, LEANING.y_dir, LEANING.z_dir)]
    for made in (tube, same_tube, ball, box, lattice):
        np.testing.assert_allclose(made.origin, [3, -2, 5], atol=1e-12)
        np.testing.assert_allclose(made.axes, rows, atol=1e-12)
    assert BoxMap([4, 5, 6], place, np.eye(3)).axes.tolist() == np.eye(3).tolist()


def test_nodes_may_be_where_locations_are_and_edges_come_from_a_generator() -> None:
    ring = Skeleton(PolarLocations(10, 6), ((k, (k + 1) % 6) for k in range(6)), 1.0)
    np.testing.assert_allclose(np.hypot(*ring.nodes[:, :2].T), 10, atol=1e-12)
    np.testing.assert_allclose(ring.lengths, 10, atol=1e-12)
    assert ring.edges.tolist() == [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5], [5, 0]]


def test_a_location_is_the_direction_of_its_z_axis() -> None:
    turned = STRUT.mirrored(Location((5, 5, 5), (0, 90, 0)))
    np.testing.assert_allclose(turned.nodes, STRUT.mirrored(Plane.YZ.offset(5)).nodes, atol=1e-12)


def test_a_plane_cuts_off_what_is_behind_it_as_split_does() -> None:
    bar = Box(2, 2, 20)
    kept = split(bar, bisect_by=Plane.XY.offset(4)).bounding_box()
    rod = Skeleton([[0, 0, -10], [0, 0, 10]], [[0, 1]], 1.0)
    for cut_off in (rod.cut(Plane.XY.offset(4)), cut(rod, Plane.XY.offset(4))):
        assert sorted(cut_off.nodes[:, 2]) == pytest.approx([kept.min.Z, kept.max.Z])


def test_an_axis_places_a_map() -> None:
    pipe = CylinderMap(9.0, 6.0, 3.0, axis=Axis((1, 2, 3), (0, 1, 0)))
    same_pipe = CylinderMap(9.0, 6.0, 3.0, origin=(1, 2, 3), axis=(0, 1, 0))
    turned, same = (tile("sc", 3, radius=0.2, on=on) for on in (pipe, same_pipe))
    assert np.array_equal(turned.nodes, same.nodes)


def test_moduli_are_along_an_axis() -> None:
    cell = homogenized("octet", 0.1, "steel", size=10.0)
    assert cell.young(Axis.X) == cell.young([1, 0, 0]) == cell.young(Vector(2, 0, 0))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: STRUT.moved_by(Axis.X), "offset is not an array of numbers: it is of type Axis"),
        (lambda: STRUT.turned(pi, Face.make_rect(1, 1)), "axis is not .*: it is of type Face"),
        (lambda: STRUT.moved_by([Plane.XY]), "offset is not .*: it holds items of type Plane"),
    ],
)
def test_what_is_no_position_is_refused_in_plain_words(
    call: Callable[[], object], message: str
) -> None:
    with pytest.raises(OptionError, match=message + "; need numbers"):
        call()


def test_all_else_is_left_as_it_is() -> None:
    given = [1.0, 2.0, 3.0]
    assert numbers_of(given) is given
    assert placement_of(given) is None
    assert origin_of(given) == (0, 0, 0)
