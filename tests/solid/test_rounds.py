"""Meshes of round struts: of the right volume, and whole in the 32 bits of a file."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import tile
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import rounds, solidified, thicken, to_solid
from scaffold_cad.solid.clusters import fewest
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from tests.crossings import check_as_written
from tests.skeletons import CUBE, K4, NAMED, STICK_FIGURE, STRUT, TAPER, TRIPOD
from tests.solids import check_solid_of, contains

CLOSE = Skeleton([[0, 0, 0], [20, 0, 0], [10, -8, 0.5], [10, 8, 0.5]], [[0, 1], [2, 3]], 1.0)


@pytest.mark.parametrize("sides", [4, 8, 16, 32])
def test_cylinders_and_cones_have_their_volume(sides: int) -> None:
    cylinder = round_mesh(round_struts(STRUT), sides)
    assert cylinder.signed_volume == pytest.approx(10 * np.pi, rel=1e-12)
    a, b = TAPER.radii
    frustum = np.pi * TAPER.lengths[0] * (a**2 + a * b + b**2) / 3
    assert round_mesh(round_struts(TAPER), sides).signed_volume == pytest.approx(frustum, rel=1e-9)


@pytest.mark.parametrize("name", NAMED)
def test_meshes_are_whole_as_written(name: str) -> None:
    check_as_written(round_mesh(round_struts(NAMED[name]), 8))


@pytest.mark.parametrize("place", [0.0, 1e3, 1e5])
def test_meshes_far_from_the_origin_are_whole_as_written(place: float) -> None:
    check_as_written(round_mesh(round_struts(TRIPOD.moved(TRIPOD.nodes + place)), 16))


@pytest.mark.parametrize("cell", ["bcc", "octet", "kelvin", "diamond"])
def test_lattices_are_whole_as_written(cell: str) -> None:
    struts = round_struts(tile(cell, 10.0, 2, radius=0.4))
    assert struts.overlapping.tolist() == []
    check_as_written(round_mesh(struts, 8))


@pytest.mark.parametrize("skeleton", [TRIPOD, K4, CUBE], ids=["tripod", "k4", "cube"])
def test_more_sides_hardly_change_the_volume(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    volumes = [round_mesh(struts, sides).signed_volume for sides in (8, 16, 64)]
    assert volumes[0] == pytest.approx(volumes[2], rel=0.02)
    assert volumes[1] == pytest.approx(volumes[2], rel=0.005)


def test_loops_become_handles() -> None:
    for skeleton in (K4, CUBE, STICK_FIGURE):
        solid = solidified(round_struts(skeleton))
        assert solid.manifold.genus() == skeleton.loop_count
        assert len(solid.united_edges) == 0
        check_solid_of(skeleton, solid.manifold)


def test_a_node_larger_than_its_struts_is_a_ball() -> None:
    tips = 8 / np.sqrt(3) * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    star = [[0, tip] for tip in range(1, 5)]
    sticks = Skeleton(
        np.vstack([np.zeros(3), tips]), star, [1.6, 0.5, 0.5, 0.5, 0.5], edge_radii=0.5
    )
    solid = to_solid(round_struts(sticks, blend=0.05), sides=32)
    reach = np.sqrt(1.6**2 - 0.5**2)
    cap = np.pi * (1.6 - reach) ** 2 * (3.2 + reach) / 3
    volume = 4 / 3 * np.pi * 1.6**3 + 4 * (np.pi / 4 * (8 - reach) - cap)
    assert solid.volume() == pytest.approx(volume, rel=3e-3)


def test_struts_that_overlap_become_one_solid() -> None:
    solid = solidified(round_struts(CLOSE))
    assert solid.united_edges.tolist() == [0, 1]
    check_solid_of(CLOSE, solid.manifold)
    # Two cylinders of radius 1 that cross at right angles share 16/3 where their axes meet.
    assert np.pi * 36 - 16 / 3 < solid.manifold.volume() < np.pi * 36


def test_frames_of_round_struts_follow_their_radius() -> None:
    for sides in (8, 12):
        assert thicken(STRUT, 0.5, sides=sides).volume() == pytest.approx(2.5 * np.pi, rel=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: round_mesh(STRUT), "got a Skeleton; need a RoundStruts: round_struts"),
        (lambda: round_mesh(round_struts(STRUT), 6), "sides is 6; need a multiple of 4"),
        (lambda: to_solid(round_struts(STRUT), sides=2), "sides is 2; need 4 or more"),
    ],
)
def test_wrong_arguments_are_refused(call: Any, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        call()


def test_what_does_not_fit_into_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rounds, "machine_memory", lambda: 1e6)
    struts = round_struts(TRIPOD)
    assert len(round_mesh(struts, 44).triangles) > 2904
    need = r"sides is 48; the nodes have some 3.5e\+03 triangles .*; need sides of at most 44 here"
    with pytest.raises(OptionError, match=need):
        round_mesh(struts, 48)
    with pytest.raises(OptionError, match="need fewer struts, or tiles"):
        round_mesh(round_struts(tile("bcc", 10.0, 3, radius=0.8)), 8)


@pytest.mark.parametrize("ends", [[[0, 1], [2, 3]], [[0, 1], [2, 3], [0, 2]]])
@pytest.mark.parametrize("wall", [None, 0.2])
def test_the_gap_between_struts_stays_where_polygons_of_few_sides_would_cross(
    ends: list[list[int]], wall: float | None
) -> None:
    nodes = [[0, 0, 0], [200, 0, 0], [0, 2.03, 0], [200, 2.03, 0]]
    apart = round_struts(Skeleton(nodes, ends, 1.0), wall=wall)
    assert len(apart.overlapping) == 0
    mesh = round_mesh(apart, 16)
    check_as_written(mesh)
    assert not contains(mesh, np.array([[x, 1.015, 0.1] for x in (50, 100, 150)])).any()
    area = np.pi * (1 - (0 if wall is None else (1 - wall) ** 2))
    assert mesh.signed_volume == pytest.approx(2 * 200 * area, rel=0.02)


def test_the_gap_between_components_stays_where_others_overlap() -> None:
    near = Skeleton([[0, 0, 9], [20, 0, 9], [0, 2.05, 9], [20, 2.05, 9]], [[0, 1], [2, 3]], 1.0)
    struts = round_struts(CLOSE + near)
    assert struts.overlapping.tolist() == [0, 1]
    mesh = round_mesh(struts, 16)
    check_as_written(mesh)
    assert not contains(mesh, np.array([[x, 1.025, 9.1] for x in (5, 10, 15)])).any()


@pytest.mark.parametrize(
    ("gap", "place", "joined", "named"),
    [(0.05, 9, False, False), (0.05, 9, True, True), (0.2, 2, False, True), (0.2, 9, True, False)],
)
def test_struts_that_others_overlap_keep_their_gaps_or_are_named(
    gap: float, place: float, joined: bool, named: bool, caplog: pytest.LogCaptureFixture
) -> None:
    """A strut across another, with a gap, which a third one crosses at `place`."""
    nodes = [[-5, 0, 0], [14, 0, 0], [0, 9, 2 + gap], [0, -9, 2 + gap]]
    nodes += [[place, 9, -0.5], [place, -9, -0.5]]
    edges = [[0, 1], [2, 3], [4, 5]] + joined * [[0, 2]]
    struts = round_struts(Skeleton(nodes, edges, 1.0))
    filled = contains(round_mesh(struts), np.array([[0, 0, 1 + gap / 2]]))
    assert filled.tolist() == [named]
    assert ("1 pair of struts is united, though they do not touch: edges" in caplog.text) == named
    assert not named or "edges 0 and 1, near [0, 0, 1." in caplog.text


@pytest.mark.parametrize(("other", "gap"), [(0.05, 0.02), (0.05, 0.55), (2.0, 0.55), (2.0, 1.4)])
def test_gaps_are_named_where_fillets_of_different_radii_close_them(
    other: float, gap: float, caplog: pytest.LogCaptureFixture
) -> None:
    """A strut across another of its own fillet radius, and a third one that overlaps the first."""
    nodes = [[-5, 0, 0], [14, 0, 0], [0.3, 9, 2 + gap], [0, -9, 2 + gap], [2, 9, -0.5], [2, -9, -1]]
    crossing = Skeleton(nodes, [[0, 1], [2, 3], [4, 5]], 1.0)
    blend = [2.0, 2.0, other, other, 0.2, 0.2]
    mesh = round_mesh(round_struts(crossing, blend=blend))
    closed = gap <= 2.0 + other - np.hypot(2.0, other)  # a quarter of an ellipse touches there
    middle = [[0.15, 0.0, 1 + gap * part] for part in np.linspace(0.05, 0.95, 19)]
    assert contains(mesh, np.array(middle)).all() == closed
    assert ("united, though they do not touch: edges 0 and 1" in caplog.text) == closed


def test_gaps_beside_flat_ends_are_not_named(caplog: pytest.LogCaptureFixture) -> None:
    """A strut that ends flat above another, and a third one that overlaps the lower one."""
    nodes = [[-5, 0, 0], [14, 0, 0], [0, 0, 1.5], [0, 0.1, 9], [2, 9, -0.5], [2, -9, -1]]
    struts = round_struts(Skeleton(nodes, [[0, 1], [2, 3], [4, 5]], 1.0), blend=2.0)
    assert not contains(round_mesh(struts), np.array([[0.1, 0.2, z] for z in (1.2, 1.3)])).any()
    assert "united" not in caplog.text


@pytest.mark.parametrize(("radius", "named"), [(0.8, False), (0.9, True)])
def test_long_gaps_that_fillets_close_are_named_though_a_short_strut_joins_their_ends(
    radius: float, named: bool, caplog: pytest.LogCaptureFixture
) -> None:
    corners = [[x, y, z] for x in (0, 12) for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    edges = [[k + i, k + (i + 1) % 4] for k in (0, 4) for i in range(4)]
    frame = Skeleton(corners, edges + [[i, i + 4] for i in range(4)], radius)
    filled = contains(round_mesh(round_struts(frame)), np.array([[6.0, 1.0, 0.01]]))
    assert filled.tolist() == [named]
    assert ("united, though they do not touch" in caplog.text) == named


@pytest.mark.parametrize(("gap", "corners"), [(1e-4, fewest.MOST_CORNERS), (0.05, 100)])
def test_struts_that_hardly_keep_apart_are_united_and_named(
    gap: float, corners: int, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fewest, "MOST_CORNERS", corners)
    nodes = [[0, 0, 0], [9, 0, 0], [0, 2 + gap, 0], [9, 2 + gap, 0]]
    near = round_struts(Skeleton(nodes, [[0, 1], [2, 3]], 1.0))
    assert len(near.overlapping) == 0
    check_as_written(round_mesh(near, 16))
    assert re.search(r"1 pair of struts .* edges 0 and 1, near \[0, 1\.\d+, 0\] mm", caplog.text)
