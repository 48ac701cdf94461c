"""Struts whose smooth surfaces cross: none is missed, and few that keep apart are named."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from scaffold_cad.lattice import tile
from scaffold_cad.mesh.intersections import self_intersections
from scaffold_cad.mesh.trianglemesh import TriangleMesh
from scaffold_cad.scaffold import build_scaffold
from scaffold_cad.skeleton import Skeleton
from scaffold_cad.smooth import (
    Caps,
    Patches,
    crossing_struts,
    fine_surface,
    smooth_mesh,
    smooth_patches,
)
from tests.skeletons import BCC_STAR, ELBOW, JACK, star
from tests.strategies import skeletons

LONG_TREE = Skeleton(
    [
        [0, 0, 0],
        [-0.374986, 0.97352, -9.945433],
        [2.349952, 7.71628, -5.910731],
        [2.338, 3.994788, -8.864278],
    ],
    [[0, 1], [0, 2], [0, 3]],
    0.2,
)
"""A branch point whose struts are fifty radii long, all to one side."""

CLOSE_STRUTS = star(
    [[-5.26, 0.79, -4.14], [0.42, 6.46, 1.16], [6.17, -6.36, -7.26], [2.92, -3.55, -3.45]], 0.2
)
"""Two struts under 4.4 degrees, whose patches turn over, also where quads are cut."""


def parallel(distance: float, turn: float) -> Skeleton:
    """Return two parallel struts of radius 1; `turn` is from their sections to the other, rad."""
    away = distance * np.array([0.0, np.cos(turn), np.sin(turn)])
    nodes = np.array([[0.0, 0, 0], [20, 0, 0], [0, 0, 0], [20, 0, 0]])
    nodes[2:] += away
    return Skeleton(nodes, [[0, 1], [2, 3]], 1.0)


def cross_when_sampled(patches: Patches, count: int) -> bool:
    """Whether a mesh through `count` times as many points a patch crosses itself."""
    points, _ = patches.sampled(count)
    place = np.arange(points[..., 0].size).reshape(points.shape[:3])
    a, b, c, d = place[:, :-1, :-1], place[:, 1:, :-1], place[:, 1:, 1:], place[:, :-1, 1:]
    triangles = np.stack([a, b, c, a, c, d], axis=3).reshape(-1, 3)
    # Points on common edges agree but for rounding.
    places = np.round(points.reshape(-1, 3), 8)
    vertices, number = np.unique(places, axis=0, return_inverse=True)
    corners = number.reshape(-1)[triangles]
    proper = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    return len(self_intersections(TriangleMesh(vertices, corners[proper]))) > 0


@pytest.mark.parametrize("split", [0, None])
def test_long_struts_to_one_side_do_not_fold_their_patches(split: int | None) -> None:
    scaffold = build_scaffold(LONG_TREE)
    patches = smooth_patches(scaffold, split=split)
    assert len(patches.turned) == 0
    assert not cross_when_sampled(patches, 7)
    assert len(crossing_struts(patches, scaffold)) == 0


def test_patches_that_turn_over_though_quads_were_cut_are_named() -> None:
    scaffold = build_scaffold(CLOSE_STRUTS)
    patches = smooth_patches(scaffold)
    assert len(patches.turned) > 0
    assert set(crossing_struts(patches, scaffold)) >= {2, 3}


@pytest.mark.parametrize("turn", [0.0, 20.0, 45.0])
@pytest.mark.parametrize(("distance", "crossing"), [(1.9, [0, 1]), (1.98, [0, 1]), (2.1, [])])
def test_parallel_struts_cross_within_two_radii(
    distance: float, turn: float, crossing: list[int]
) -> None:
    scaffold = build_scaffold(parallel(distance, np.radians(turn)), collars=True)
    assert crossing_struts(smooth_patches(scaffold), scaffold).tolist() == crossing
    assert crossing_struts(fine_surface(scaffold, 3), scaffold).tolist() == crossing


@pytest.mark.parametrize("caps", ["round", "flat"])
def test_struts_that_keep_apart_are_not_named(caps: Caps) -> None:
    for skeleton in (ELBOW, JACK, BCC_STAR, tile("octet", 10.0, 1, radius=0.5)):
        scaffold = build_scaffold(skeleton, collars=True)
        assert len(crossing_struts(smooth_patches(scaffold, caps=caps), scaffold)) == 0
        assert len(crossing_struts(fine_surface(scaffold, 4, caps), scaffold)) == 0


@settings(max_examples=8)
@given(skeletons(max_nodes=8))
def test_no_crossing_is_missed_that_closer_samples_show(skeleton: Skeleton) -> None:
    scaffold = build_scaffold(skeleton)
    patches = smooth_patches(scaffold)
    if len(crossing_struts(patches, scaffold)) == 0:
        assert not cross_when_sampled(patches, 13)
    if len(crossing_struts(fine_surface(scaffold, 3), scaffold)) == 0:
        assert len(self_intersections(smooth_mesh(scaffold, 3).mesh)) == 0
