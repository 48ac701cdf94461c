"""Samples moved aside so that triangles are seen from their node, judged by determinants."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad import Skeleton, round_struts
from scaffold_cad.solid.clusters.surface import unseen
from scaffold_cad.solid.rounds import round_mesh
from scaffold_cad.struts.meshes.facing import faced
from scaffold_cad.struts.meshes.surface import shell_of
from tests.struts.stars import random_stars

# A hexagon around its middle, 1 mm above the node, and triangles from the middle to its sides.
ANGLES = np.arange(6) * np.pi / 3
HEXAGON = np.stack([np.cos(ANGLES), np.sin(ANGLES), np.ones(6)], axis=1)
FAN = np.array([[0, 1 + k, 1 + (k + 1) % 6] for k in range(6)])
RING = np.arange(1, 7)


def determinants(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.det(points[FAN]))


def test_a_sample_outside_of_its_neighbors_is_moved_inside() -> None:
    points = np.vstack([[0.95, 0.2, 1.0], HEXAGON])
    assert determinants(points).min() < 0
    made = faced(points[None], FAN[None], RING[None], 16)
    assert determinants(made.points[0]).min() > 0
    np.testing.assert_array_equal(made.points[0, 1:], HEXAGON)
    moved = np.linalg.norm(made.points[0, 0] - points[0])
    assert made.aside[0] == pytest.approx(moved)
    assert 0.05 < moved < 0.15  # it was 0.08 mm outside


def test_samples_that_are_seen_stay_and_nodes_that_cannot_be_mended_too() -> None:
    good = np.vstack([[0.5, 0.2, 1.0], HEXAGON])
    pinched = np.vstack([[0.95, 0.2, 1.0], HEXAGON * [1.0, 1e-12, 1.0]])  # no room between
    made = faced(np.stack([good, pinched]), FAN[None].repeat(2, 0), RING[None].repeat(2, 0), 16)
    np.testing.assert_array_equal(made.points, [good, pinched])
    assert (made.aside == 0).all()


def test_what_becomes_of_a_node_does_not_depend_on_others() -> None:
    near = np.vstack([[0.95, 0.2, 1.0], HEXAGON])
    far = np.vstack([[1.9, -0.4, 1.0], HEXAGON])
    args = FAN[None], RING[None]
    both = faced(np.stack([near, far]), *(np.repeat(some, 2, 0) for some in args), 16)
    for row, points in enumerate((near, far)):
        np.testing.assert_array_equal(both.points[row], faced(points[None], *args, 16).points[0])


def test_proved_nodes_in_narrow_crotches_have_triangles_of_the_volume_of_their_blends() -> None:
    rng = np.random.default_rng(77)
    directions, radii = random_stars(8, 6, 30, rng), 4.0 ** (rng.random((8, 6)) - 1)
    count = 0
    for ways, radius in zip(directions, radii, strict=True):
        nodes = np.vstack([np.zeros(3), 12 * ways])
        star = Skeleton(nodes, [[0, k + 1] for k in range(6)], edge_radii=radius)
        struts = round_struts(star)
        if struts.crowded.any():
            continue
        count += 1
        assert not unseen(struts, shell_of(struts, 16).made).any()
        volumes = [round_mesh(struts, sides=sides).signed_volume for sides in (16, 64)]
        assert volumes[0] == pytest.approx(volumes[1], rel=2e-4)
    assert count >= 6
