"""Struts with 8 and 16 sides: round, of the radius asked for, and whole where they cross."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import tile
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.solid import solidified, to_solid
from scaffold_cad.solid.manifolds import manifold_triangles
from scaffold_cad.solid.roundstruts import circumradius
from scaffold_cad.solid.thicken import thicken
from tests.meshes import CUBE
from tests.real_files import RADII, real_skeleton
from tests.solids import check_solid_of, contains
from tests.strategies import skeletons

TRIPOD = Skeleton([[0, 0, 0], [20, 0, 0], [0, 20, 0], [0, 0, 20]], [[0, 1], [0, 2], [0, 3]], 1.0)
CROSS = Skeleton([[-9, 0, 0], [9, 0, 0], [0, -9, 0.5], [0, 9, 0.5]], [[0, 1], [2, 3]], 1.0)


@pytest.mark.parametrize("sides", [8, 16])
def test_section_in_mid_strut_has_the_area_of_the_circle(sides: int) -> None:
    frame = thicken(TRIPOD, 1.25, sides=sides)
    # The solid between two planes across the strut along x, far from its ends.
    slab = frame.trim_by_plane([1, 0, 0], 9.0).trim_by_plane([-1, 0, 0], -11.0)
    radius = np.sqrt(slab.volume() / 2.0 / np.pi)
    assert radius == pytest.approx(1.25, rel=0.01)


@pytest.mark.parametrize("sides", [8, 16])
def test_corners_in_mid_strut_stand_within_two_percent_of_a_circle(sides: int) -> None:
    vertices = manifold_triangles(thicken(TRIPOD, 1.25, sides=sides)).vertices
    middle = vertices[(vertices[:, 0] > 8) & (vertices[:, 0] < 12)]
    assert len(middle) >= sides
    distance = np.linalg.norm(middle[:, 1:], axis=1)
    np.testing.assert_allclose(distance, 1.25 * circumradius(sides), rtol=0.02)


@pytest.mark.parametrize("sides", [8, 16])
def test_lattice_is_one_surface_without_any_union(sides: int) -> None:
    lattice = tile("bcc", 10.0, 2, radius=0.5)
    result = solidified(build_scaffold(lattice, collars=True), sides=sides)
    assert len(result.united_edges) == 0
    assert result.manifold.genus() == lattice.loop_count
    assert len(self_intersections(manifold_triangles(result.manifold))) == 0


def test_struts_that_cross_are_united_and_no_others() -> None:
    apart = [[0, 0, 30], [9, 0, 30]]
    skeleton = Skeleton([*CROSS.nodes.tolist(), *apart], [[0, 1], [2, 3], [4, 5]], 1.0)
    result = solidified(build_scaffold(skeleton), sides=8)
    assert result.united_edges.tolist() == [0, 1]
    assert len(result.manifold.decompose()) == 2
    assert len(self_intersections(manifold_triangles(result.manifold))) == 0


def test_all_struts_may_be_united() -> None:
    solid = thicken(CROSS, 1.0, sides=8)
    one = np.pi * 18 + 4 / 3 * np.pi
    assert one < solid.volume() < 2 * one
    assert len(solid.decompose()) == 1


def test_struts_left_out_keep_their_radius() -> None:
    skeleton = Skeleton([[0, 0, 0], [30, 0, 0], [15, -9, 0.5], [15, 9, 0.5]], CROSS.edges, 1.0)
    solid = thicken(skeleton, 1.0, sides=16)
    slab = solid.trim_by_plane([1, 0, 0], 4.0).trim_by_plane([-1, 0, 0], -6.0)
    assert slab.volume() == pytest.approx(2 * np.pi, rel=0.01)


@given(skeletons(), st.sampled_from([0.3, 1.0, 3.0]), st.booleans(), st.sampled_from([8, 16]))
@settings(max_examples=25)
def test_round_solids_of_random_skeletons(
    skeleton: Skeleton, factor: float, collars: bool, sides: int
) -> None:
    thick = skeleton.with_radii(factor * skeleton.radii)
    check_solid_of(thick, to_solid(build_scaffold(thick, collars=collars), sides=sides))


@pytest.mark.parametrize("collars", [False, True])
@pytest.mark.parametrize("name", [name for name in RADII if name != "nrn_ordering.swc"])
def test_round_solids_of_real_files(shared_data: Path, name: str, collars: bool) -> None:
    skeleton = real_skeleton(shared_data, name)
    check_solid_of(skeleton, to_solid(build_scaffold(skeleton, collars=collars), sides=8))


NARROW_FORK = Skeleton(
    [
        [23.958, 19.736, 20.738],
        [22.933, 26.006, 27.188],
        [22.254, 19.647, 20.311],
        [22.848, 28.302, 30.0],
        [23.046, 29.471, 30.0],
    ],
    [[0, 1], [3, 1], [4, 1], [1, 2]],
    0.6,
)
"""Two pairs of nearly parallel struts: of those that stay after the others cross, a sharp bend."""


@pytest.mark.parametrize("collars", [False, True])
@pytest.mark.parametrize("sides", [8, 16])
def test_struts_taken_out_do_not_cut_a_solid_apart(sides: int, collars: bool) -> None:
    solid = to_solid(build_scaffold(NARROW_FORK, collars=collars), sides=sides)
    check_solid_of(NARROW_FORK, solid)


@pytest.mark.parametrize("collars", [False, True])
def test_long_struts_to_one_side_stay_in_their_place(collars: bool) -> None:
    # Without sections beside it the limit would leave the branch point by several radii.
    ends = [[0, 0, 0], [40, 0, 0], [38, 12, 0], [38, 0, 12]]
    fork = Skeleton(ends, [[0, 1], [0, 2], [0, 3]], 1.0)
    solid = to_solid(build_scaffold(fork, collars=collars), sides=16)
    share = np.linspace(0.0, 1.0, 50)[:, None, None]
    axes = ((1 - share) * fork.nodes[0] + share * fork.nodes[1:]).reshape(-1, 3)
    assert contains(manifold_triangles(solid), axes).all()


def test_edges_of_a_mesh_become_round_struts() -> None:
    assert thicken(CUBE, 0.1, sides=8).genus() == 12 - 8 + 1


@pytest.mark.parametrize("sides", [3, 6, 32])
def test_other_numbers_of_sides_are_refused(sides: int) -> None:
    with pytest.raises(OptionError, match=rf"struts have {sides} sides; need 4, 8 or 16"):
        thicken(TRIPOD, 1.0, sides=sides)


def test_a_bare_mesh_has_no_struts_to_round() -> None:
    with pytest.raises(OptionError, match=r"a bare mesh has no struts to give 8 sides"):
        to_solid(CUBE, sides=8)
