"""Closed ends of hollow struts whose chains have finer links than the wall."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from scaffold_cad.errors import OptionError
from scaffold_cad.products import to_brep
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts import round_struts
from scaffold_cad.struts.hollow.walls import without_wall
from scaffold_cad.struts.runs import balls_of, straight_runs
from tests.crossings import check_as_written
from tests.skeletons import polyline
from tests.solid.field.judges import thicknesses

WALL = 0.5


def chain(places: np.ndarray, bend: float = 0.0) -> Skeleton:
    """Return a chain of radius 2 with nodes at places along it, on a parabola."""
    nodes = np.stack([places, bend * places**2, 0 * places], axis=1)
    return Skeleton(nodes, polyline(len(places)), 2.0)


FEW = np.arange(0, 1.2, 0.2)

FINE = {
    "straight": chain(np.append(np.arange(0, 2, 0.1), [5.0, 30.0])),
    "fine at both ends": chain(np.append(FEW, 20 - FEW[::-1])),
    "bent": chain(np.arange(0, 30, 0.24), 0.01),
    "tapered": chain(np.arange(0, 30, 0.24), 0.01).with_radii(np.linspace(1.5, 3.0, 125)),
}  # fmt: skip


@pytest.mark.parametrize("name", FINE)
def test_closed_ends_of_fine_chains_are_as_thick_as_the_wall(name: str) -> None:
    struts = round_struts(FINE[name], wall=WALL)
    mesh = round_mesh(struts, 32)
    check_as_written(mesh)
    walls = thicknesses(mesh) / WALL
    assert walls.min() > 0.9
    whole = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    outside, inside = sorted(whole.split(only_watertight=False), key=lambda each: -each.area)
    assert outside.volume > 0 > inside.volume
    for axis, sign in ((0, 1), (0, -1)):
        low = [(sign * each.vertices[:, axis]).min() for each in (outside, inside)]
        assert low[1] - low[0] == pytest.approx(WALL, abs=0.35)


def test_faces_of_a_fine_chain_are_a_hollow_solid() -> None:
    solid = to_brep(round_struts(FINE["bent"], wall=WALL))
    assert solid.is_valid
    mesh = round_mesh(round_struts(FINE["bent"], wall=WALL), 64)
    assert solid.volume == pytest.approx(mesh.signed_volume, rel=2e-3)


def test_joints_of_a_tapered_chain_that_are_drawn_together_are_no_balls() -> None:
    share = np.linspace(0.0, 1.0, 11)
    nodes = 3 * np.stack([np.cos(2 * share), np.sin(2 * share), 0 * share], axis=1)
    inside = without_wall(Skeleton(nodes, polyline(11), 2.0 - share), 0.8, np.full(11, 0.8))
    assert not np.allclose(inside.nodes[1], nodes[1])
    assert not balls_of(inside, straight_runs(inside)).any()


def test_a_ball_near_an_end_keeps_its_place_inside() -> None:
    whole = chain(np.array([0.0, 0.3, 0.8, 8.0, 16.0]), 0.01)
    balls = whole.with_edge_radii(whole.edge_radii, np.where(np.arange(5) == 2, 2.5, 2.0))
    inside = without_wall(balls, WALL, np.full(5, WALL))
    assert np.array_equal(inside.nodes[2], whole.nodes[2])
    assert inside.radii[2] == 2.5 - WALL


def test_a_branch_shorter_than_the_wall_is_a_stump() -> None:
    nodes = [[0, 0, 0], [12, 0, 0], [-6, 10, 0], [-6, -10, 0], [0, 0, 0.3]]
    star = Skeleton(nodes, [[0, 1], [0, 2], [0, 3], [0, 4]], 2.0)
    mesh = round_mesh(round_struts(star, wall=WALL), 32)
    check_as_written(mesh)
    walls = thicknesses(mesh) / WALL
    assert walls.min() > 0.8


TRIPOD = [[0, 0, 0], [12, 0, 0], [-6, 10, 0], [-6, -10, 0]]


@pytest.mark.parametrize(("bend", "wall"), [(0.1, 0.3), (0.0, 0.7)])
def test_a_chain_of_short_links_on_a_branch_point_is_closed(bend: float, wall: float) -> None:
    nodes = [*TRIPOD, [0, 0, 0.2], [0, bend, 0.4], [0, 0, 0.6]]
    edges = [[0, 1], [0, 2], [0, 3], [0, 4], [4, 5], [5, 6]]
    mesh = round_mesh(round_struts(Skeleton(nodes, edges, 1.0), wall=wall), 16)
    check_as_written(mesh)
    assert thicknesses(mesh).min() > 0.9 * wall


def test_links_that_are_straight_outside_only_have_an_inside() -> None:
    nodes = [*TRIPOD[:3], [0, 0, 0.2], [0, 0.06, 0.4], [0, 0, 0.6]]
    edges = [[0, 1], [0, 2], [0, 3], [3, 4], [4, 5]]
    struts = round_struts(Skeleton(nodes, edges, 1.0), wall=0.4)
    assert struts.inner is not None
    assert np.array_equal(struts.inner.runs.edges, struts.runs.edges)
    check_as_written(round_mesh(struts, 16))


@pytest.mark.parametrize("ends", ["flat", "open"])
def test_a_bent_last_link_shorter_than_the_wall_is_whole(ends: str) -> None:
    link = 0.05
    nodes = [[0, 0, 0], [0, 0, 6], [link / 2, 0, 6 + link * np.sqrt(0.75)]]
    mesh = round_mesh(round_struts(Skeleton(nodes, polyline(3), 1.0), wall=0.3, ends=ends), 16)
    check_as_written(mesh)
    if ends == "flat":
        assert thicknesses(mesh).min() > 0.9 * 0.3


def test_the_void_of_a_short_chain_of_links_lies_between_both_ends() -> None:
    mesh = round_mesh(round_struts(chain(np.array([0.0, 0.2, 0.4, 0.6])), wall=0.2), 64)
    assert mesh.signed_volume == pytest.approx(np.pi * (0.6 * 2**2 - 0.2 * 1.8**2), rel=1e-3)


def test_a_chain_shorter_than_its_ends_is_refused_with_its_place() -> None:
    short = chain(np.array([0.0, 0.2, 0.4, 0.8]))
    with pytest.raises(
        OptionError, match=r"edge 0 near \[0, 0, 0\] mm is 0\.2 mm long, and its chain 0\.8"
    ):
        round_struts(short, wall=WALL)
