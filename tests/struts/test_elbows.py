"""Bends that are parts of exact tori."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import Face, GeomType, Shape, import_step
from OCP.BRepAdaptor import BRepAdaptor_Surface

from scaffold_cad import RoundStruts, Skeleton, round_struts, to_brep, to_solid, write
from scaffold_cad.errors import OptionError
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.hollow.walls import walls
from tests.solids import check_watertight

ELBOW = Skeleton([[0, 0, 0], [40, 0, 0], [40, 50, 0]], [[0, 1], [1, 2]], 4.0)
PIPE = Skeleton(
    [[0, 0, 0], [40, 0, 0], [40, 30, 0], [40, 30, 40], [0, 30, 70]],
    [[0, 1], [1, 2], [2, 3], [3, 4]],
    4.0,
)
SQUARE = Skeleton(
    [[0, 0, 0], [30, 0, 0], [30, 30, 0], [0, 30, 0]], [[0, 1], [1, 2], [2, 3], [3, 0]], 3.0
)


def turned(degrees: float) -> Skeleton:
    """Return two struts of radius 4 and length 100 that turn by an angle."""
    angle = np.radians(degrees)
    tip = [100 * np.cos(angle), 60 * np.sin(angle), 80 * np.sin(angle)]
    return Skeleton([[-100, 0, 0], [0, 0, 0], tip], [[0, 1], [1, 2]], 4.0)


def volume(skeleton: Skeleton, bends: Any, inside: float = 0.0) -> float:
    """Return the volume of a pipe of radius 4 with flat ends, by the length of its centerline."""
    length = skeleton.lengths.sum()
    for node, radius in bends.items():
        one, other = skeleton.directions[skeleton.incidence.at_nodes(np.array([node]), 2)[0]]
        turn = np.pi - np.arccos(np.clip(one @ other, -1, 1))
        length += radius * (turn - 2 * np.tan(turn / 2))
    return float(np.pi * (skeleton.radii[0] ** 2 - inside**2) * length)


def tori(shape: Shape) -> list[Face]:
    return [face for face in shape.faces() if face.geom_type == GeomType.TORUS]


def sizes(shape: Shape) -> list[tuple[float, float]]:
    found = [BRepAdaptor_Surface(face.wrapped).Torus() for face in tori(shape)]
    return sorted((round(each.MajorRadius(), 9), round(each.MinorRadius(), 9)) for each in found)


def reread(struts: RoundStruts, folder: Path) -> Shape:
    write(struts, folder / "bend.step")
    return import_step(folder / "bend.step")


@pytest.mark.parametrize(("bend", "radius"), [("torus", 12.0), (20.0, 20.0)])
def test_a_bend_is_one_torus_of_its_radii(bend: Any, radius: float, tmp_path: Path) -> None:
    struts = round_struts(ELBOW, bend=bend)
    assert struts.bends[1] == pytest.approx(radius, rel=1e-12)
    assert np.isnan(struts.bends[[0, 2]]).all()
    body = reread(struts, tmp_path)
    assert body.is_valid
    assert sizes(body) == [(radius, 4.0)]
    assert len(body.faces()) == 5
    assert body.volume == pytest.approx(volume(ELBOW, {1: radius}), rel=1e-9)
    axis = tori(body)[0].axis_of_rotation
    assert abs(tuple(axis.direction)[2]) == pytest.approx(1)
    assert tuple(axis.position) == pytest.approx((40 - radius, radius, 0))


@pytest.mark.parametrize("degrees", [1, 20, 60, 90, 120, 150, 165])
def test_bends_of_any_turn_are_exact(degrees: float) -> None:
    pipe = turned(degrees)
    struts = round_struts(pipe, bend=10.0)
    assert len(struts.overlapping) == 0
    body = to_brep(struts)
    assert body.is_valid
    assert sizes(body) == [(10.0, 4.0)]
    assert body.volume == pytest.approx(volume(pipe, {1: 10.0}), rel=1e-9)
    mesh = round_mesh(struts, 32)
    check_watertight(mesh)
    assert mesh.signed_volume == pytest.approx(body.volume, rel=2e-3)


def test_meshes_follow_the_torus() -> None:
    struts = round_struts(ELBOW, bend=15.0)
    mesh = round_mesh(struts, 64)
    x, y, z = mesh.vertices.T
    bent = (x > 25.1) & (y < 14.9)
    away = np.hypot(np.hypot(x[bent] - 25, y[bent] - 15) - 15, z[bent])
    assert bent.sum() > 64 * 8
    # A polygon has the area of its circle: it is a little larger, along curves too.
    assert away.min() > 4 * (1 - 1e-6)
    assert away.max() < 4 * 1.004


def test_hollow_bends_are_two_tori_around_one_centerline(tmp_path: Path) -> None:
    struts = round_struts(ELBOW, bend=15.0, wall=1.0, ends="open", sockets={0: (3.5, 5.0)})
    body = reread(struts, tmp_path)
    assert body.is_valid
    assert sizes(body) == [(15.0, 3.0), (15.0, 4.0)]
    bored = np.pi * (3.5**2 - 3.0**2) * 5
    assert body.volume == pytest.approx(volume(ELBOW, {1: 15.0}, 3.0) - bored, rel=1e-9)
    assert walls(struts).curves == pytest.approx([1.0], rel=1e-6)
    check_watertight(round_mesh(struts, 16))


@pytest.mark.parametrize("ends", ["flat", "round"])
def test_pipes_of_several_bends_are_valid(ends: Any, tmp_path: Path) -> None:
    struts = round_struts(PIPE, bend="torus", ends=ends)
    body = reread(struts, tmp_path)
    assert body.is_valid
    assert sizes(body) == [(12.0, 4.0)] * 3
    balls = 4 / 3 * np.pi * 4**3 if ends == "round" else 0.0
    assert body.volume == pytest.approx(volume(PIPE, {1: 12, 2: 12, 3: 12}) + balls, rel=1e-9)
    assert to_solid(struts, sides=32).volume() == pytest.approx(body.volume, rel=2e-3)


def test_rings_of_bends_have_no_ends() -> None:
    struts = round_struts(SQUARE, bend="torus", joints="blend")
    body = to_brep(struts)
    assert body.is_valid
    assert sizes(body) == [(9.0, 3.0)] * 4
    assert body.volume == pytest.approx(np.pi * 9 * (4 * 12 + 2 * np.pi * 9), rel=1e-9)


def test_bends_shrink_to_the_room_there_is() -> None:
    short = Skeleton([[0, 0, 0], [7, 0, 0], [7, 50, 0]], [[0, 1], [1, 2]], 4.0)
    struts = round_struts(short, bend="torus")
    assert 6.9 < struts.bends[1] < 7
    assert to_brep(struts).is_valid
    hollow = round_struts(short, bend="torus", wall=1.0)
    assert 5.9 < hollow.bends[1] < 6
    assert len(hollow.overlapping) == 0


def test_bends_without_room_are_blends_and_say_why(caplog: pytest.LogCaptureFixture) -> None:
    struts = round_struts(PIPE, bend=25.0)
    assert np.isfinite(struts.bends).tolist() == [False, False, False, True, False]
    assert np.isfinite(struts.fillet).tolist() == [False, True, True, False, False]
    assert to_brep(struts).is_valid
    assert (
        "the bend at node 1 ([40, 0, 0] mm) is a blend: a torus with a centerline radius of 25 mm "
        "takes 25 mm of its strut to node 2, whose nodes need 50 mm of its 30 mm"
    ) in caplog.text


def test_bends_tighter_than_their_strut_are_blends(caplog: pytest.LogCaptureFixture) -> None:
    struts = round_struts(ELBOW, bend=4.5)
    assert np.isnan(struts.bends).all()
    assert "4.5 mm is too tight for struts of radius 4 mm; need 5 mm or more" in caplog.text


def test_struts_of_two_radii_and_branch_points_stay_blends() -> None:
    nodes = [[0, 0, 0], [40, 0, 0], [40, 50, 0], [90, 50, 0], [40, 90, 30]]
    steps = Skeleton(nodes, [[0, 1], [1, 2], [2, 3], [2, 4]], edge_radii=[4, 3, 3, 3])
    struts = round_struts(steps, bend="torus")
    assert np.isnan(struts.bends).all()
    assert np.isfinite(struts.fillet).tolist() == [False, True, True, False, False]


def test_neighbors_are_apart_from_the_torus_not_from_the_corner(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def beside(place: float) -> RoundStruts:
        # A strut across the plane of the bend, at a distance from its corner along the bisector.
        x, y = 40 - place, place
        nodes = np.vstack([ELBOW.nodes, [[x, y, -20], [x, y, 20]]])
        return round_struts(Skeleton(nodes, [[0, 1], [1, 2], [3, 4]], 4.0), bend=30.0)

    # The centerline passes the bisector 8.8 mm, in x and in y, from the corner.
    assert len(beside(1.0).overlapping) == 0
    assert len(beside(16.0).overlapping) == 0
    # There the bend is a blend, which goes around the corner; only a strut at the corner meets it.
    assert np.isnan(beside(8.8).bends).all()
    assert len(beside(8.8).overlapping) == 0
    assert "] mm) is a blend: its torus would meet other struts" in caplog.text


def test_moved_bends_keep_their_triangles() -> None:
    first = round_struts(turned(90), bend=10.0)
    second = round_struts(turned(120), bend=10.0, like=first)
    assert np.array_equal(round_mesh(first, 16).triangles, round_mesh(second, 16).triangles)
    check_watertight(round_mesh(second, 16))
    assert second.bends[1] == pytest.approx(10.0)


@pytest.mark.parametrize("bend", ["pipe", -1.0, 0.0, np.nan])
def test_bends_that_cannot_be_are_refused(bend: Any) -> None:
    with pytest.raises(OptionError, match=r"bend is .*; need"):
        round_struts(ELBOW, bend=bend)
