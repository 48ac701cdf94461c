"""Balls at nodes: one sphere, on which every strut ends in a circle of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from build123d import Cylinder, GeomType, Plane, import_step

from scaffold_cad import Skeleton, round_struts, to_brep, to_solid, write
from scaffold_cad.errors import OptionError, SkeletonError
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.options import Nodes
from tests.crossings import check_as_written
from tests.skeletons import BCC_STAR, ELBOW, JACK, TETRAPOD, polyline
from tests.solids import contains
from tests.struts.stars import random_stars

STARS = {"jack": JACK, "bcc_star": BCC_STAR, "tetrapod": TETRAPOD, "elbow": ELBOW}


def tapered() -> Skeleton:
    directions = random_stars(1, 5, 40.0, np.random.default_rng(8))[0]
    nodes = np.concatenate([np.zeros((1, 3)), 30 * directions])
    radii = [[1, 0.6], [0.8, 0.8], [1.2, 0.5], [0.5, 1.5], [1, 2]]
    return Skeleton(nodes, [[0, k] for k in range(1, 6)], edge_radii=radii)


@pytest.mark.parametrize("skeleton", [*STARS.values(), tapered()], ids=[*STARS, "tapered"])
def test_each_strut_ends_in_a_circle_on_one_sphere(skeleton: Skeleton, tmp_path: Path) -> None:
    struts = round_struts(skeleton, nodes="ball")
    assert struts.exact.all()
    assert not struts.crowded.any()
    write(struts, tmp_path / "node.step")
    read = import_step(tmp_path / "node.step")
    assert read.is_valid
    assert len(read.solids()) == 1
    balls = struts.skeleton.radii[skeleton.valency > 1]
    spheres = read.faces().filter_by(GeomType.SPHERE)
    assert {round(face.radius, 6) for face in spheres} == {round(ball, 6) for ball in balls}
    kinds = {edge.geom_type for edge in read.edges()} - {GeomType.LINE, GeomType.CIRCLE}
    assert not kinds


@pytest.mark.parametrize("skeleton", [JACK, ELBOW], ids=["jack", "elbow"])
def test_struts_between_balls_can_be_drilled(skeleton: Skeleton, tmp_path: Path) -> None:
    struts = round_struts(skeleton, nodes="ball")
    write(struts, tmp_path / "node.step")
    place = [0.2, 0.8] @ skeleton.nodes[skeleton.edges[0]]
    drill = Plane(tuple(place), z_dir=(0, 0, 1)) * Cylinder(0.3, 6.0)
    rod = Plane(tuple(place), z_dir=tuple(skeleton.directions[0])) * Cylinder(1.0, 6.0)
    hole = (rod & drill).volume
    for body in (to_brep(struts), import_step(tmp_path / "node.step")):
        assert body.volume - (body - drill).volume == pytest.approx(hole, rel=1e-3)


@pytest.mark.parametrize("sides", [8, 16, 128, 256])
def test_meshes_have_the_volume_of_balls_and_struts(sides: int) -> None:
    struts = round_struts(tapered(), nodes="ball")
    assert to_solid(struts, sides=sides).volume() == pytest.approx(
        to_brep(struts).volume, rel=1e-4 if sides > 8 else 1e-3
    )


def test_the_least_ball_is_larger_than_the_one_on_which_circles_touch() -> None:
    ball = round_struts(JACK.with_radii(1.0), nodes="ball").skeleton.radii
    np.testing.assert_allclose(ball[JACK.valency > 1], 1.05 * np.sqrt(2))


def test_a_node_of_a_larger_radius_keeps_it() -> None:
    radii = np.where(JACK.valency > 1, 2.5, 1.0)
    frame = Skeleton(JACK.nodes, JACK.edges, radii, np.ones((6, 2)))
    struts = round_struts(frame, nodes="ball")
    np.testing.assert_array_equal(struts.skeleton.radii, radii)
    depth = np.sqrt(2.5**2 - 1)
    cut = 2.5 - depth
    length = float(JACK.lengths[0])
    volume = 4 / 3 * np.pi * 2.5**3 + 6 * (
        np.pi * (length - depth) - np.pi * cut**2 * (3 * 2.5 - cut) / 3
    )
    assert to_brep(struts).volume == pytest.approx(volume, rel=1e-9)
    assert to_solid(struts, sides=32).volume() == pytest.approx(volume, rel=1e-3)


def test_hollow_struts_have_hollow_balls() -> None:
    solid = to_brep(round_struts(JACK.with_radii(1.0), nodes="ball", wall=0.3, ends="open"))
    assert solid.is_valid
    radii = {round(face.radius, 9) for face in solid.faces().filter_by(GeomType.SPHERE)}
    outer = 1.05 * np.sqrt(2)
    assert radii == {round(outer, 9), round(outer - 0.3, 9)}


def test_what_is_for_blends_is_refused() -> None:
    with pytest.raises(OptionError, match=r"blend is given with nodes='ball'.* need no blend="):
        round_struts(JACK, nodes="ball", blend=0.2)


def test_balls_that_narrow_angles_make_large_are_told(caplog: pytest.LogCaptureFixture) -> None:
    narrow = Skeleton(
        [[1, 2, 3], [13, 2, 3], [12, 6, 3], [-5, 9, 3]], [[0, 1], [0, 2], [0, 3]], 1.5
    )
    round_struts(narrow, nodes="ball")
    assert "1 ball is larger than 3 radii" in caplog.text
    wide = 1.05 * 1.5 / np.sin(np.arctan(4 / 11) / 2)  # circles of two struts touch
    assert f"that of node 0 at [1, 2, 3] mm has a radius of {wide:.3g} mm" in caplog.text


def test_cones_that_widen_as_fast_as_they_part_have_no_ball() -> None:
    tips = [[20, 0, 0], [20, 2, 0]]
    fork = Skeleton([[0, 0, 0], *tips], [[0, 1], [0, 2]], 1.0).with_edge_radii([[0.5, 4], [0.5, 4]])
    with pytest.raises(
        SkeletonError, match=r"node 0 at \[0, 0, 0\] mm has no ball: its struts wid"
    ):
        round_struts(fork, nodes="ball")


@pytest.mark.parametrize("nodes", ["ball", "sharp"])
def test_balls_that_overlap_far_along_the_chain_are_united(nodes: Nodes) -> None:
    places = [[4.2 * k, 19.6 * (k % 2), 0] for k in range(6)]
    radii = [1, *[5] * 4, 1] if nodes == "sharp" else 1.0
    zigzag = Skeleton(places, polyline(6), radii, np.ones((5, 2)))
    struts = round_struts(zigzag, nodes=nodes)
    mesh = round_mesh(struts, 16)
    check_as_written(mesh)
    balls = struts.skeleton.radii[1:-1, None]
    assert (balls > 4.5).all()  # and every other ones are 8.4 mm from each other
    ways = np.random.default_rng(0).normal(size=(200, 3))
    ways *= 0.98 / np.linalg.norm(ways, axis=1)[:, None]
    points = np.concatenate(
        [place + size * ways for place, size in zip(places[1:-1], balls, strict=True)]
    )
    assert contains(mesh, points).all()
