"""Skeletons cut to parts, and ends put on surfaces and other skeletons."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from build123d import Box, Cylinder

from scaffold_cad import check_skeleton, cut, snapped, tile, voronoi_foam
from scaffold_cad.errors import OptionError
from scaffold_cad.lattice import unit_cell
from scaffold_cad.skeleton import Skeleton

SPOKES = Skeleton(
    [[0, 0, 0], [9.6, 0, 0], [0, 9.8, 0], [0, 0, 7.0], [-9.9, 0.3, 0]],
    [[0, 1], [0, 2], [0, 3], [0, 4]],
    0.5,
)


@pytest.mark.parametrize(
    "region",
    [
        Cylinder(12, 40),
        trimesh.creation.cylinder(12, 40, sections=200),
        lambda p: np.maximum(np.hypot(p[:, 0], p[:, 1]) - 12, np.abs(p[:, 2]) - 20),
    ],
    ids=["solid", "mesh", "function"],
)
def test_a_lattice_is_cut_to_any_region(region: object) -> None:
    lattice = tile("kelvin", 8.0, 4, radius=0.4).moved_by([-16, -16, -16])
    part = cut(lattice, region)  # type: ignore[arg-type]
    check_skeleton(part)
    assert np.hypot(*part.nodes[:, :2].T).max() == pytest.approx(12, abs=0.02)
    density = unit_cell("kelvin").motif.strut_lengths(np.full(3, 8.0)).sum() / 8.0**3
    assert part.lengths.sum() == pytest.approx(density * np.pi * 144 * 32, rel=0.05)


def test_foams_and_drawings_are_cut_to_boxes() -> None:
    foam = voronoi_foam(60, [[0, 0, 0], [30, 30, 30]], 0.4)
    assert cut(foam, [[0, 0, 0], [30, 30, 10]]).nodes[:, 2].max() == pytest.approx(10)
    whole = cut(SPOKES, [[-1, -1, -1], [20, 20, 20]], keep="whole")
    assert len(whole.edges) == 3
    with pytest.raises(OptionError, match="need a box, a function, a triangle mesh"):
        cut(SPOKES, 3)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "target",
    [
        lambda p: np.linalg.norm(p, axis=1) - 10.0,
        trimesh.creation.icosphere(5, 10.0),
    ],
    ids=["function", "mesh"],
)
def test_free_ends_within_reach_come_to_the_surface(target: object) -> None:
    ends = snapped(SPOKES, target, 1.0)  # type: ignore[arg-type]
    away = np.linalg.norm(ends.nodes, axis=1)
    np.testing.assert_allclose(away, [0, 10, 10, 7, 10], atol=0.01)
    np.testing.assert_allclose(ends.nodes[4] / 10, SPOKES.nodes[4] / away_of(4), atol=0.01)


def away_of(node: int) -> float:
    return float(np.linalg.norm(SPOKES.nodes[node]))


def test_free_ends_come_to_a_box_or_a_solid() -> None:
    for target in ([[-10, -10, -10], [10, 10, 10]], Box(20, 20, 20)):
        ends = snapped(SPOKES, target, 1.0)
        np.testing.assert_allclose(
            ends.nodes, [[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 7], [-10, 0.3, 0]], atol=1e-9
        )


def test_free_ends_come_to_the_nodes_of_another_skeleton() -> None:
    ring = Skeleton([[10, 0, 0], [0, 10, 0], [-10, 0, 0]], [[0, 1], [1, 2]], 0.5)
    both = snapped(SPOKES, ring, 1.0) + ring
    assert both.component_count == 1
    assert both.loop_count == 2
    with pytest.raises(OptionError, match="reach is 0 mm"):
        snapped(SPOKES, ring, 0.0)


def test_all_nodes_move_if_asked() -> None:
    lattice = tile("sc", 3.0, 3, radius=0.3).moved_by([0.2, 0.2, 0.2])
    flush = snapped(lattice, [[0, 0, 0], [9, 9, 9]], 0.3, ends=False)
    assert flush.nodes[:, 0].min() == pytest.approx(0)
    assert len(flush.edges) == len(lattice.edges)
