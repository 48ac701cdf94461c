"""Nodes as stacks of rings: each vertex once, closed surfaces, collars on their circles."""

from __future__ import annotations

import numpy as np
import pytest

from scaffold_cad.skeleton import Skeleton
from scaffold_cad.struts import RoundStruts, round_struts
from scaffold_cad.struts.meshes.rings import (
    Grid,
    first_rings,
    parameters_at,
    quarter_parameters,
    stacks,
)
from scaffold_cad.struts.meshes.surface import triangulated
from scaffold_cad.struts.model import BlendedNodes
from tests.skeletons import BCC_STAR, ELBOW, JACK, TETRAPOD, TRIPOD

CUBE_QUADS = np.array(
    [[[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]]
)


def test_first_rings_share_corners_and_run_their_arcs_both_ways() -> None:
    rings = first_rings(CUBE_QUADS, 4)  # (1, 6, 16)
    assert rings.shape == (1, 6, 16)
    assert len(np.unique(rings)) == 8 + 12 * 3
    sides = {tuple(row) for row in np.stack([rings, np.roll(rings, -1, 2)], -1).reshape(-1, 2)}
    assert len(sides) == 6 * 16
    assert sides == {(b, a) for a, b in sides}


def test_parameters_are_those_of_even_angles_from_both_ends() -> None:
    at = quarter_parameters(6)
    assert at[0] == 0.0
    np.testing.assert_allclose(at[1:], 1 - at[:0:-1], atol=2e-16)
    np.testing.assert_allclose(at, parameters_at(np.arange(6) * np.pi / 12), atol=1e-12)


def only_group(struts: RoundStruts) -> BlendedNodes:
    (group,) = struts.blended
    return group


@pytest.mark.parametrize(
    "skeleton", [ELBOW, TRIPOD, TETRAPOD, JACK, BCC_STAR], ids=["2", "3", "4", "6", "8"]
)
def test_collars_are_circles_of_the_struts_radius(skeleton: Skeleton) -> None:
    struts = round_struts(skeleton)
    group = only_group(struts)
    sampled = stacks(group, np.zeros(group.half_runs.shape), Grid(4, 4, 16), 0.05)
    last = sampled.points[0][sampled.rings[0, :, -1]]  # (N, 16, 3)
    axis = struts.runs.directions[group.half_runs[0]][:, None]
    height = (last * axis).sum(axis=2)
    collar = struts.collar[group.half_runs[0]]
    np.testing.assert_allclose(height, np.broadcast_to(collar[:, None], height.shape), rtol=1e-9)
    radius = np.linalg.norm(last - height[..., None] * axis, axis=2)
    wanted = struts.runs.radii_at(group.half_runs[0], collar)[:, None]
    np.testing.assert_allclose(radius, np.broadcast_to(wanted, radius.shape), rtol=2e-6)


@pytest.mark.parametrize("sides", [4, 8, 16, 24])
def test_the_surface_of_a_node_is_closed_by_its_struts(sides: int) -> None:
    mesh = triangulated(round_struts(JACK), sides).mesh
    mesh.check_closed()
    assert len(mesh.vertices) - len(mesh.triangles) // 2 == 2  # Euler: a sphere


def test_equal_nodes_are_sampled_once_and_alike() -> None:
    both = Skeleton(
        np.vstack([JACK.nodes, JACK.nodes + 40.0]),
        np.vstack([JACK.edges, JACK.edges + len(JACK.nodes)]),
        1.0,
    )
    group = only_group(round_struts(both))
    sampled = stacks(group, np.full((2, 6), 0.01), Grid(4, 4, 16), 0.05)
    np.testing.assert_array_equal(*sampled.points)
    assert (sampled.swell == 0).all()
